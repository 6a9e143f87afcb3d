// Goes once more over what a frame saw, as drawing did, and keeps what each decision was.
#pragma once
#include "plugins/vegetation/draw/frame_plants.h"
#include "plugins/vegetation/report/explanation.h"

namespace coppice {

// All of one frame, between its schedule and the next.
struct ExplainedFrame {
    const TileList& tiles;
    const FramePlants& plants;
    const SceneGeometry& geometry;
    const Frustum& frustum;
    const FrameSettings &drawn, &asked;  // settings: with the d' of the frame, and as the host gave them
    uint32_t rest_index;
    std::span<const SceneModel> models;  // of the geometry
};

// Takes as long as a frame's levels of detail do on one thread. Its sums are the report's.
FrameExplanation explain_frame(const ExplainedFrame& frame, const FrameReport& report);

}  // namespace coppice
