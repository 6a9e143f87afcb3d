// What the ground looks like from its shape: meadow, dry grass and soil in patches of many sizes, rock where
// it is steep, and what an author painted on it.
#pragma once
#include <vector>
#include "plugins/terrain/height_field.h"
#include "plugins/shared/region.h"

namespace coppice {

inline constexpr double k_paint_reach = 1.6;  // of the edge, where noise carries it farthest out

struct GroundPaint {
    Region region;
    vec3 color_linear{0.16f, 0.11f, 0.07f};
    float edge_m = 1.0f;    // over which it fades out, outside the region
    float strength = 1.0f;  // [0, 1]
};

// Colours are linear albedos.
struct GroundSettings {
    vec3 meadow = vec3(0.090f, 0.120f, 0.040f);
    vec3 dry = vec3(0.165f, 0.150f, 0.065f);
    vec3 soil = vec3(0.160f, 0.110f, 0.070f);
    vec3 rock = vec3(0.230f, 0.215f, 0.190f);
    float dry_share = 0.30f, soil_share = 0.12f;  // [0, 1], about, of the ground that is not rock
    float rock_slope_deg = 38.0f;                 // half rock there
    float variation = 0.35f;                      // [0, 1] of brightness, over all sizes
    float patch_m = 45.0f;                        // size of the largest patches
    uint32_t seed = 1;
    std::vector<GroundPaint> paint;  // later over earlier
};

// One colour a sample; of a periodic field, whose paint stays inside, the same on opposite borders. origin_world: of the
// field, for what is painted.
std::vector<vec3> color_ground(const HeightField& field, const std::vector<vec3>& normals,
                               const GroundSettings& ground, dvec3 origin_world);

}  // namespace coppice
