// `coppice populate`: packs a scene's plants and tiles into a folder that is flown over without being loaded as a whole.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include "plugins/vegetation/eco/tile_forest.h"
#include "runtime/core/file.h"
#include "runtime/core/jobs.h"
#include "runtime/core/progress.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/command.h"
#include "tools/coppice/opened_files.h"
#include "tools/coppice/page_text.h"
#include "tools/coppice/populate_pieces.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice populate content/scenes/woodland.eco.json -o out/woodland
      cooks the plants, gathers the tiles' clouds, and writes out/woodland/scene.json; run again after a change or an
      interruption, it makes only what is missing
  coppice populate content/scenes/woodland.eco.json -o out/woodland --ninja out/woodland.ninja
  ninja -f out/woodland.ninja
      the same work as a build, for any executor of ninja files; from the folder where the first line was typed
  coppice populate content/scenes/continent.eco.json -o out/continent
      a mosaic of scenes: each different scene once, in a folder of its own, however often it stands
  coppice play out/continent

The same input gives the same bytes, whoever makes the pieces. All of it is a cache: it can be deleted and made again.
Pieces that a changed scene no longer needs stay in the folder.)";

struct PopulateCommand {
    PopulateSettings settings;
    std::string ninja, only;
};

namespace fs = std::filesystem;

// The scene, or the mosaic with all scenes below it; and the files that say so.
struct Whole {
    PopulateSettings settings;
    MosaicTree tree;
    std::set<std::string> authored;
    Registry& registry;
};

std::string describe(Outcome outcome) { return outcome == Outcome::made ? "made" : "kept"; }

// A piece of one scene, as it is called in the folder of all.
std::string name_in_whole(const MosaicNode& node, const std::string& piece) {
    return (fs::path(node.folder) / piece).lexically_normal().generic_string();
}

bool is_scene(const MosaicNode& node) { return node.file.places.empty(); }

Result<Pieces> pieces_of(const Whole& whole, const MosaicNode& node) {
    COPPICE_TRY(Pieces pieces, list_pieces(settings_of(whole.settings, node)));
    const bool textured =
        std::any_of(pieces.plants.begin(), pieces.plants.end(), [](const PlantPiece& piece) {
            return !piece.source_path.ends_with(".json") && !piece.source_path.ends_with(".plant");
        });
    if (textured) pieces.settings.images = whole.settings.find_images();
    return pieces;
}

Status make_all_plants(const Pieces& pieces, const MosaicNode& node) {
    std::vector<Result<Outcome>> outcomes(pieces.plants.size());
    Progress progress("cooking plants", pieces.plants.size());
    parallel_for(pieces.plants.size(), 1, [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) {
            outcomes[p] = make_plant(pieces, pieces.plants[p]);
            progress.advance();
        }
    });
    size_t made = 0;
    for (Result<Outcome>& outcome : outcomes) {
        COPPICE_CHECK(outcome);
        made += *outcome == Outcome::made;
    }
    fmt::print("{}{}{} plants: {} made, {} kept\n", node.folder, node.folder.empty() ? "" : ": ",
               outcomes.size(), made, outcomes.size() - made);
    return {};
}

// What a reader wants to know of a pack, from its file.
Status print_pack(const Pieces& pieces, const MosaicNode& node, const PackPiece& piece, Outcome outcome) {
    COPPICE_TRY(const TilePack pack,
                open_tile_pack((fs::path(pieces.settings.folder) / piece.name).string()));
    const PackedTileNode root = pack.nodes.empty() ? PackedTileNode{} : pack.nodes[0];
    fmt::print("{}: {}, {} tiles, {} plants, {} triangles, {:.1f} MiB\n", name_in_whole(node, piece.name),
               describe(outcome), piece.tile_count, short_count(double(root.plant_count)),
               short_count(double(root.triangle_count)), double(pack.file->size_bytes()) / 1048576.0);
    return {};
}

Result<Outcome> make_all_of_scene(const Whole& whole, const MosaicNode& node) {
    COPPICE_TRY(const Pieces pieces, pieces_of(whole, node));
    COPPICE_CHECK(make_all_plants(pieces, node));
    COPPICE_TRY(const std::vector<Plant> plants, load_plants(pieces));
    std::vector<Outcome> outcomes;
    {
        Progress progress("packing tiles", pieces.packs.size());
        for (const PackPiece& piece : pieces.packs) {
            COPPICE_TRY(const Outcome outcome, make_pack(pieces, piece, plants));
            outcomes.push_back(outcome);
            progress.advance();
        }
    }
    for (size_t p = 0; p < outcomes.size(); ++p)
        COPPICE_CHECK(print_pack(pieces, node, pieces.packs[p], outcomes[p]));
    return make_scene(pieces, plants);
}

