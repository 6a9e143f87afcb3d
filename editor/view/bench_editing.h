// How long editing takes, beside what is asked of it: `coppice-editor SCENE --bench`.
#pragma once
#include "editor/view/editor_view.h"

namespace coppice {

// Prints a table. Opens the scene and paints 100,000 plants into it in a view without a window, but saves none; strokes, undo and
// saving are measured in a scene of its own among the temporary files. Errors: Session::open's, EditorView::create's; write_failed.
Status bench_editing(Registry& registry, const TerrainInterface* terrain, const std::string& scene_path,
                     const EditorViewSettings& settings);

}  // namespace coppice
