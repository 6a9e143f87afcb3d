// Grows a species' individuals to measure them, and keeps what was measured: growing a hundred trees takes seconds,
// reading their features nothing.
#pragma once
#include <cstdint>
#include <string>
#include <vector>
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/eco/plant_features.h"
#include "runtime/core/result.h"

namespace coppice {

inline constexpr uint32_t k_individual_limit = 1024;  // of one population

struct PopulationSource {
    std::string path;               // of a species file
    uint32_t individual_count = 1;  // variations [0, individual_count); at most k_individual_limit
};

// The features of each individual, in their order. Grown side by side, only as many in memory as there are threads, and
// never cooked; or read from cache_dir, where a file's name follows from the species' bytes, the number of individuals and
// the versions of growth and features. A broken file counts as none (with a note), one that cannot be written is a
// warning. cache_dir may be empty: nothing is kept. The same on any number of threads, cached or not.
// Errors: file_*, of the species, name_unknown where modeller is null.
Result<std::vector<PlantFeatures>> measure_population(const PopulationSource& source,
                                                      const ModellerInterface* modeller,
                                                      const std::string& cache_dir);

}  // namespace coppice