// What a player gets, as a player reads it: nothing is said to be there that could not be opened.
Status print_totals(const Whole& whole) {
    const fs::path folder = whole.settings.folder;
    COPPICE_TRY(const TileForest forest,
                load_forest((folder / k_scene_piece).string(), whole.settings.terrain));
    const ForestRow root = forest.rows.empty() ? ForestRow{} : forest.rows[0];
    uint64_t size_bytes = 0;
    for (const TilePack& pack : forest.packs) size_bytes += pack.file->size_bytes();
    std::set<std::string> plants;
    for (const SceneModel& model : forest.models) plants.insert(model.source_path);
    for (const std::string& plant : plants) {
        std::error_code error;
        if (const uintmax_t plant_bytes = fs::file_size(plant, error); !error) size_bytes += plant_bytes;
    }
    std::string scenes;
    if (const MosaicNode& node = whole.tree.root(); !is_scene(node))
        scenes = fmt::format("; {} different scenes in {} places",
                             std::count_if(whole.tree.nodes.begin(), whole.tree.nodes.end(), is_scene),
                             node.scene_count);
    fmt::print("{}: {} plants, {} triangles; {} packs and {} packed plants, {:.1f} MiB{}\n", folder.string(),
               short_count(double(root.plant_count)), short_count(double(root.triangle_count)),
               forest.packs.size(), plants.size(), double(size_bytes) / 1048576.0, scenes);
    return {};
}

Status make_everything(const Whole& whole) {
    for (const MosaicNode& node : whole.tree.nodes) {
        COPPICE_TRY(const Outcome outcome, is_scene(node) ? make_all_of_scene(whole, node)
                                                          : make_mosaic(whole.settings, whole.tree, node));
        fmt::print("{}: {}\n", name_in_whole(node, k_scene_piece), describe(outcome));
    }
    return print_totals(whole);
}

// Nothing where the scene has no such piece.
Result<std::optional<Outcome>> make_of_scene(const Whole& whole, const MosaicNode& node,
                                             const std::string& name) {
    COPPICE_TRY(const Pieces pieces, pieces_of(whole, node));
    auto find = [&](const auto& list) {
        return std::find_if(list.begin(), list.end(),
                            [&](const auto& piece) { return name_in_whole(node, piece.name) == name; });
    };
    if (const auto plant = find(pieces.plants); plant != pieces.plants.end())
        return make_plant(pieces, *plant);
    const auto pack = find(pieces.packs);
    const bool last = name == name_in_whole(node, k_scene_piece);
    if (pack == pieces.packs.end() && !last) return std::nullopt;
    COPPICE_TRY(const std::vector<Plant> plants, load_plants(pieces));
    return last ? make_scene(pieces, plants) : make_pack(pieces, *pack, plants);
}

Status make_one(const Whole& whole, const std::string& name) {
    std::optional<Outcome> outcome;
    for (const MosaicNode& node : whole.tree.nodes) {
        if (outcome) break;
        if (!is_scene(node)) {
            if (name != name_in_whole(node, k_scene_piece)) continue;
            COPPICE_TRY(outcome, make_mosaic(whole.settings, whole.tree, node));
        } else if (node.folder.empty() || name.starts_with(node.folder + "/") ||
                   name.starts_with(whole.settings.plants + "/")) {
            COPPICE_TRY(outcome, make_of_scene(whole, node, name));
        }
    }
    if (!outcome)
        return fail(ErrorId::name_unknown, whole.settings.scene, "",
                    fmt::format("no piece is called '{}'", name),
                    fmt::format("plants/NAME-HASH.plant, tiles/NAME-0.tiles, or {}; of a scene in a mosaic "
                                "behind its folder; --ninja lists them",
                                k_scene_piece));
    fmt::print("{}: {}\n", name, describe(*outcome));
    return {};
}

// A path as ninja reads it in a build line.
std::string ninja_path(const std::string& path) {
    std::string escaped;
    for (char c : path) {
        if (c == '$' || c == ' ' || c == ':') escaped += '$';
        escaped += c;
    }
    return escaped;
}

// A word of a command, for the shell and for ninja.
std::string ninja_word(const std::string& text) {
    std::string quoted = "'";
    for (char c : text) quoted += c == '\'' ? "'\\''" : c == '$' ? "$$" : std::string(1, c);
    return quoted + "'";
}

struct NinjaFile {
    std::string text;
    size_t plant_count = 0, pack_count = 0;
};

