// What `coppice bench foliage` measured, as its page and its JSON show it.
#pragma once
#include <cstdint>
#include <string>
#include <vector>
#include <nlohmann/json.hpp>
#include "tools/foliage/dropped_crown.h"
#include "tools/foliage/sweep_levels.h"

namespace coppice {

struct CrownLevelRecord {
    uint32_t leaf_count;
    double coverage_error;  // CrownCoverage::worst_error
    double area;            // of the full crown's
};

struct DrawnLevelRecord {
    uint32_t leaf_count;
    double leaves_ms;  // a frame with the leaves alone, every triangle
    double vdf_ms,
        ours_ms;  // to come there from the level before: extraction and copy; of lifetimes copy and scan
    std::string picture_file;  // with the wood
};

struct FoliageRecord {
    std::string name;  // of the plant
    uint32_t leaf_count = 0;
    double collapse_s = 0.0;                           // to a twentieth of the leaves; median
    double forest_words = 0.0, lifetimes_words = 0.0;  // per vertex of the crown
    double candidates_per_leaf = 0.0;  // looked at for each that is drawn, in the mean over the sweep
    std::vector<SweepStep> sweep;
    SweepSum fine_vdf, fine_lodf;  // of a sweep in ten times as many steps
    std::vector<CrownLevelRecord> levels;
    std::vector<DroppedErrors> dropped;  // drop and resize, in place of joining
    std::vector<DrawnLevelRecord> drawn;
    std::string grove_file;  // plants at levels by their distance; empty: none
};

nlohmann::json foliage_json(const FoliageRecord& record);

// device, machine, command: said on the page. At least one record.
std::string foliage_page(const std::vector<FoliageRecord>& records, const std::string& device,
                         const std::string& machine, const std::string& command);

}  // namespace coppice
