// The benchmarks of `coppice bench`: each gives {"name", "figures": [{name, value, unit, reach, holds}],
// ...}.
#pragma once
#include <functional>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>
#include "runtime/core/result.h"

namespace coppice {

struct BenchSettings {
    std::string device;     // index or part of a name
    std::string content;    // folder of scenes and species
    std::string cache_dir;  // of cooked plants and references
    std::string scene;  // accuracy: of content/scenes, or a file; empty: pines. foliage: a plant; empty: three trees
    // Of `accuracy` alone.
    std::string views;             // camera path whose keys are the views; empty: SCENE_views.json
    std::string methods;           // names or parts of them, with ; between; empty: all
    std::string size = "795x700";  // of the pictures
    std::string out;               // folder
    uint32_t comparisons = 20;     // of `compare`, of each kind
};

struct Bench {
    const char* name;
    const char* what;  // one line, for --help
    std::function<Result<nlohmann::json>(const BenchSettings& settings)> run;
};

// In the order they are shown.
const std::vector<Bench>& benches();

}  // namespace coppice