// Names of plants follow from what they are made of; packs and scenes are made of the plants and the authored files, and
// so is the list itself.
Result<NinjaFile> list_as_ninja(const Whole& whole, const std::string& file) {
    const PopulateSettings& settings = whole.settings;
    NinjaFile ninja;
    ninja.text = fmt::format(
        "# Written by coppice populate: the pieces of {1}, for any executor of ninja files.\n"
        "# Paths are relative to the folder it was started in; the program must be the same everywhere.\n"
        "ninja_required_version = 1.8\n"
        "populate = {0} populate {1} -o {2} --pack-plants {3}{4}\n\n"
        "rule piece\n  command = $populate --only $piece\n  description = $piece\n  restat = 1\n\n"
        "rule list\n  command = $populate --ninja {5}\n  description = $out\n  generator = 1\n  restat = "
        "1\n\n",
        ninja_word(program_dir() + "/coppice"), ninja_word(settings.scene), ninja_word(settings.folder),
        settings.pack_plants, settings.cache_dir.empty() ? "" : " --cache " + ninja_word(settings.cache_dir),
        ninja_word(file));
    auto inputs_of = [](const std::set<std::string>& paths) {
        std::string inputs;
        for (const std::string& path : paths) inputs += " " + ninja_path(path);
        return inputs;
    };
    std::set<std::string> known;  // scenes share plants
    auto add = [&](const MosaicNode& node, const std::string& piece, const std::string& inputs) {
        const std::string name = name_in_whole(node, piece);
        const std::string path = ninja_path((fs::path(settings.folder) / name).string());
        if (known.insert(name).second)
            ninja.text += fmt::format("build {}: piece{}{}\n  piece = {}\n", path, inputs.empty() ? "" : " |",
                                      inputs, ninja_word(name));
        return " " + path;
    };
    std::set<std::string> authored = whole.authored;
    std::vector<std::string> scenes;
    for (const MosaicNode& node : whole.tree.nodes) {
        std::string inputs = inputs_of(whole.authored);
        if (is_scene(node)) {
            COPPICE_TRY(const Pieces pieces, pieces_of(whole, node));
            authored.insert(pieces.authored.begin(), pieces.authored.end());
            std::string plants, packs;
            for (const PlantPiece& piece : pieces.plants) plants += add(node, piece.name, "");
            inputs = inputs_of(pieces.authored) + plants;
            for (const PackPiece& piece : pieces.packs) packs += add(node, piece.name, inputs);
            inputs += packs;
            ninja.pack_count += pieces.packs.size();
        }
        for (uint32_t below : node.scenes) inputs += scenes[below];
        scenes.push_back(add(node, k_scene_piece, inputs));
    }
    ninja.plant_count = known.size() - ninja.pack_count - scenes.size();
    ninja.text +=
        fmt::format("build {}: list |{}\ndefault{}\n", ninja_path(file), inputs_of(authored), scenes.back());
    return ninja;
}

Status write_ninja(const Whole& whole, const std::string& file) {
    for (const std::string& path : {whole.settings.scene, whole.settings.folder, file})
        if (path.find_first_of("\n\r") != std::string::npos)
            return fail(ErrorId::usage, path, "", "a path with a line break", "ninja files cannot name it");
    COPPICE_TRY(const NinjaFile ninja, list_as_ninja(whole, file));
    COPPICE_CHECK(write_text_file(file, ninja.text));
    fmt::print("{}: {} plants, {} packs\n", file, ninja.plant_count, ninja.pack_count);
    return {};
}

Status read_whole(Whole& whole) {
    PopulateSettings& settings = whole.settings;
    if (!settings.scene.ends_with(".json"))
        return fail(ErrorId::usage, settings.scene, "", "not a scene", "name an *.eco.json file");
    Registry& registry = whole.registry;
    for (const char* name : {"terrain", "modeller"}) COPPICE_CHECK(registry.load(name));
    settings.terrain = registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    settings.modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    settings.find_images = [&registry]() -> const ImagesInterface* {
        if (!registry.load("images")) return nullptr;
        return registry.find<ImagesInterface>(k_images_interface, k_images_version);
    };
    OpenedFiles opened;
    COPPICE_TRY(whole.tree, read_mosaic_tree(settings.scene));
    whole.authored = opened.paths();
    return {};
}

Status run(const PopulateCommand& command) {
    Registry registry;
    Whole whole{command.settings, {}, {}, registry};
    COPPICE_CHECK(read_whole(whole));
    if (!command.ninja.empty()) return write_ninja(whole, command.ninja);
    return command.only.empty() ? make_everything(whole) : make_one(whole, command.only);
}

}  // namespace

Status populate(const PopulateSettings& settings) {
    Registry registry;
    Whole whole{settings, {}, {}, registry};
    COPPICE_CHECK(read_whole(whole));
    return make_everything(whole);
}

void add_populate(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<PopulateCommand>();
    PopulateSettings& settings = command->settings;
    CLI::App* populate =
        app.add_subcommand("populate", "Pack a scene's plants and tiles into a folder that is streamed from");
    populate->footer(k_examples);
    populate->add_option("scene", settings.scene, "*.eco.json")->required();
    populate->add_option("-o,--output", settings.folder, "Folder of the populated scene")->required();
    CLI::Option* ninja =
        populate->add_option("--ninja", command->ninja, "Make nothing, but write a build.ninja that does");
    populate->add_option("--only", command->only, "Make one piece, as the build.ninja names it")
        ->excludes(ninja);
    populate->add_option("--pack-plants", settings.pack_plants, "Plants of one pack of tiles, at most")
        ->check(CLI::Range(uint64_t(1), uint64_t(k_tiles_node_limit) * 512))
        ->capture_default_str();
    populate->add_option("--cache", settings.cache_dir,
                         "Folder of measured populations. Default: ~/.cache/coppice");
    populate->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
