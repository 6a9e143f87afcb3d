// `coppice play`: flies through a scene in a window, or headless with pictures and a report.
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <unistd.h>
#include <fmt/format.h>
#include "tools/coppice/command.h"
#include "tools/coppice/play_host.h"
#include "tools/coppice/play_lockstep.h"
#include "tools/coppice/play_loop.h"
#include "tools/coppice/play_report.h"
#include "tools/coppice/play_window.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice play content/scenes/woodland.eco.json
      in a window; WASD and the mouse fly, F1 shows all keys
  coppice play content/scenes/woodland.eco.json --headless 1280x720 --out out/woodland
      the whole path without a display; open out/woodland/index.html afterwards
  coppice play content/scenes/pines.eco.json --headless 795x700 --out out/pines --compare-full
      also draws some of the frames with every triangle, and prints both times
  coppice play content/scenes/pines.eco.json --headless 795x700 --out out/p --frames 90 --pictures 0,45,89
      the first 90 frames, pictures of three of them
  coppice play content/scenes/pines.eco.json --record out/walk.json
      fly in the window; what was flown is --path out/walk.json from then on
  coppice play content/scenes/pines.eco.json --headless 795x700 --repeats 3 --out out/p
    --budget frame=50ms,memory=512MiB,vertices=2000000 --golden goldens/pines
      a gate for a build machine: exit code 1 where a budget or a picture is not kept
  coppice populate content/scenes/landscape.eco.json -o out/landscape
  coppice play out/landscape
      the same landscape, read while it is flown over
  coppice play content/scenes/woodland.eco.json --vertices 500000
      half a million vertices in every frame, d' as large as that takes
  coppice play tree.glb
      any plant, with a grove of it behind, from where it fills the picture to where it is 20 pixels tall)";

std::string describe_budgets() {
    std::string text = "What the flight may take; exit code 1 where it took more:";
    for (const BudgetKind& kind : budget_kinds()) text += fmt::format("\n{}: {} ({})", kind.name, kind.what, kind.unit);
    return text;
}

struct PlayCommand {
    PlayOptions options;
    std::string headless;
    float sample_distance_px = 0.0f;
    std::string sun, budgets;
    bool full = false, lockstep = false;
    std::optional<uint32_t> explained_frame;
};

// Found out before the work, not after it.
Status make_folder(const std::string& out) {
    std::error_code error;
    std::filesystem::create_directories(out, error);
    if (!std::filesystem::is_directory(out) || ::access(out.c_str(), W_OK) != 0)
        return fail(ErrorId::write_failed, out, "", "cannot write into this folder",
                    "name a folder that can be made and written with --out");
    return {};
}

void print_table(const PlayRecord& record) {
    fmt::print("{} at {} x {}, {} frames on {}\n", record.scene_name, record.width, record.height,
               record.frames.size(), record.device);
    for (const Figure& figure : play_figures(record))
        fmt::print("  {:<26}{:>16.6g} {}\n", figure.name, figure.value, figure.unit);
}

// Drawn once more, so that the flight is as without it.
Status print_explanation(PlayHost& host, const PlayRecord& record, uint32_t frame) {
    const Camera camera = camera_at(host.scene.camera_path, double(frame) / record.fps);
    COPPICE_CHECK(host.draw_frame(camera, record.settings));
    fmt::print("\nframe {}\n{}", frame, to_text(host.vegetation->explain_frame()));
    return {};
}

