// A tile's cloud: the points that stand for all its plants where they are far away. Its prefixes are what the plants
// themselves draw: point j of a plant's part appears where the density T, pixels a metre over d', squared, makes the
// part ask for more than j points, and the cloud is sorted by that T. So handing over between cloud and plants cannot pop.
// Source: Deussen et al. 2002, 6.2 (rough clouds of tiles). Deviates: nested prefixes are ours.
#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <vector>
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/line_points.h"

namespace coppice {

inline constexpr uint32_t k_cloud_points = 8192;
// Of a cloud's projected area, the share whose parts may have run out of points while it still stands for them.
inline constexpr double k_exhausted_share = 0.02;
// From 2^-32 on, four to an octave.
inline constexpr uint32_t k_density_steps = 256;

struct TileCloud {
    PackedPart part{};                 // kind points, no triangles; tile space
    std::vector<PackedVertex> points;  // tile space
    std::vector<float> densities;      // of each point, ascending: T and size (pack_density)
    // Projected area of the parts that run out of points at each step of the density; kept for merging.
    std::array<float, k_density_steps> exhausted_area_m2{};
    float exhausted_density = 0.0f;  // parts of at most k_exhausted_share have run out up to here

    // The cloud suffices up to this T; 0 for an empty one.
    float finest_density() const {
        return densities.empty() ? 0.0f : std::min(densities.back(), exhausted_density);
    }
};

// The k_cloud_points points that the plants draw first, seen from all sides in the mean: ties by plant, part, point.
// Lines give the points that stand for them where they are far (plant/line_points.h). plants[m] is what
// models[i].model == m draws, with the importance of scene_models[m], 1 where there are none, and in its colours; requires models in range and
// columns of one length. What no scene has is left out: places that are not finite, scales that are not in (0, 1e5], parts
// of more than 1000 km2.
TileCloud gather_cloud(std::span<const PlantPosition> positions, std::span<const PlantTurn> turns,
                       std::span<const PlantModel> models, std::span<const Plant> plants,
                       std::span<const SceneModel> scene_models = {});

// What gather_cloud of all the children's plants would give. offsets_m: each child's origin relative to the parent's.
TileCloud merge_clouds(std::span<const TileCloud* const> children, std::span<const vec3> offsets_m);

}  // namespace coppice
