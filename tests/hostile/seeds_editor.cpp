// Right files of the editor's.
#include <cstring>
#include <filesystem>
#include "editor/document/edit.h"
#include "plugins/vegetation/eco/placed_plants.h"
#include "plugins/vegetation/eco/scene_file.h"
#include "runtime/core/hash.h"
#include "tests/hostile/editor_files.h"
#include "tests/hostile/seal.h"
#include "tests/hostile/seeds.h"

namespace coppice::hostile {
namespace {

constexpr std::string_view k_mark = "coppice journal 1\n";
constexpr size_t k_record_head_bytes = 16;

Bytes as_bytes(std::string_view text) {
    Bytes bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

std::string record_of(std::string_view content) {
    const uint64_t head[2] = {content.size(), hash_text(content)};
    return std::string(reinterpret_cast<const char*>(head), sizeof head) + std::string(content);
}

}  // namespace

std::string write_journal(const JournalContent& content) {
    std::string base;
    for (const JournalBase& file : content.base) base += hash_to_hex(file.hash) + " " + file.path + "\n";
    std::string bytes = std::string(k_mark) + record_of(base);
    for (const std::string& edit : content.edits) bytes += record_of(edit);
    return bytes;
}

// Each record's length as far as there are bytes, and its hash.
void seal_journal(Bytes& bytes) {
    for (size_t at = k_mark.size(); at + k_record_head_bytes <= bytes.size();) {
        uint64_t head[2];
        std::memcpy(head, bytes.data() + at, sizeof head);
        const size_t first = at + k_record_head_bytes;
        head[0] = std::min<uint64_t>(head[0], bytes.size() - first);
        head[1] = hash_range(bytes, first, head[0]);
        std::memcpy(bytes.data() + at, head, sizeof head);
        at = first + size_t(head[0]);
    }
}

std::vector<Bytes> edited_scene_seeds() {
    return {
        as_bytes(k_edited_scene),
        as_bytes(
            R"({"plants":{"oak":{"source":"oak.json"}},"references":[{"scene":"edited.eco.json","at":[4,5],"turn_deg":90},{"scene":"none.eco.json"}],"placements":[]})")};
}

std::vector<Bytes> edited_plants_seeds() { return placed_seeds(); }

std::vector<Bytes> journal_seeds() {
    const std::vector<std::string> kinds{"oak", "fern"};
    const PlacedPlant oak{128, 256, 0, 1, 0, pack_scale(1.0f), 0},
        fern{-64, 32, 1, 0, 0, pack_scale(0.7f), 3};
    const auto text = parse_scene_text(k_edited_scene, k_journalled_scene);
    const auto longer = parse_scene_text(
        R"({"plants": {"elm": {"source": "elm.json"}}, "placements": [{"packed": "planted.plants"}]})",
        k_journalled_scene);
    const Edit paint{"paint 2", {{k_journalled_scene, *text, *text, {}, {oak, fern}}}},
        remove{"delete 1", {{k_journalled_scene, *text, *text, {fern}, {}}}},
        change{"set", {{k_journalled_scene, *text, *longer, {}, {}}}},
        fresh{"create", {{"other.eco.json", nullptr, *longer, {}, {oak}}}};
    const JournalContent content{{{k_journalled_scene, hash_text(k_edited_scene)}},
                                 {write_edit(paint, kinds), write_edit(remove, kinds),
                                  write_edit(fresh, kinds), write_edit(change, kinds)}};
    return {as_bytes(write_journal(content))};
}

std::vector<Bytes> script_seeds() {
    return {as_bytes(R"({"commands": [
{"add_population": {"name": "birch", "source": "birch.json", "variations": 3, "height_m": 12}},
{"paint": {"stroke": [[0, 0], [9, 4]], "radius_m": 4, "scatter": {"plants": {"birch": 1, "fern": 2}, "density_per_m2": 0.05, "spacing_m": 2, "seed": 4}}},
{"fill": {"polygon": [[0, 0], [30, 0], [30, 30]], "scatter": {"plants": {"fern": 1}, "density_per_m2": 0.1, "slope_max_deg": 25}}},
{"compete": {"populations": ["birch"], "crown_radius_m": 2, "steps": 5, "growth": 0.1, "scale_most": 2}},
{"place": {"population": "birch", "at": [-10, 5], "scale": 1.2, "turn_deg": 3, "tilt_deg": 2, "tilt_towards_deg": 1, "lift_m": 0.5, "variation": 1}},
{"move": {"near": [-10, 5], "by": [2, 0]}}, {"turn": {"near": [-8, 5], "by_deg": 30, "about": [0, 0]}},
{"scale": {"populations": ["birch"], "by": 1.1}}, {"become": {"near": [-8, 5], "radius_m": 9, "population": "oak"}},
{"erase": {"stroke": [[0, 0]], "radius_m": 2, "share": 0.5, "seed": 3}}, {"undo": {"times": 2}}, {"redo": {}},
{"expect": {"populations": ["birch"], "least": 0, "most": 100}}]})"),
            as_bytes(R"({"commands": [
{"set_population": {"name": "oak", "height_m": 9}}, {"rename_population": {"name": "fern", "to": "bracken"}},
{"set_region": {"name": "pond", "region": {"polygon": [[0, 0], [4, 0], [4, 4]]}}},
{"add_rule": {"scatter": {"plant": "oak", "count": 5, "region": "pond"}}}, {"set_rule": {"index": 2, "scatter": {"plant": "oak", "count": 3, "region": "pond"}}},
{"bake_rule": {"index": 2}}, {"remove_rule": {"index": 1}},
{"create_tile": {"scene": "tile.eco.json", "at": [50, 50]}}, {"add_tile": {"scene": "tile.eco.json", "at": [90, 50], "turn_deg": 90, "scale": 1}},
{"move_tile": {"index": 0, "at": [60, 50]}}, {"duplicate_tile": {"index": 0, "at": [90, 9]}}, {"remove_tile": {"index": 1}},
{"place": {"population": "oak", "at": [3, 3]}}, {"nest": {"scene": "nested.eco.json", "at": [3, 3], "near": [3, 3]}},
{"remove_population": {"name": "bracken"}}, {"delete": {}}]})")};
}

}  // namespace coppice::hostile
