// The flight in a window: keyboard and mouse, levels of detail by key, figures in the title.
#pragma once
#include "tools/coppice/play_options.h"

namespace coppice {

// False where there is no display, or no window plugin.
bool window_available();

// Returns when the user closes the window.
Status play_in_window(const PlayOptions& options);

}  // namespace coppice
