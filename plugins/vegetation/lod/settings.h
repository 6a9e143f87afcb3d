// What decides the level of detail of a frame.
#pragma once
#include <cstdint>

namespace coppice {

// How the projected area and length of a part are taken (ERRATA 2).
enum class ProjectionMode : uint8_t {
    printed,    // half the area and half the length, as in the paper
    isotropic,  // half the area, pi/4 of the length
    measured,   // the cook's fit for the direction of view, times its coverage gain
};

// What stands for leaves between all their triangles and points: fewer and larger leaves (plant/leaf_bands.h).
enum class FoliageMode : uint8_t {
    automatic,  // where they were measured to be nearer to the truth than points in the same time (lod/choose_part.h)
    points,  // nowhere
    leaves,  // wherever a part has them
};

// How shadow maps are fitted to what is seen (shadow/shadow_view.h).
enum class ShadowKind : uint8_t {
    none,         // no map is drawn: the sun reaches leaves as they are open to the sky
    uniform,      // as fine far from the viewer as near
    perspective,  // in the viewer's space after projection (Stamminger and Drettakis 2002)
    light_space,  // warped along the view across the sun's rays (Wimmer et al. 2004)
    clipmap,      // nested maps around the viewer that stay until the viewer or the sun has moved on (shadow/clipmap.h)
};

enum class RepresentationView : uint8_t {
    lit,
    kinds,     // colours by kind: triangles green, leaves yellow, lines blue, points red
    coverage,  // plants white, everything else black: for measurements
};

struct FrameSettings {
    // d'; > 0. Smaller: more primitives. With a budget the least d': where all that it asks for fits, no more is drawn.
    float sample_distance_px = 1.0f;
    // Of lines alone; 0: that of points. A budget sets it where lines become triangles all at once: at the d' at which they
    // still fit, and what is left goes to points.
    float line_sample_distance_px = 0.0f;
    // Points + 2 lines + 3 triangles + 4 leaves that the plants of a picture may draw, shadows apart; 0: as many as d' asks for. d' is found in each
    // frame so that it is met. Not of a view at rest, nor without levels of detail.
    uint64_t vertex_budget = 0;
    // Likewise, in time: as many vertices as were learned to take that long. 0: none; of both budgets the smaller holds.
    float time_budget_ms = 0.0f;
    float most_sample_distance_px =
        16.0f;                  // budgets make d' no larger; the picture's quality goes before them
    float splat_factor = 1.0f;  // c_p; the paper says 1.2 to 1.5 (docs/decisions.md)
    ProjectionMode projection = ProjectionMode::measured;
    bool weigh_by_facing = true;  // splats by |n . v|, as leaves are seen; false: all alike, as printed
    FoliageMode foliage = FoliageMode::automatic;
    bool level_of_detail = true;  // false: every triangle of everything in view
    bool blend = true;            // false: switch from points to triangles at once
    bool occlusion = true;  // false: what is behind the ground is drawn as well; the picture is the same
    ShadowKind shadows = ShadowKind::clipmap;
    uint32_t shadow_side_texels = 0;    // of each square map; 0: as the picture's pixels ask for
    float shadow_distance_m = 1000.0f;  // along the view; what is farther is lit as without shadows
    RepresentationView view = RepresentationView::lit;
    // Each pixel shows its sample and its neighbours' under a tent of this radius, [1, 2] px; 1: its own alone. Leaves
    // are finer than pixels, and a sample of one point a pixel is far from the pixel's mean.
    float filter_radius_px = 2.0f;
    // While camera, light, scene and settings rest, frames are averaged, up to this many, each sampled at another place
    // of the pixel; then nothing is drawn until something moves. 0: every frame stands alone.
    uint32_t accumulate_limit = 0;
    // Of a world that is read while it is flown over: the frame waits until all it needs, and its memory has room for, is
    // there. For pictures that must not depend on timing; else what is above stands in for what is missing. Not where the
    // host keeps its queue: waiting needs one.
    bool wait_for_tiles = false;
    bool operator==(const FrameSettings&) const = default;
};

}  // namespace coppice
