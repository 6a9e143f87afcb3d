#include "tools/coppice/populate_pieces.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/shade_ground.h"
#include "plugins/vegetation/eco/tile_forest.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/mapped_file.h"
#include "tools/coppice/opened_files.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

std::string path_of(const Pieces& pieces, const std::string& name) {
    return (fs::path(pieces.settings.folder) / name).lexically_normal().string();
}

Status list_plants(Pieces& pieces) {
    std::map<std::string, uint32_t> known;
    for (const SceneModel& model : pieces.scene.models) {
        COPPICE_TRY(const std::string path,
                    cooked_path(pieces.settings.folder, {model.source_path, model.variation}, CookSettings{}));
        const std::string name = pieces.settings.plants + "/" + fs::path(path).filename().string();
        const auto [at, is_new] = known.emplace(name, uint32_t(pieces.plants.size()));
        if (is_new) pieces.plants.push_back({name, model.source_path, model.variation});
        pieces.plant_of_model.push_back(at->second);
    }
    return {};
}

void list_packs(Pieces& pieces) {
    const std::string stem = fs::path(pieces.settings.scene).stem().stem().string();
    const std::vector<SceneTile>& tiles = pieces.scene.tiles;
    for (uint32_t first = 0; first < tiles.size();) {
        uint64_t plant_count = tiles[first].plant_count;
        uint32_t last = first + 1;
        while (last < tiles.size() && plant_count + tiles[last].plant_count <= pieces.settings.pack_plants)
            plant_count += tiles[last++].plant_count;
        pieces.packs.push_back(
            {fmt::format("tiles/{}-{}.tiles", stem, pieces.packs.size()), first, last - first});
        first = last;
    }
}

// The tiles of one pack as a scene of their own, with the models of all.
Scene cut_scene(const Pieces& pieces, const PackPiece& piece, std::span<const Plant> plants) {
    const Scene& whole = pieces.scene;
    Scene part;
    part.models = whole.models;
    std::vector<Box> bounds;
    for (size_t m = 0; m < part.models.size(); ++m) {
        part.models[m].source_path = pieces.plants[pieces.plant_of_model[m]].name;
        bounds.push_back(plants[m].bounds_plant);
    }
    part.tiles.assign(whole.tiles.begin() + piece.first_tile,
                      whole.tiles.begin() + piece.first_tile + piece.tile_count);
    for (SceneTile& tile : part.tiles) {
        const size_t first = tile.first_plant, last = first + tile.plant_count;
        tile.first_plant = uint32_t(part.positions.size());
        auto append = [first, last](auto& column, const auto& from) {
            column.insert(column.end(), from.begin() + ptrdiff_t(first), from.begin() + ptrdiff_t(last));
        };
        append(part.positions, whole.positions);
        append(part.turns, whole.turns);
        append(part.plant_models, whole.plant_models);
    }
    finish_tiles(part, bounds);
    return part;
}

// Of all that the pack is made of.
uint64_t key_of(const Scene& part, std::span<const Plant> plants) {
    uint64_t key = hash_combine(k_tiles_version, part.models.size());
    auto add = [&key](const void* bytes, size_t size_bytes) {
        key = hash_combine(key, hash_bytes(bytes, size_bytes));
    };
    for (size_t m = 0; m < part.models.size(); ++m) {
        const SceneModel& model = part.models[m];
        add(model.name.data(), model.name.size());
        add(model.source_path.data(), model.source_path.size());
        add(&model.importance, sizeof model.importance);
        if (model.color_variation.any()) add(&model.color_variation, sizeof model.color_variation);
        key = hash_combine(key, plants[m].content_hash);
    }
    for (const SceneTile& tile : part.tiles) {
        add(&tile.tile.origin_world, sizeof tile.tile.origin_world);
        add(&tile.plant_count, sizeof tile.plant_count);
    }
    add(part.positions.data(), part.positions.size() * sizeof(PlantPosition));
    add(part.turns.data(), part.turns.size() * sizeof(PlantTurn));
    add(part.plant_models.data(), part.plant_models.size() * sizeof(PlantModel));
    return key;
}

