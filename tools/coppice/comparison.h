// Which of two is faster, told from noise; and what their frames are made of.
#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

enum class Speed { same, faster, slower, inconclusive };
const char* name_of(Speed speed);

// A difference counts where chance brings it less often than k_chance and it is at least the floor.
inline constexpr double k_chance = 0.01;

struct Effect {
    double share = 0.0;   // new is so much slower than base; 0.1: 10 % more time; negative: faster
    double chance = 1.0;  // of one as large where there is no difference
};
bool is_difference(const Effect& effect, double floor_share);

// Of logarithms of time ratios new over base, measured in pairs.
Effect effect_of_pairs(std::span<const double> log_ratios);
// Of times in ms, not in pairs.
Effect effect_of_times(std::span<const double> base_ms, std::span<const double> new_ms);

struct CountChange {
    std::string name;
    double base, changed;
    bool grew;  // by more than the floor, which fails
};

struct Comparison {
    double base_ms = 0.0, new_ms = 0.0;  // usual frame
    Effect effect;                       // of new against base
    Effect itself;                       // of base against itself in the same run
    size_t samples = 0;                  // pairs of blocks, or repeats
    double floor_share = 0.0;
    bool same_machine = true;         // where it is not, times say nothing
    std::vector<CountChange> counts;  // that differ
};

// Counts of base, of base flown again (or nothing), and of new. A count that base does not repeat may grow by as much as it
// varied there as well.
std::vector<CountChange> compare_counts(const std::map<std::string, double>& base,
                                        const std::map<std::string, double>& again,
                                        const std::map<std::string, double>& changed, double floor_share);

// Inconclusive where base would not pass against itself, and where what was found is large enough but may well be chance.
Speed speed_of(const Comparison& comparison);
nlohmann::json to_json(const Comparison& comparison);
std::string describe(const Comparison& comparison);
// Errors: regressed (slower, or a count grew), inconclusive.
Status status_of(const Comparison& comparison);

}  // namespace coppice
