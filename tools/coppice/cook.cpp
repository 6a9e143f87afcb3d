// `coppice cook`: a plant as its author wrote it becomes a packed plant.
#include <map>
#include <memory>
#include <fmt/format.h>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cook/inspect.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/command.h"
#include "tools/coppice/stopwatch.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice cook content/species/birch.json -o out/birch.plant
  coppice cook content/species/birch.json --variation 3 -o out/birch_3.plant
      another individual of the species
  coppice cook tree.glb -o out/tree.plant --order shuffled --sampler area
      a plant from any modelling tool; the file's extras may say which parts become points or lines

The same input gives the same bytes, on every machine. What comes out is a cache: it can be deleted and made again.)";

struct CookCommand {
    std::string source, out;
    uint64_t variation = 0;
    CookSettings settings;
};

Status run(const CookCommand& command) {
    Registry registry;
    COPPICE_CHECK(registry.load("modeller"));
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    const ImagesInterface* images = nullptr;
    if (!command.source.ends_with(".json") && registry.load("images"))
        images = registry.find<ImagesInterface>(k_images_interface, k_images_version);

    Stopwatch clock;
    COPPICE_CHECK(
        cook_file(command.source, command.out, command.variation, command.settings, modeller, images));
    const double cook_s = clock.ms() * 1e-3;
    COPPICE_TRY(const Plant plant, load_plant(command.out));
    fmt::print("{}{}: {:.1f} KiB in {:.2f} s, {:.2f} M triangles a second\n", inspect_plant(plant),
               command.out, double(plant.file->bytes().size()) / 1024.0, cook_s,
               double(plant.triangle_vertices.size() / 3) * 1e-6 / cook_s);
    return {};
}

}  // namespace

void add_cook(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<CookCommand>();
    CookSettings& settings = command->settings;
    settings.show_progress = true;
    CLI::App* cook = app.add_subcommand("cook", "Make a packed plant from a species file or a glTF model");
    cook->footer(k_examples);
    cook->add_option("plant", command->source, "*.json (species), *.glb or *.gltf")->required();
    cook->add_option("-o,--output", command->out, "The packed plant, *.plant")->required();
    cook->add_option("--variation", command->variation, "Which individual of a species")
        ->capture_default_str();
    const std::map<std::string, PointSampler> samplers{{"automatic", PointSampler::automatic},
                                                       {"area", PointSampler::area},
                                                       {"two-per-triangle", PointSampler::two_per_triangle}};
    cook->add_option("--sampler", settings.sampler,
                     "How points are laid out: automatic, area or two-per-triangle")
        ->transform(CLI::CheckedTransformer(samplers).description(""))
        ->default_str("automatic");
    const std::map<std::string, PrefixOrder> orders{{"progressive", PrefixOrder::progressive},
                                                    {"shuffled", PrefixOrder::shuffled}};
    cook->add_option("--order", settings.order, "progressive: every prefix is well spread; or shuffled")
        ->transform(CLI::CheckedTransformer(orders).description(""))
        ->default_str("progressive");
    cook->add_option("--points-per-triangle", settings.points_per_triangle,
                     "Points stored, of the sampler area")
        ->check(CLI::Range(0.01, 64.0))
        ->capture_default_str();
    cook->add_option("--seed", settings.seed, "Of the order and the points")->capture_default_str();
    cook->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
