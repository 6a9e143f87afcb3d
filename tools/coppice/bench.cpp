// `coppice bench`: figures of one kind, with what they are to reach.
#include "tools/coppice/bench.h"

#include <algorithm>
#include <memory>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include "runtime/core/file.h"
#include "tools/coppice/bench_accuracy.h"
#include "tools/coppice/bench_compare.h"
#include "tools/coppice/bench_cook.h"
#include "tools/coppice/bench_ecs.h"
#include "tools/coppice/bench_foliage.h"
#include "tools/coppice/bench_queries.h"
#include "tools/coppice/bench_raster.h"
#include "tools/coppice/bench_scale.h"
#include "tools/coppice/bench_scenes.h"
#include "tools/coppice/bench_shadows.h"
#include "tools/coppice/bench_stability.h"
#include "tools/coppice/command.h"

namespace coppice {
namespace {

struct BenchCommand {
    std::string name, json_file;
    BenchSettings settings;
    bool strict = false;
};

std::string list_benches() {
    std::string text = "\nBenchmarks:\n";
    for (const Bench& bench : benches()) text += fmt::format("  {:<10}{}\n", bench.name, bench.what);
    return text + R"(
Examples:
  coppice bench ecs
  coppice bench cook --json out/cook.json
  coppice bench raster --device llvmpipe --json out/raster.json
  coppice bench stand --strict        exit code 1 where a figure does not reach what it is to reach
  coppice bench accuracy --scene woodland --out out/accuracy-woodland
      open out/accuracy-woodland/index.html; the first run traces the references, which takes minutes
  coppice bench foliage --scene tree.glb --out out/foliage-tree
  coppice bench accuracy --methods 'measured;billboards' --views my_views.json)";
}

// Prints the table; returns how many figures do not hold.
int print_table(const nlohmann::json& result) {
    int missed = 0;
    fmt::print("{:<44}{:>14}  {:<12}{:>12}\n", "figure", "value", "unit", "reach");
    for (const nlohmann::json& figure : result.at("figures")) {
        const bool asked = !figure.at("holds").is_null();
        const bool holds = !asked || figure.at("holds").get<bool>();
        missed += !holds;
        fmt::print("{:<44}{:>14.6g}  {:<12}{:>12}  {}\n", figure.at("name").get<std::string>(),
                   figure.at("value").get<double>(), figure.at("unit").get<std::string>(),
                   asked ? fmt::format("{:g}", figure.at("reach").get<double>()) : "",
                   !asked  ? ""
                   : holds ? "holds"
                           : "NOT REACHED");
    }
    return missed;
}

Status run(const BenchCommand& command) {
    auto bench = std::find_if(benches().begin(), benches().end(),
                              [&](const Bench& b) { return b.name == command.name; });
    if (bench == benches().end()) {
        std::vector<std::string> names;
        for (const Bench& known : benches()) names.emplace_back(known.name);
        return fail(ErrorId::name_unknown, "", "", fmt::format("no benchmark is called '{}'", command.name),
                    fmt::format("use one of: {}", fmt::join(names, ", ")));
    }
    COPPICE_TRY(const nlohmann::json result, bench->run(command.settings));
    const int missed = print_table(result);
    if (!command.json_file.empty()) COPPICE_CHECK(write_text_file(command.json_file, result.dump(2) + "\n"));
    if (command.strict && missed > 0)
        return fail(ErrorId::regressed, "", "bench " + command.name,
                    fmt::format("{} figures do not hold", missed), "see the table");
    return {};
}

}  // namespace

const std::vector<Bench>& benches() {
    static const std::vector<Bench> k_benches{
        {"accuracy", "time against error of every method, against a ray-traced reference; a page of curves",
         bench_accuracy},
        {"compare", "whether coppice compare finds a slowdown of 10 % and passes a program against itself", bench_compare},
        {"cook", "sampling of an oak, whole cooks of oak and pine, the same bytes on 1 and 2 threads",
         bench_cook},
        {"ecs", "a million entities in tiles of 1,000: create, destroy, iterate, find",
         [](const BenchSettings&) { return bench_ecs(); }},
        {"foliage",
         "levels of crowns: extraction, bytes, coverage, storage, for VDF, LoDF and lifetimes; a page",
         bench_foliage},
        {"queries", "rays, nearest stems, boxes and edits among a million stems, on one core",
         [](const BenchSettings&) { return bench_queries(); }},
        {"raster", "points, lines and triangles a second of the rasteriser alone",
         [](const BenchSettings& settings) { return bench_raster(settings.device); }},
        {"frame", "what the CPU does for a frame of 100,000 plants: cull, levels, budget, work list",
         bench_frame},
        {"pines", "640 pines at 795x700, also with every triangle", bench_pines},
        {"scale", "one view and budget over 10^7 to 10^12 triangles; a page. Makes 250 MiB of scenes",
         bench_scale},
        {"scenes", "pines, palms, landscape and sunflowers at 795x700: rate, primitives, memory",
         bench_table},
        {"shadows", "each kind of shadow map on the scenes of Table 1: cost, and steps of sweeps of view and sun", bench_shadows},
        {"stability", "laws of the shadow maps over every angle of light and view: worst values",
         [](const BenchSettings&) { return bench_stability(); }},
        {"stand", "640, 5,000 and 50,000 trees, against other programs' times", bench_stand},
    };
    return k_benches;
}

void add_bench(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<BenchCommand>();
    CLI::App* bench = app.add_subcommand("bench", "Measure, and compare with what is to be reached");
    bench->footer(list_benches());
    bench->add_option("name", command->name, "Which benchmark")->required();
    bench->add_option("--json", command->json_file, "Also write the figures into this file");
    bench->add_option("--device", command->settings.device, "Vulkan device, by index or part of its name");
    bench->add_option("--content", command->settings.content, "Folder of scenes and species")
        ->default_val("content");
    bench->add_option("--cache", command->settings.cache_dir,
                      "Folder of cooked plants. Default: ~/.cache/coppice");
    bench->add_option(
        "--scene", command->settings.scene,
        "accuracy: a scene of the content, or *.eco.json, or a plant; default pines. foliage: a plant; "
        "default three trees. shadows: a scene; default those of Table 1");
    bench->add_option(
        "--views", command->settings.views,
        "accuracy: camera path whose keys are the views. Default: SCENE_views.json, else five of its flight");
    bench->add_option("--methods", command->settings.methods,
                      "accuracy: names or parts of names, with ; between. Default: all");
    bench->add_option("--size", command->settings.size, "accuracy, foliage: of the pictures")
        ->capture_default_str();
    bench->add_option(
        "--out", command->settings.out,
        "accuracy, foliage, scale: folder for the page. Default: out/accuracy-SCENE, out/foliage, out/scale");
    bench->add_option("--comparisons", command->settings.comparisons, "compare: how many of each kind")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    bench->add_flag("--strict", command->strict, "Exit with 1 where a figure does not hold");
    bench->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
