// The file that a command is about, what may be planted in it, and which of its plants are meant.
#pragma once
#include <algorithm>
#include "editor/commands/command.h"
#include "plugins/vegetation/eco/read_scatter.h"

namespace coppice {

// Argument "file", relative to the root; without it the root.
struct Target {
    std::string path;
    EcoFile* file = nullptr;  // null: reported
    const Terrain* terrain = nullptr;
};
Target read_target(const CommandContext& context, JsonObject& arguments);

// The plants and regions of the file's text. A kind's individuals are models kind << 16 | variation, so that who placed one
// knows what it is. Errors: what the text says wrong of them.
Result<SceneNames> names_of(Document& document, const EcoFile& file, const std::string& path);
inline uint32_t model_of(uint16_t kind, uint32_t variation) { return uint32_t(kind) << 16 | variation; }

// As it is kept: on the ground, the model's own scale.
PlacedPlant placed_from(const Placement& plant, double lift_m = 0.0);

// "near": [x, z] with "radius_m" (default 2): the nearest; "region": all in it; neither: all. "populations": only these.
std::vector<PlacedPlant> read_selection(JsonObject& arguments, const Document& document, const EcoFile& file,
                                        const SceneNames& names);
// Numbers of the kinds named in "populations", sorted; none named: empty, which means all. A name that only placed plants
// have is known too.
std::vector<uint16_t> read_populations(JsonObject& arguments, const Document& document, const EcoFile& file,
                                       const SceneNames& names);
inline bool is_chosen(const std::vector<uint16_t>& kinds, uint16_t kind) {
    return kinds.empty() || std::binary_search(kinds.begin(), kinds.end(), kind);
}

// Edits of one file. Its text gets a placement for placed plants where it has none; its plants stay where only it changes.
Edit edit_of(const Target& target, std::vector<PlacedPlant> removed, std::vector<PlacedPlant> added);
Edit edit_text(const Target& target, nlohmann::ordered_json json);

// "350 birch", "350 plants"
std::string count_text(const Document& document, std::span<const PlacedPlant> plants);

}  // namespace coppice
