// `coppice bundle`: the program, what it needs and one cooked or populated scene in a folder that runs elsewhere. The
// scene's files are those that loading it opens, in the folders they had to each other, so every name in them
// stays true; its plants come as the cache keeps them, under the names the program will look for. A populated scene
// brings its own.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <fmt/format.h>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/terrain/terrain.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/import/read_named_places.h"
#include "plugins/vegetation/eco/load_scene.h"
#include "plugins/vegetation/eco/plant_scene.h"
#include "plugins/vegetation/eco/populated_scene.h"
#include "plugins/vegetation/eco/tile_forest.h"
#include "runtime/core/file.h"
#include "runtime/core/log.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/bundle_folder.h"
#include "tools/coppice/command.h"
#include "tools/coppice/loaded_objects.h"
#include "tools/coppice/opened_files.h"
#include "tools/coppice/play_host.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_examples = R"(
Examples:
  coppice bundle out/pines
  coppice bundle out/woodland --scene woodland
  coppice bundle out/forest --scene my/forest.eco.json --limit-mib 500
  coppice populate content/scenes/continent.eco.json -o out/continent
  coppice bundle out/far --scene out/continent

There:
  ./run                       flies through the scene; pictures, frames.csv, summary.json, index.html in out/
  ./run bench                 measures, also with every triangle but of a populated scene; out/bench/summary.json
  ./run play ARGS             the scene with other options: ./run play --headless 3840x2160 --out large
  ./run SUBCOMMAND ARGS       anything else the program can do: ./run bench raster

The other machine needs an x86-64 Linux with glibc as new as here and a Vulkan 1.3 driver, and nothing else.)";

struct BundleCommand {
    std::string folder, scene = "pines", content = "content", cache_dir;
    uint32_t limit_mib = 0;  // 0: k_limit_mib, without what a populated scene has
};
constexpr uint32_t k_limit_mib = 64;

// Without a slash at its end.
fs::path absolute_path(const std::string& path) {
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error).lexically_normal();
    return absolute.has_filename() ? absolute : absolute.parent_path();
}

// As seen from here, so that what is opened by an absolute path was named by one.
std::string relative_path(const std::string& path) {
    std::error_code error;
    return absolute_path(path).lexically_relative(fs::current_path(error)).string();
}

bool is_inside(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

// As playing does it: what is not in the cache is made and put there.
Status load_scene_and_plants(const std::string& scene_path, const std::string& cache_dir,
                             Registry& registry) {
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    SceneLoadSettings settings;
    settings.terrain = registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    settings.modeller = modeller;
    settings.cache_dir = cache_dir;
    settings.read_gltf = read_named_places;
    Scene scene;
    if (is_plant_file(scene_path)) {
        scene.models = {plant_scene_model(scene_path)};
    } else {
        COPPICE_TRY(scene, load_scene(scene_path, settings));
    }
    std::vector<PlantSource> sources;
    bool textured = false;
    for (const SceneModel& model : scene.models) {
        sources.push_back({model.source_path, model.variation});
        textured |= !model.source_path.ends_with(".json") && !model.source_path.ends_with(".plant");
    }
    const ImagesInterface* images = nullptr;
    if (textured && registry.load("images"))
        images = registry.find<ImagesInterface>(k_images_interface, k_images_version);
    COPPICE_CHECK(find_or_cook(cache_dir, sources, CookSettings{}, modeller, images));
    for (const PlantSource& source : sources) {
        if (source.path.ends_with(".plant")) continue;
        COPPICE_TRY(const std::string cooked,
                    cooked_path(cache_dir, source, CookSettings{}));
        std::error_code error;
        if (!fs::exists(cooked, error))
            return fail(ErrorId::write_failed, cooked, "", "what was cooked cannot be kept in the cache",
                        "name a folder that can be written with --cache");
    }
    return {};
}

struct SceneFiles {
    std::vector<std::string> authored, cached;  // sorted
    bool populated = false;                     // then nothing is authored, but all of that kind
};

// cache_dir: may be empty, where nothing is of the cache.
Result<SceneFiles> sort_by_place(const std::set<std::string>& paths, const std::string& cache_dir) {
    SceneFiles files;
    for (const std::string& path : paths) {
        if (!cache_dir.empty() && is_inside(path, cache_dir))
            files.cached.push_back(path);
        else if (fs::path(path).is_relative())
            files.authored.push_back(path);
        else
            return fail(ErrorId::value_out_of_range, path, "",
                        "the scene names this file by an absolute path, which is another one elsewhere",
                        "name it relative to the file that names it");
    }
    return files;
}

// All that flying over it reads, and all of it sound.
Result<SceneFiles> find_populated_files(const std::string& scene_file, const Registry& registry) {
    OpenedFiles opened;
    COPPICE_TRY(const TileForest forest,
                load_forest(relative_path(scene_file),
                            registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version)));
    COPPICE_CHECK(load_plants(forest));
    for (const TilePack& pack : forest.packs) COPPICE_CHECK(check_blocks(pack));
    COPPICE_TRY(SceneFiles files, sort_by_place(opened.paths(), ""));
    files.populated = true;
    return files;
}

