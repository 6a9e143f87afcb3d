// READ FIRST. The offline stage: a plant as described becomes a packed plant, ready to be drawn at any
// distance.
//   clean_mesh -> openness, classify (trace_skeleton, split_by_thickness) -> merge_parts -> importance
//              -> for each part: progressive_order, sample_points or trace_lines, measure_projection, pack_leaves
//              -> measure_coverage, build_octree, cut_part -> pack_plant
#pragma once
#include <cstddef>
#include <string>
#include <vector>
#include "plugins/vegetation/cook/classify.h"
#include "plugins/vegetation/cook/sample_points.h"
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/result.h"

namespace coppice {

// Goes into the key of cached plants: raise it when the bytes of an unchanged description change.
inline constexpr uint32_t k_cook_version = 17;

struct CookSettings {
    PointSampler sampler = PointSampler::automatic;
    PrefixOrder order = PrefixOrder::progressive;
    float points_per_triangle = 2.0f;  // (0, 64]; the paper's 2
    LineParts lines = LineParts::stems;
    uint64_t seed = 1;
    // These two say nothing of what comes out, and are not hashed.
    uint32_t primitive_limit =
        1u << 28;                // points of a plant, and its lines; also keeps their ranges in 32 bits
    bool show_progress = false;  // one line on a terminal; who cooks many plants shows progress over all
};

// Names the settings that decide what comes out, and the version of the cook.
uint64_t hash_settings(const CookSettings& settings);

// Bytes of a .plant file (plant.h). Same description and settings, same bytes, on any number of threads and
// from any compiler. Parts without a triangle are left out; more than k_part_limit are merged
// (merge_parts.h); dropped triangles and vertices are counted in the file. Errors: value_out_of_range (a bad
// index, no triangle in the whole plant), limit_exceeded; plant.name is their file.
Result<std::vector<std::byte>> cook_plant(const PlantDescription& plant, const CookSettings& settings);

}  // namespace coppice