bool is_kept(const std::string& path, uint64_t key) {
    const auto pack = open_tile_pack(path);
    return pack && pack->key == key && check_blocks(*pack);
}

// Leaves a file that has these bytes as it is, and its time with it.
Result<Outcome> write_if_different(const std::string& path, std::span<const std::byte> bytes) {
    if (const auto old = MappedFile::open(path);
        old && std::equal(old->bytes().begin(), old->bytes().end(), bytes.begin(), bytes.end()))
        return Outcome::kept;
    COPPICE_CHECK(write_file(path, bytes));
    return Outcome::made;
}

// The ground as a player reads it: packed, and shaded by all plants, which a player that streams them never has at once.
Result<std::string> bring_terrain(const Pieces& pieces, std::span<const Plant> plants) {
    if (pieces.terrain_json.empty()) return std::string();
    const fs::path folder = fs::path(pieces.settings.scene).parent_path();
    COPPICE_TRY(const std::shared_ptr<Terrain> terrain,
                pieces.settings.terrain->load(pieces.terrain_json, folder.string(), pieces.settings.scene));
    std::vector<Box> bounds;
    for (const Plant& plant : plants) bounds.push_back(plant.bounds_plant);
    shade_ground(pieces.scene, *terrain, bounds);
    const PackedTerrain packed = terrain->pack();
    const std::string stem = fs::path(pieces.settings.scene).stem().stem().string();
    const std::string hash = hash_to_hex(packed.content_hash);
    const std::string name = fmt::format("terrain/{}-{}.ground", stem, hash);
    COPPICE_CHECK(write_if_different(path_of(pieces, name), packed.bytes));
    const dvec3 center = terrain->origin_world();
    const nlohmann::json json = {{"packed", {{"file", name}, {"content", hash}}},
                                 {"center", {center.x, center.y, center.z}}};
    return json.dump();
}

}  // namespace

Result<Pieces> list_pieces(const PopulateSettings& settings) {
    Pieces pieces;
    pieces.settings = settings;
    const std::string cache_dir = settings.cache_dir.empty() ? default_cache_dir() : settings.cache_dir;
    {
        OpenedFiles opened;
        COPPICE_TRY(pieces.scene,
                    load_scene(settings.scene,
                               {settings.terrain, settings.modeller, cache_dir, {}, settings.find_images, read_named_places}));
        COPPICE_CHECK(list_plants(pieces));
        pieces.authored = opened.paths();
    }
    list_packs(pieces);
    // It was parsed before: this only looks for what the scene in memory does not keep.
    COPPICE_TRY(const std::string text, read_text_file(settings.scene));
    const nlohmann::json root = nlohmann::json::parse(text, nullptr, false);
    if (root.is_object() && root.contains("terrain")) pieces.terrain_json = root["terrain"].dump();
    return pieces;
}

Result<Outcome> make_plant(const Pieces& pieces, const PlantPiece& piece) {
    const std::string path = path_of(pieces, piece.name);
    if (load_plant(path)) return Outcome::kept;
    if (piece.source_path.ends_with(".plant")) {
        COPPICE_TRY(const Plant plant, load_plant(piece.source_path));
        COPPICE_CHECK(write_file(path, plant.file->bytes()));
        return Outcome::made;
    }
    COPPICE_CHECK(cook_file(piece.source_path, path, piece.variation, CookSettings{},
                            pieces.settings.modeller, pieces.settings.images));
    return Outcome::made;
}