Result<SceneFiles> find_scene_files(const std::string& scene_path, const std::string& cache_dir,
                                    Registry& registry) {
    // The first time fills the cache and says what there is to say, the second reads all there is to read.
    COPPICE_CHECK(load_scene_and_plants(scene_path, cache_dir, registry));
    OpenedFiles opened;
    set_log_sink([](void*, LogLevel, std::string_view) {}, nullptr);
    const Status again = load_scene_and_plants(relative_path(scene_path), cache_dir, registry);
    set_log_sink(nullptr, nullptr);
    COPPICE_CHECK(again);
    return sort_by_place(opened.paths(), cache_dir);
}

// The deepest folder that all of them are in.
fs::path common_folder(const std::vector<std::string>& paths) {
    fs::path common = absolute_path(paths.front()).parent_path();
    for (const std::string& path : paths) {
        const fs::path folder = absolute_path(path).parent_path();
        const auto end = std::mismatch(common.begin(), common.end(), folder.begin(), folder.end()).first;
        fs::path shorter;
        for (auto piece = common.begin(); piece != end; ++piece) shorter /= *piece;
        common = shorter;
    }
    return common;
}

std::string quoted(const std::string& text) {
    std::string out = "'";
    for (char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

// LD_LIBRARY_PATH goes before the places the program was built with.
std::string run_script(const std::string& scene, bool populated) {
    return fmt::format(R"sh(#!/bin/sh
# Written by coppice {version}. Needs glibc as new as where it was made, and a Vulkan 1.3 driver.
#   ./run                    flies through the scene; pictures and a report go to out/
#   ./run bench              measures{also}: out/bench/summary.json
#   ./run play ARGS          the scene with other options; ./run play --help lists them
#   ./run SUBCOMMAND ARGS    the program itself; ./run --help
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd) || exit 2
coppice=$here/bin/coppice
scene=$here/{scene}
unset COPPICE_PLUGIN_PATH
export LD_LIBRARY_PATH="$here/lib${{LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}}"
# A driver may need a newer C++ library than ours, so the system's is taken where the program runs with it.
"$coppice" --version >/dev/null 2>&1 || LD_LIBRARY_PATH=$here/lib/fallback:$LD_LIBRARY_PATH
case "$#:${{1-}}" in
  0:) exec "$coppice" play "$scene" --cache "$here/cache" --headless 1280x720 --out out ;;
  1:bench) exec "$coppice" play "$scene" --cache "$here/cache" --headless 795x700 --out out/bench \
                                --pictures 0{compare} ;;
  *:play) shift; exec "$coppice" play "$scene" --cache "$here/cache" "$@" ;;
  *) exec "$coppice" "$@" ;;
esac
)sh",
                       fmt::arg("version", COPPICE_VERSION), fmt::arg("scene", quoted(scene)),
                       // Every triangle of a populated scene may be more than any memory holds.
                       fmt::arg("also", populated ? "" : ", also with every triangle"),
                       fmt::arg("compare", populated ? "" : " --compare-full"));
}

constexpr const char* k_populated = "populated scene";

std::string name_of_file(const std::string& path) { return fs::path(path).filename().string(); }

// loaded: of a process with the player's plugins and nothing that only cooking needs.
std::vector<BundleFile> list_files(const std::vector<std::string>& loaded, const SceneFiles& scene_files,
                                   const std::string& scene_path, const std::string& cache_dir) {
    std::vector<BundleFile> files;
    std::error_code error;
    const std::string program = fs::read_symlink("/proc/self/exe", error).string();
    for (const std::string& path : loaded) {
        const std::string name = name_of_file(path);
        const bool plugin =
            std::any_of(std::begin(k_player_plugins), std::end(k_player_plugins),
                        [&](const char* known) { return name == std::string(known) + ".so"; });
        if (path == program)
            files.push_back({"program", "bin/coppice", path, {}, true});
        else if (plugin)
            files.push_back({"plugin", "lib/coppice/" + name, path, {}});
        else
            files.push_back(
                {"library", (is_compiler_runtime(path) ? "lib/fallback/" : "lib/") + name, path, {}});
    }
    for (const std::string& path : scene_files.cached)
        files.push_back({"cooked",
                         (fs::path("cache") / fs::path(path).lexically_relative(cache_dir)).string(),
                         path,
                         {}});
    const fs::path common = common_folder(scene_files.authored);
    auto content_path = [&](const std::string& path) {
        return (fs::path("content") / absolute_path(path).lexically_relative(common)).string();
    };
    const char* what = scene_files.populated ? k_populated : "scene file";
    for (const std::string& path : scene_files.authored)
        files.push_back({what, content_path(path), path, {}});
    files.push_back({"script", "run", "", run_script(content_path(scene_path), scene_files.populated), true});
    return files;
}

