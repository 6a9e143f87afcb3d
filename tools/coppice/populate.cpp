// `coppice populate`: packs a scene's plants and tiles into a folder that is flown over without being loaded as a whole.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include "runtime/core/file.h"
#include "runtime/core/jobs.h"
#include "runtime/core/progress.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/command.h"
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

The same input gives the same bytes, whoever makes the pieces. All of it is a cache: it can be deleted and made again.
Pieces that a changed scene no longer needs stay in the folder.)";

struct PopulateCommand {
    PopulateSettings settings;
    std::string ninja, only;
};

std::string describe(Outcome outcome) { return outcome == Outcome::made ? "made" : "kept"; }

Status make_all_plants(const Pieces& pieces) {
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
    fmt::print("{} plants: {} made, {} kept\n", outcomes.size(), made, outcomes.size() - made);
    return {};
}

// What a reader wants to know of a pack, from its file.
Status print_pack(const Pieces& pieces, const PackPiece& piece, Outcome outcome) {
    COPPICE_TRY(const TilePack pack,
                open_tile_pack((std::filesystem::path(pieces.settings.folder) / piece.name).string()));
    const PackedTileNode root = pack.nodes.empty() ? PackedTileNode{} : pack.nodes[0];
    fmt::print("{}: {}, {} tiles, {} plants, {} triangles, {:.1f} MiB\n", piece.name, describe(outcome),
               piece.tile_count, short_count(double(root.plant_count)),
               short_count(double(root.triangle_count)), double(pack.file->size_bytes()) / 1048576.0);
    return {};
}

Status make_everything(const Pieces& pieces) {
    COPPICE_CHECK(make_all_plants(pieces));
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
        COPPICE_CHECK(print_pack(pieces, pieces.packs[p], outcomes[p]));
    COPPICE_TRY(const Outcome scene, make_scene(pieces, plants));
    fmt::print("{}: {}\n", k_scene_piece, describe(scene));
    return {};
}

Status make_one(const Pieces& pieces, const std::string& name) {
    auto find = [&name](const auto& list) {
        return std::find_if(list.begin(), list.end(), [&](const auto& piece) { return piece.name == name; });
    };
    Result<Outcome> outcome;
    if (const auto plant = find(pieces.plants); plant != pieces.plants.end()) {
        outcome = make_plant(pieces, *plant);
    } else {
        const auto pack = find(pieces.packs);
        if (pack == pieces.packs.end() && name != k_scene_piece)
            return fail(ErrorId::name_unknown, pieces.settings.scene, "",
                        fmt::format("no piece is called '{}'", name),
                        fmt::format("{} plants as {}, {} packs as {}, or {}; --ninja lists them",
                                    pieces.plants.size(), "plants/NAME-HASH.plant", pieces.packs.size(),
                                    "tiles/NAME-0.tiles", k_scene_piece));
        COPPICE_TRY(const std::vector<Plant> plants, load_plants(pieces));
        outcome = name == k_scene_piece ? make_scene(pieces, plants) : make_pack(pieces, *pack, plants);
    }
    COPPICE_CHECK(outcome);
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

// Names of plants follow from what they are made of; packs and the scene are made of the plants and the authored files, and
// so is the list itself.
std::string ninja_text(const Pieces& pieces, const std::string& file) {
    const PopulateSettings& settings = pieces.settings;
    std::string authored, plants, packs;
    for (const std::string& path : pieces.authored) authored += " " + ninja_path(path);
    std::string text = fmt::format(
        "# Written by coppice populate: the pieces of {1}, for any executor of ninja files.\n"
        "# Paths are relative to the folder it was started in; the program must be the same everywhere.\n"
        "ninja_required_version = 1.8\n"
        "populate = {0} populate {1} -o {2} --pack-plants {3}{4}\n\n"
        "rule piece\n  command = $populate --only $piece\n  description = $piece\n  restat = 1\n\n"
        "rule list\n  command = $populate --ninja {5}\n  description = $out\n  generator = 1\n  restat = "
        "1\n\n"
        "build {6}: list |{7}\n",
        ninja_word(program_dir() + "/coppice"), ninja_word(settings.scene), ninja_word(settings.folder),
        settings.pack_plants, settings.cache_dir.empty() ? "" : " --cache " + ninja_word(settings.cache_dir),
        ninja_word(file), ninja_path(file), authored);
    auto add = [&](const std::string& name, const std::string& inputs) {
        const std::string path = ninja_path((std::filesystem::path(settings.folder) / name).string());
        text += fmt::format("build {}: piece{}\n  piece = {}\n", path, inputs, ninja_word(name));
        return " " + path;
    };
    for (const PlantPiece& piece : pieces.plants) plants += add(piece.name, "");
    const std::string inputs = " |" + authored + plants;
    for (const PackPiece& piece : pieces.packs) packs += add(piece.name, inputs);
    const std::string scene = add(k_scene_piece, inputs + packs);
    return text + "default" + scene + "\n";
}

Status write_ninja(const Pieces& pieces, const std::string& file) {
    for (const std::string& path : {pieces.settings.scene, pieces.settings.folder, file})
        if (path.find_first_of("\n\r") != std::string::npos)
            return fail(ErrorId::usage, path, "", "a path with a line break", "ninja files cannot name it");
    COPPICE_CHECK(write_text_file(file, ninja_text(pieces, file)));
    fmt::print("{}: {} plants, {} packs\n", file, pieces.plants.size(), pieces.packs.size());
    return {};
}

Status run(const PopulateCommand& command) {
    PopulateSettings settings = command.settings;
    if (!settings.scene.ends_with(".json"))
        return fail(ErrorId::usage, settings.scene, "", "not a scene", "name an *.eco.json file");
    Registry registry;
    for (const char* name : {"terrain", "modeller"}) COPPICE_CHECK(registry.load(name));
    settings.terrain = registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    settings.modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    COPPICE_TRY(Pieces pieces, list_pieces(settings));
    if (!command.ninja.empty()) return write_ninja(pieces, command.ninja);
    const bool textured =
        std::any_of(pieces.plants.begin(), pieces.plants.end(), [](const PlantPiece& piece) {
            return !piece.source_path.ends_with(".json") && !piece.source_path.ends_with(".plant");
        });
    if (textured && registry.load("images"))
        pieces.settings.images = registry.find<ImagesInterface>(k_images_interface, k_images_version);
    return command.only.empty() ? make_everything(pieces) : make_one(pieces, command.only);
}

}  // namespace

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
