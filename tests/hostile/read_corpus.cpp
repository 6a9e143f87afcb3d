// hostile_corpus FOLDER DIFFERENCES: reads every .gltf and .glb of a folder of the Khronos glTF Validator's test data and
// compares the verdict with NAME.report.json beside it. DIFFERENCES lists, a line each, parts of paths whose verdicts are
// known to differ, or what our reader says of them, and why: "PART: reason". Exit code 1 where another one differs, or one
// of the list does not.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/cook/import/import_gltf.h"
#include "tests/hostile/require.h"

using namespace coppice;

namespace {

struct Difference {
    std::string part;
    size_t met = 0;
};

std::vector<Difference> read_differences(const std::string& path) {
    std::vector<Difference> differences;
    std::ifstream stream(path);
    for (std::string line; std::getline(stream, line);) {
        const size_t colon = line.find(':');
        if (colon != std::string::npos && !line.starts_with('#'))
            differences.push_back({line.substr(0, colon)});
    }
    return differences;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "hostile_corpus FOLDER DIFFERENCES\n");
        return 2;
    }
    std::vector<Difference> differences = read_differences(argv[2]);
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1]))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    size_t agreed = 0, listed = 0, unlisted = 0, judged = 0;
    for (const auto& file : files) {
        const auto plant = import_gltf(file.string(), {});
        hostile::accepted(plant);  // or the error is clear
        std::ifstream stream(file.string() + ".report.json");
        const auto report = nlohmann::json::parse(stream, nullptr, false);
        if (!report.is_object() || !report.contains("issues")) continue;
        ++judged;
        const bool valid = report["issues"].value("numErrors", 0) == 0;
        if (valid == plant.has_value()) {
            ++agreed;
            continue;
        }
        const std::string path = std::filesystem::relative(file, argv[1]).generic_string();
        const std::string fault = plant ? "accepted" : plant.error().fault;
        const auto known = std::find_if(differences.begin(), differences.end(), [&](const Difference& d) {
            return path.find(d.part) != std::string::npos || fault == d.part;
        });
        if (known != differences.end()) {
            ++known->met;
            ++listed;
            continue;
        }
        ++unlisted;
        fmt::print("{}: {}\n", path, plant ? fault : to_string(plant.error()));
    }
    size_t unmet = 0;
    for (const Difference& difference : differences)
        if (difference.met == 0) {
            ++unmet;
            fmt::print("{}: listed, but there is no such difference\n", difference.part);
        }
    fmt::print("{} files read, {} with a verdict: {} agree, {} differ as listed, {} otherwise\n",
               files.size(), judged, agreed, listed, unlisted);
    return unlisted + unmet ? 1 : 0;
}
