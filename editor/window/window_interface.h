// Interface "coppice.editor_window" of the module `editor_window`: the editor's window behind a plugin, so that scripts run
// where there is no window system.
#pragma once
#include <cstdint>
#include "editor/session/session.h"
#include "runtime/plugin/registry.h"

namespace coppice {

struct EditorWindowSettings {
    uint32_t width = 1280, height = 800;
    float scale = 0.0f;  // of all text; 0: the display's
    bool light = false;
    std::string cache_dir, device;
    bool validation = false;
};

inline constexpr const char* k_editor_window_interface = "coppice.editor_window";
inline constexpr uint32_t k_editor_window_version = 1;

struct EditorWindowInterface {
    uint32_t size_bytes;
    bool (*display_available)();
    // Until it is closed. Errors: device_*; of scenes of which nothing can be shown.
    Status (*run)(Registry& registry, Session& session, const EditorWindowSettings& settings);
};

}  // namespace coppice
