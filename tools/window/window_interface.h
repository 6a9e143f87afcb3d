// Interface "coppice.window" of the module `window`: the window library behind a plugin, so that the program
// itself links no window system and runs where there is none.
#pragma once
#include <cstdint>
#include "runtime/window/window.h"

namespace coppice {

inline constexpr const char* k_window_interface = "coppice.window";
inline constexpr uint32_t k_window_version = 1;

struct WindowInterface {
    uint32_t size_bytes;
    bool (*display_available)();
    std::vector<const char*> (*instance_extensions)();
    Result<std::unique_ptr<Window>> (*create)(const WindowSettings& settings);
};

}  // namespace coppice