Status run(PlayCommand command) {
    PlayOptions& options = command.options;
    options.settings.level_of_detail = !command.full;
    if (command.sample_distance_px > 0.0f) options.sample_distance_px = command.sample_distance_px;
    if (!command.sun.empty()) {
        COPPICE_TRY(options.sun_deg, parse_sun(command.sun));
    }
    options.headless = !command.headless.empty();
    if (!options.headless) {
        if (command.explained_frame)
            return fail(ErrorId::usage, "", "--explain", "frames of a window have no numbers", "add --headless 1280x720");
        if (!window_available())
            return fail(ErrorId::usage, "", "", "there is no display to open a window on",
                        "add --headless 1280x720 --out DIR");
        return play_in_window(options);
    }
    if (!options.record.empty())
        return fail(ErrorId::usage, "", "--record", "there is nobody to fly without a window", "leave out --headless");
    COPPICE_CHECK(parse_size("--headless", command.headless, options.width, options.height));
    COPPICE_CHECK(chosen_frames(options.pictures, 1));
    if (options.golden.update && options.golden.folder.empty())
        return fail(ErrorId::usage, "", "--golden-update", "no folder of goldens", "name it with --golden FOLDER");
    COPPICE_TRY(options.budgets, parse_budgets(command.budgets));
    for (const Budget& budget : options.budgets)
        options.compare_full |= std::string_view(budget.kind.name) == "error";
    if (options.golden.update) COPPICE_CHECK(make_folder(options.golden.folder));
    if (!options.out.empty()) COPPICE_CHECK(make_folder(options.out));
    COPPICE_TRY(std::unique_ptr<PlayHost> host, PlayHost::create(options));
    if (command.lockstep) return play_in_lockstep(*host, options);
    COPPICE_TRY(const PlayRecord record, play_headless(*host, options));
    print_table(record);
    if (command.explained_frame) COPPICE_CHECK(print_explanation(*host, record, *command.explained_frame));
    if (!options.out.empty()) {
        COPPICE_CHECK(write_report(record, options.out));
        fmt::print("{0}/index.html  {0}/summary.json  {0}/frames.csv  {0}/trace.json  {0}/junit.xml\n", options.out);
    }
    for (const Check& check : record.checks)
        fmt::print("  {:<26}{:>16.6g} {:<18}{}\n", check.name, check.value, check.unit,
                   check.fault.empty() ? std::string("passed") : name_of(check.verdict) + (": " + check.fault));
    return status_of(record.checks);
}

}  // namespace

