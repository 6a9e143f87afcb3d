// Two programs draw the same frames in turn: what slows the machine down for a while slows both.
#pragma once
#include <string>
#include <vector>
#include "runtime/core/result.h"
#include "tools/coppice/comparison.h"

namespace coppice {

struct ProgramsToCompare {
    std::string base, changed;           // programs
    std::vector<std::string> arguments;  // of play, for both
    double seconds = 20.0;               // of drawing
    double floor_share = 0.03;
    double slower = 0.0;  // of `changed`, on purpose: to try the comparison out
};

// Base runs twice, so that it is known what a difference means here. The three draw each frame one after the other, first in
// the order base, new, base again, then the other way round; the median ratio of k_block_frames frames is one pair. Each
// program is started k_rounds times, because where a process lies in memory is worth a percent or two. What is inconclusive
// is flown for as long again, up to k_most_attempts times in all. Errors: LockstepProgram's, whose place says which of the
// two it was; base that crashes or hangs is usage. Usage too, where the time was enough for too few pairs.
inline constexpr uint32_t k_block_frames = 6, k_rounds = 3, k_most_attempts = 3;
inline constexpr size_t k_least_pairs = 12;
Result<Comparison> compare_programs(const ProgramsToCompare& programs);

}  // namespace coppice
