// What stands beside a plant: its parts, what they are drawn as at which size, and how far that is from all triangles.
#pragma once
#include "editor/plant/plant_editor.h"
#include "editor/window/panels.h"

namespace coppice {

// The columns of the window that are free between the panels.
struct FreeColumns {
    float low_px, high_px;
};
FreeColumns plant_free_columns(float scale);

// Needs a frame of ImGui that has begun. state.wants_scene: the person goes back to the scene.
void draw_plant_panels(Session& session, PlantEditor& plant, PanelState& state);

}  // namespace coppice