void add_play(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<PlayCommand>();
    PlayOptions& options = command->options;
    CLI::App* play = app.add_subcommand("play", "Fly through a scene, in a window or headless with a report");
    play->footer(k_examples);
    play->add_option("scene", options.scene,
                     "The scene, *.eco.json; a folder that coppice populate made; or a plant: *.glb, *.gltf, "
                     "species *.json, *.plant")
        ->required();
    play->add_option("--path", options.path, "Camera path, *.json, in place of the scene's own");
    play->add_option("--headless", command->headless,
                     "Size of the picture, as 1280x720; no window is opened");
    play->add_option("--out", options.out, "Folder for pictures, frames.csv, summary.json and index.html");
    play->add_option("--frames", options.frames,
                     "So many frames from the start of the path; 0: the whole path")
        ->check(CLI::Range(0, 1'000'000))
        ->capture_default_str();
    play->add_option("--fps", options.fps, "Frames a second of flight; a fixed step")
        ->check(CLI::Range(0.01, 1000.0))
        ->capture_default_str();
    play->add_option("--pictures", options.pictures, "Frames to keep, as 0,30,60, or how many evenly spread")
        ->capture_default_str();
    play->add_option("--warmup", options.warmup, "Frames drawn before the first measured one of each repeat")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    play->add_option("--repeats", options.repeats, "Headless: fly the path so often")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    play->add_option("--budget", command->budgets, describe_budgets())->type_name("NAME=LIMIT,...");
    play->add_option("--golden", options.golden.folder,
                     "Folder of pictures that this run's must agree with; exit code 1 where one does not");
    play->add_option("--golden-tolerance", options.golden.tolerance,
                     "Mean FLIP of the square of 16 x 16 pixels that differs most, up to which pictures agree")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    play->add_flag("--golden-update", options.golden.update, "Keep this run's pictures as the goldens");
    play->add_option("--record", options.record, "Of a window: the path that was flown, for --path, as *.json");
    play->add_option("--sample-distance", command->sample_distance_px,
                     "d' in pixels; smaller draws more. Default: what the scene recommends")
        ->check(CLI::Range(0.01, 1000.0));
    play->add_option("--vertices", options.settings.vertex_budget,
                     "Points + 2 lines + 3 triangles of plants a frame may draw: d' grows as far as that "
                     "takes. 0: any "
                     "number")
        ->capture_default_str();
    play->add_option("--frame-ms", options.settings.time_budget_ms,
                     "Likewise what a frame may take, by what vertices were learned to cost. 0: any time")
        ->check(CLI::Range(0.0, 10'000.0))
        ->capture_default_str();
    play->add_option("--most-sample-distance", options.settings.most_sample_distance_px,
                     "--vertices and --frame-ms make d' no larger than this")
        ->check(CLI::Range(0.01, 1000.0))
        ->capture_default_str();
    play->add_option("--splat-factor", options.settings.splat_factor,
                     "c_p: points for each square of side d'")
        ->check(CLI::Range(0.01, 100.0))
        ->capture_default_str();
    const std::map<std::string, ProjectionMode> modes{{"printed", ProjectionMode::printed},
                                                      {"isotropic", ProjectionMode::isotropic},
                                                      {"measured", ProjectionMode::measured}};
    play->add_option("--projection", options.settings.projection,
                     "How areas and lengths are projected: printed, isotropic or measured")
        ->transform(CLI::CheckedTransformer(modes).description(""))
        ->default_str("measured");
    const std::map<std::string, RepresentationView> views{{"lit", RepresentationView::lit},
                                                          {"kinds", RepresentationView::kinds}};
    play->add_option("--view", options.settings.view,
                     "lit, or kinds: triangles green, leaves yellow, lines blue, points red")
        ->transform(CLI::CheckedTransformer(views).description(""))
        ->default_str("lit");
    const std::map<std::string, ShadowKind> shadow_kinds{{"none", ShadowKind::none},
                                                         {"uniform", ShadowKind::uniform},
                                                         {"perspective", ShadowKind::perspective},
                                                         {"light-space", ShadowKind::light_space},
                                                         {"clipmap", ShadowKind::clipmap}};
    play->add_option("--shadows", options.settings.shadows,
                     "The sun's shadow maps: clipmap, nested maps that stay while nothing moves; of each frame anew uniform, perspective\n"
                     "or light-space; none")
        ->transform(CLI::CheckedTransformer(shadow_kinds).description(""))
        ->default_str("clipmap");
    play->add_option("--sun", command->sun,
                     "Azimuth and elevation of the sun in degrees, as 135,20, in place of the scene's own")
        ->type_name("AZIMUTH,ELEVATION");
    play->add_option("--shadow-size", options.settings.shadow_side_texels,
                     "Texels of a side of a shadow map. 0: as the picture's pixels ask for")
        ->check(CLI::Range(0, 16384))
        ->capture_default_str();
    play->add_option("--shadow-distance", options.settings.shadow_distance_m,
                     "Metres along the view up to which shadows are seen")
        ->check(CLI::Range(1.0, 1e6))
        ->capture_default_str();
    play->add_option("--explain", command->explained_frame,
                     "With --headless: says of this frame what was drawn, at which level, why, and what spent the budget");
    play->add_flag("--full", command->full, "Every triangle: no level of detail");
    play->add_flag("--compare-full", options.compare_full,
                   "Also draw some of the frames with every triangle, in the same run");
    play->add_option("--compare-frames", options.compare_frames, "How many of them")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    play->add_option("--tile-memory", options.tile_memory_mib,
                     "Of a populated scene, MiB of tiles kept in memory, and as many on the device")
        ->check(CLI::Range(1, 1 << 20))
        ->capture_default_str();
    play->add_flag("--wait-for-tiles", options.settings.wait_for_tiles,
                   "Of a populated scene: every frame waits for the tiles it needs, whatever it takes");
    play->add_flag("--lockstep", command->lockstep,
                   "Headless: draw a frame for each line FRAME SLOWER of standard input, as coppice compare asks");
    play->add_option("--device", options.device, "Vulkan device, by index or part of its name");
    play->add_flag("--validation", options.validation,
                   "Vulkan's validation layers; any message fails the run");
    play->add_option("--cache", options.cache_dir, "Folder of cooked plants. Default: ~/.cache/coppice");
    play->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
