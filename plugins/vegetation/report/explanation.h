// What a frame drew, at which level, why, and what spent the budget: as numbers, and as text for people.
#pragma once
#include <array>
#include <string>
#include <vector>
#include "plugins/vegetation/lod/choose_part.h"
#include "plugins/vegetation/lod/learn_cost.h"
#include "plugins/vegetation/report/report.h"

namespace coppice {

inline uint64_t vertices_of(const PrimitiveCounts& drawn) {
    return drawn.points + 2 * drawn.lines + 3 * drawn.triangles + 4 * drawn.leaves;
}

// Plants of one name in a ring of distances, drawn one by one.
struct ExplainedPlants {
    std::string model;
    float importance = 1.0f;  // the scene's for the model: it multiplies what points and lines are asked for
    float nearest_m = 0.0f, farthest_m = 0.0f;  // of their feet; rings are powers of two
    uint32_t plants = 0;
    // How their parts were drawn, by PartRule::Form; octree cells count as parts. Small parts may draw nothing.
    static constexpr size_t k_forms = 6;
    std::array<uint32_t, k_forms> parts_as{};
    uint32_t parts_of_nothing = 0;
    PrimitiveCounts drawn;
    uint64_t full_triangles = 0;  // had all been drawn
};

// A tile so far away that points for all its plants suffice.
struct ExplainedCloud {
    float nearest_m = 0.0f;
    uint64_t plants = 0, full_triangles = 0;
    bool stands_in = false;  // finer tiles are not in memory yet
    PrimitiveCounts drawn;
};

enum class SampleDistanceReason : uint8_t {
    asked,      // FrameSettings::sample_distance_px, and all fits
    budget,     // larger, so that the vertex or time budget is met
    most,       // most_sample_distance_px, and the budget is not met
    rest,       // the view rests: smaller from frame to frame
    no_levels,  // every triangle of everything in view
};

struct FrameExplanation {
    FrameReport report;
    SampleDistanceReason reason = SampleDistanceReason::asked;
    float asked_distance_px = 1.0f;  // the settings' d'
    // Of all plants: seen one by one, in clouds, in view but behind the ground. What is left is outside the view, or in tiles
    // that are.
    uint64_t plants_seen = 0, plants_in_clouds = 0, plants_hidden = 0, plants_elsewhere = 0;
    std::vector<ExplainedPlants> plants;  // what draws most vertices first
    std::vector<ExplainedCloud> clouds;   // nearest first
};

// Some lines, the costliest first; the last one ends with a line end.
std::string to_text(const FrameExplanation& explanation);

}  // namespace coppice
