// What it costs to go from level to level, from the full crown to the coarsest in uniform steps, with each structure: the
// sweeps of Figs. 10 and 11 of Rebollo et al. 2006. The geometry of all leaves, joined ones too, lies on the device from the
// start with every structure, so that a leaf is sent as its number; VDF sent vertices, so this is in its favour.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

enum class FoliageStructure : uint8_t {
    vdf,        // all leaves found anew from the trees' roots, all sent (lod/view_dependent_foliage.h)
    lodf,       // the leaves and number of leaves of clusters that changed (lod/leaf_forest.h)
    lifetimes,  // the level: whoever draws finds the leaves (lod/leaf_lifetimes.h)
};
inline constexpr size_t k_structure_count = 3;

struct ChangeCost {
    double extract_ms = 0.0;  // until what is to be sent is known; medians over rounds
    double copy_ms = 0.0;     // of that into mapped memory
    uint64_t bytes = 0;       // sent
};

struct SweepStep {
    uint32_t leaf_count = 0;                           // of the level gone to
    std::array<ChangeCost, k_structure_count> change;  // from the level before; by FoliageStructure
    double scan_ms =
        0.0;  // lifetimes: to find the level's leaves on the CPU, were it not left to whoever draws
    uint32_t candidate_count = 0;  // lifetimes: leaves looked at by whoever draws
};

struct SweepSettings {
    uint32_t step_count = 100;
    uint32_t round_count = 7;  // >= 1
};

// Words of four bytes that sweeps write, at most.
size_t sweep_words(uint32_t leaf_count);

// step_count steps, fewer where there are fewer collapses; none without collapses. The structures take turns at each step, and
// a round that is not counted goes first. target: at least sweep_words. Requires collapses that check_collapses passes.
std::vector<SweepStep> sweep_levels(uint32_t leaf_count, std::span<const LeafCollapse> collapses,
                                    std::span<uint32_t> target, const SweepSettings& settings);

// Extraction, extraction and copy, bytes: of all steps together.
struct SweepSum {
    double extract_ms = 0.0, change_ms = 0.0;
    double bytes = 0.0;
};
SweepSum sum_of(std::span<const SweepStep> steps, FoliageStructure structure);

}  // namespace coppice
