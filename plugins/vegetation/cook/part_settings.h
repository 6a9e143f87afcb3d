// What a person decided of a plant's parts, in place of what the cook would: what each turns into in the distance, and how
// important it is (Deussen et al. 2002, 4.3, the editor for levels of detail). Kept beside the plant as NAME.lod.json, whatever
// NAME is, so that a model that is exported anew keeps it:
//
//     { "parts": { "leaves": {"kind": "points", "importance": 1.5}, "twigs": {"kind": "lines"} } }
#pragma once
#include <string>
#include <string_view>
#include <vector>
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/result.h"

namespace coppice {

// "birch.json" -> "birch.json.lod.json"
std::string part_settings_path(const std::string& plant_path);

// "automatic", "points", "lines", "leaves".
const char* name_of(PartKind kind);

// In the order of the names; each once. Errors: syntax, name_unknown, value_out_of_range, with the place.
Result<std::vector<PartSettings>> parse_part_settings(std::string_view json, const std::string& file);
// Of what stands beside the plant; none where nothing does. Errors: file_*, and parse_part_settings'.
Result<std::vector<PartSettings>> read_part_settings(const std::string& plant_path);

// Of all of it; 0 where nothing is set.
uint64_t hash_part_settings(const std::vector<PartSettings>& parts);

}  // namespace coppice
