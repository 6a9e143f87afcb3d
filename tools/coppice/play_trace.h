// A playthrough as a Chrome trace, for chrome://tracing and Perfetto: frames and systems on one row, passes on another.
#pragma once
#include <string>
#include "tools/coppice/play_record.h"

namespace coppice {

// JSON of the Trace Event Format. Devices tell how long passes took, not when: they are laid end to end from the frame's
// submission, and systems from the frame's start.
std::string chrome_trace(const PlayRecord& record);

}  // namespace coppice
