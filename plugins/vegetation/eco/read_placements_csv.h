// Forest inventories: one plant a line, columns named by the header in any order. Needed: x, y, species (x
// and y on the ground: y becomes the world's z); used where present: height (m), diameter (m, checked only).
// Other columns are ignored with a note. Fields are separated by comma, semicolon or tab, whichever the
// header has, and may be quoted.
#pragma once
#include <map>
#include <string>
#include <vector>
#include "plugins/shared/region.h"
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/eco/place.h"
#include "runtime/core/result.h"

namespace coppice {

struct CsvSettings {
    std::map<std::string, PlantKind> kinds;     // by the names used in the file
    dvec2 offset{0.0};                          // added to x and y
    float scale_low = 1.0f, scale_high = 1.0f;  // of plants without a height
    uint64_t seed = 1;
    const Terrain* terrain = nullptr;
};

// One a line, in order. A height needs the kind's own height_m, and sets the scale. Turns and variations
// follow from the seed and the line. Errors, with the line: syntax, name_unknown, value_out_of_range,
// limit_exceeded.
Result<std::vector<Placement>> read_placements_csv(const std::string& path, const CsvSettings& settings);

}  // namespace coppice
