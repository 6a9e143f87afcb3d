#include "plugins/vegetation/eco/mosaic.h"

#include <charconv>
#include <fmt/format.h>
#include "plugins/vegetation/eco/read_light.h"
#include "plugins/vegetation/eco/tile_pack.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

bool is_whole_sixteenth(double metres) { return metres * 16.0 == std::floor(metres * 16.0); }

void read_grid(JsonObject grid, PlacedScene& placed) {
    placed.columns = uint32_t(grid.whole("columns", 1, k_mosaic_place_limit));
    placed.rows = uint32_t(grid.whole("rows", 1, k_mosaic_place_limit));
    placed.spacing_m = grid.number("spacing_m", 0.0625, k_origin_reach_m);
    grid.close();
}

PlacedScene read_placed_scene(JsonObject& entry, const std::filesystem::path& folder, bool populated) {
    PlacedScene placed;
    placed.path = (folder / entry.text("scene")).lexically_normal().string();
    if (populated) placed.content_hash = read_content_hash(entry);
    const std::vector<double> at =
        entry.numbers("at", 2, -k_origin_reach_m, k_origin_reach_m, std::vector<double>{0.0, 0.0});
    placed.at = dvec3(at[0], 0.0, at[1]);
    if (entry.has("grid")) read_grid(entry.object("grid"), placed);
    entry.close();
    // Copies differ by whole spacings.
    const dvec3 first = placed.origin_of(0);
    if (!is_whole_sixteenth(first.x) || !is_whole_sixteenth(first.z) || !is_whole_sixteenth(placed.spacing_m))
        entry.report(
            ErrorId::value_out_of_range, placed.copy_count() > 1 ? "grid" : "at",
            fmt::format("its first place is [{}, {}], the spacing {}", first.x, first.z, placed.spacing_m),
            "whole multiples of 1/16 m");
    return placed;
}

}  // namespace

std::vector<PlacedScene> read_placed_scenes(JsonObject& root, const std::filesystem::path& folder,
                                            bool populated) {
    std::vector<PlacedScene> places;
    uint64_t copy_count = 0;
    for (JsonObject& entry : root.objects("mosaic")) {
        places.push_back(read_placed_scene(entry, folder, populated));
        places.back().place = fmt::format("mosaic[{}]", places.size() - 1);
        copy_count += places.back().copy_count();
        if (copy_count > k_mosaic_place_limit) {
            root.report(ErrorId::limit_exceeded, "mosaic", fmt::format("{} scenes or more", copy_count),
                        fmt::format("at most {}; a mosaic may consist of mosaics", k_mosaic_place_limit));
            break;
        }
    }
    if (places.empty())
        root.report(ErrorId::value_out_of_range, "mosaic", "no scene", "at least one {\"scene\": ...}");
    return places;
}

nlohmann::ordered_json json_of(const PlacedScene& placed) {
    nlohmann::ordered_json entry = {{"scene", placed.path},
                                    {"content", hash_to_hex(placed.content_hash)},
                                    {"at", {placed.at.x, placed.at.z}}};
    if (placed.copy_count() > 1)
        entry["grid"] = {{"columns", placed.columns}, {"rows", placed.rows}, {"spacing_m", placed.spacing_m}};
    return entry;
}

uint64_t read_content_hash(JsonObject& object) {
    const std::string text = object.text("content");
    uint64_t hash = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
    if (text.size() != 16 || error != std::errc() || end != text.data() + text.size())
        object.report(ErrorId::value_out_of_range, "content", "\"" + text + "\" is no content hash",
                      "populate the scene again");
    return hash;
}

Result<MosaicFile> read_mosaic_file(const std::string& path, const GroundHeight& ground) {
    COPPICE_TRY(const std::string text, read_text_file(path));
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(text, path));
    JsonObject root(document, document.root(), "");
    MosaicFile file;
    if (!root.has("mosaic")) return file;
    for (const char* key : {"plants", "placements", "references", "regions", "terrain"})
        if (root.has(key))
            root.report(ErrorId::value_out_of_range, key, "a mosaic has none of its own",
                        "write a scene for it, and name that in the mosaic");
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    file.name = root.text("name", std::filesystem::path(path).stem().stem().string());
    file.sample_distance_px = root.real("sample_distance_px", 0.01f, 1000.0f, 1.0f);
    file.light = read_light(root);
    file.places = read_placed_scenes(root, folder, false);
    root.has("camera_path");
    root.close();
    COPPICE_CHECK(document.status());
    COPPICE_TRY(file.camera_path, read_camera_path(root, folder, ground));
    return file;
}

}  // namespace coppice