// Says what there is, by kind, and what is largest; too much of it is an error. limit_mib: BundleCommand's.
Status check_size(const std::vector<BundleFile>& files, const std::string& folder, uint32_t limit_mib) {
    constexpr double k_mib = 1 << 20;
    struct Kind {
        size_t count = 0;
        uint64_t bytes = 0;
    };
    std::vector<const char*> order;
    std::map<std::string_view, Kind> kinds;
    Kind all;
    uint64_t limited_bytes = 0;
    const BundleFile* largest = nullptr;
    uint64_t largest_bytes = 0;
    for (const BundleFile& file : files) {
        COPPICE_TRY(const uint64_t bytes, size_bytes(file));
        Kind& kind = kinds[file.what];
        if (kind.count == 0) order.push_back(file.what);
        for (Kind* sum : {&kind, &all}) {
            ++sum->count;
            sum->bytes += bytes;
        }
        if (limit_mib == 0 && file.what == k_populated) continue;
        limited_bytes += bytes;
        if (!largest || bytes > largest_bytes) {
            largest = &file;
            largest_bytes = bytes;
        }
    }
    for (const char* what : order) {
        const Kind& kind = kinds[what];
        fmt::print("  {:<16}{:>5}{:>10.2f} MiB\n", what, kind.count, double(kind.bytes) / k_mib);
    }
    fmt::print("  {:<16}{:>5}{:>10.2f} MiB\n", "in all", all.count, double(all.bytes) / k_mib);
    const uint32_t most_mib = limit_mib > 0 ? limit_mib : k_limit_mib;
    if (limited_bytes > uint64_t(most_mib) << 20)
        return fail(ErrorId::regressed, folder, "",
                    fmt::format("{:.1f} MiB; the largest is {} with {:.1f} MiB",
                                double(limited_bytes) / k_mib, largest->path, double(largest_bytes) / k_mib),
                    fmt::format("at most {} MiB: a smaller scene, or a larger --limit-mib", most_mib));
    return {};
}

Status run(const BundleCommand& command) {
    // Found out before the work, not after it.
    COPPICE_TRY(const BundleFolder folder, BundleFolder::open(command.folder));
    const bool of_content = command.scene.find_first_of("/.") == std::string::npos;
    const std::string named =
        of_content ? fmt::format("{}/scenes/{}.eco.json", command.content, command.scene) : command.scene;
    const std::string populated = populated_scene_file(named);
    const std::string& scene_path = populated.empty() ? named : populated;
    Registry registry;
    for (const char* name : k_player_plugins) COPPICE_CHECK(registry.load(name));
    const std::vector<std::string> loaded = loaded_objects();
    const std::string cache_dir =
        absolute_path(command.cache_dir.empty() ? default_cache_dir() : command.cache_dir).string();
    COPPICE_TRY(const SceneFiles scene_files, populated.empty()
                                                  ? find_scene_files(scene_path, cache_dir, registry)
                                                  : find_populated_files(scene_path, registry));
    const std::vector<BundleFile> files = list_files(loaded, scene_files, scene_path, cache_dir);
    COPPICE_CHECK(check_size(files, command.folder, command.limit_mib));
    COPPICE_CHECK(folder.replace(files));
    fmt::print("{0}: carry it to the other machine, and there: {0}/run\n", command.folder);
    return {};
}

}  // namespace

void add_bundle(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<BundleCommand>();
    CLI::App* bundle = app.add_subcommand(
        "bundle", "Put the program and one cooked or populated scene into a folder that runs elsewhere");
    bundle->footer(k_examples);
    bundle->add_option("folder", command->folder, "New, empty, or a bundle, which is replaced")->required();
    bundle
        ->add_option(
            "--scene", command->scene,
            "A scene of the content, or *.eco.json, or a folder that coppice populate made, or a plant")
        ->capture_default_str();
    bundle->add_option("--content", command->content, "Folder of scenes and species")->capture_default_str();
    bundle->add_option("--cache", command->cache_dir, "Folder of cooked plants. Default: ~/.cache/coppice");
    bundle
        ->add_option("--limit-mib", command->limit_mib,
                     "More than so much is refused. Default: 64, and a populated scene of any size beside")
        ->check(CLI::Range(1, 1 << 20));
    bundle->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