Result<std::vector<Plant>> load_plants(const Pieces& pieces) {
    std::vector<Plant> different, plants;
    for (const PlantPiece& piece : pieces.plants) {
        COPPICE_TRY(Plant plant, load_plant(path_of(pieces, piece.name)));
        different.push_back(std::move(plant));
    }
    for (uint32_t p : pieces.plant_of_model) plants.push_back(different[p]);
    return plants;
}

Result<Outcome> make_pack(const Pieces& pieces, const PackPiece& piece, std::span<const Plant> plants) {
    const std::string path = path_of(pieces, piece.name);
    const Scene part = cut_scene(pieces, piece, plants);
    const uint64_t key = key_of(part, plants);
    if (is_kept(path, key)) return Outcome::kept;
    COPPICE_CHECK(write_tile_pack(path, build_tile_tree(part, plants), part, plants, key));
    return Outcome::made;
}

Result<Outcome> make_scene(const Pieces& pieces, std::span<const Plant> plants) {
    PopulatedScene populated;
    Scene& scene = populated.scene;
    scene.name = pieces.scene.name;
    scene.models = pieces.scene.models;
    for (size_t m = 0; m < scene.models.size(); ++m) {
        scene.models[m].source_path = pieces.plants[pieces.plant_of_model[m]].name;
        populated.model_content_hashes.push_back(plants[m].content_hash);
    }
    scene.light = pieces.scene.light;
    scene.camera_path = pieces.scene.camera_path;
    scene.sample_distance_px = pieces.scene.sample_distance_px;
    for (const PackPiece& piece : pieces.packs) {
        COPPICE_TRY(const TilePack pack, open_tile_pack(path_of(pieces, piece.name)));
        const PackedTileNode root = pack.nodes.empty() ? PackedTileNode{} : pack.nodes[0];
        populated.packs.push_back({piece.name, pack.content_hash, root.plant_count, root.triangle_count});
    }
    COPPICE_TRY(populated.terrain_json, bring_terrain(pieces, plants));
    const std::string text = write_populated_scene(populated);
    return write_if_different(path_of(pieces, k_scene_piece), std::as_bytes(std::span(text)));
}

PopulateSettings settings_of(const PopulateSettings& settings, const MosaicNode& node) {
    PopulateSettings own = settings;
    own.scene = node.path;
    if (node.folder.empty()) return own;
    own.folder = (fs::path(settings.folder) / node.folder).string();
    own.plants = "../plants";
    return own;
}

Result<Outcome> make_mosaic(const PopulateSettings& settings, const MosaicTree& tree,
                            const MosaicNode& node) {
    const fs::path own = fs::path(settings.folder) / node.folder;
    PopulatedScene populated;
    Scene& scene = populated.scene;
    scene.path = (own / k_scene_piece).lexically_normal().string();
    scene.name = node.file.name;
    scene.light = node.file.light;
    scene.sample_distance_px = node.file.sample_distance_px;
    populated.mosaic = node.file.places;
    for (size_t p = 0; p < populated.mosaic.size(); ++p) {
        PlacedScene& placed = populated.mosaic[p];
        const MosaicNode& below = tree.nodes[node.scenes[p]];
        placed.path = (fs::path(settings.folder) / below.folder / k_scene_piece).lexically_normal().string();
        COPPICE_TRY(const std::string text, read_text_file(placed.path));
        placed.content_hash = hash_text(text);
    }
    // The flight may be above ground that only the scenes below know.
    COPPICE_TRY(const TileForest forest, make_forest(populated, settings.terrain));
    COPPICE_TRY(MosaicFile again, read_mosaic_file(node.path, [&forest](double x_world, double z_world) {
                    return ground_height(forest, x_world, z_world);
                }));
    scene.camera_path = std::move(again.camera_path);
    for (PlacedScene& placed : populated.mosaic)
        placed.path = fs::path(placed.path).lexically_relative(own.lexically_normal()).generic_string();
    const std::string text = write_populated_scene(populated);
    return write_if_different(scene.path, std::as_bytes(std::span(text)));
}

}  // namespace coppice
