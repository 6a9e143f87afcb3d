// `coppice inspect`: what is inside a packed plant, or how few models a population needs.
#include "plugins/vegetation/cook/inspect.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/eco/measure_population.h"
#include "plugins/vegetation/eco/quantise.h"
#include "runtime/core/file.h"
#include "runtime/plugin/registry.h"
#include "tools/coppice/command.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice inspect out/birch.plant
  coppice inspect out/birch.plant --json | jq '.parts[].points'
  coppice inspect content/species/birch.json --individuals 100

Of a plant, one line a part: what stands for it in the distance, triangles, points and lines stored, area, length of its
lines and their largest distance from the surface (eps_l), importance, projected area from above and from beside, mean
colour.
Of a species, one line a number of models: what a scene's "variations" would be worth to that many "individuals". The error
is the RMS, over the individuals, of how much each differs from the model drawn for it once that has the same height: 1
where widths, areas and colours are as far off as they spread in the population.)";

constexpr uint32_t k_most_models = 64;  // shown; populations need five to ten

struct InspectCommand {
    std::string file;
    uint32_t individual_count = 0;
    bool json = false;
};

Result<std::vector<PlantFeatures>> measure_species(const InspectCommand& command) {
    Registry registry;
    COPPICE_CHECK(registry.load("modeller"));
    const auto* modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
    return measure_population({command.file, command.individual_count}, modeller, default_cache_dir());
}

// 1, 2, 4 ... and the last.
std::vector<Quantised> quantise_by_doubling(const std::vector<PlantFeatures>& individuals) {
    const uint32_t last = std::min(uint32_t(individuals.size()), k_most_models);
    std::vector<Quantised> steps;
    for (uint32_t count = 1; count < last; count *= 2) steps.push_back(quantise(individuals, count));
    steps.push_back(quantise(individuals, last));
    return steps;
}

std::string population_table(const std::string& file, const std::vector<PlantFeatures>& individuals,
                             const std::vector<Quantised>& steps) {
    const auto [lowest, tallest] = std::ranges::minmax(individuals, {}, &PlantFeatures::height_m);
    std::string text =
        fmt::format("{}: {} individuals, {:.2f} to {:.2f} m tall\n{:>6} {:>7}  {}\n", file,
                    individuals.size(), lowest.height_m, tallest.height_m, "models", "error", "scaled by");
    for (const Quantised& step : steps) {
        const auto [least, most] = std::ranges::minmax(step.scale_of);
        text += fmt::format("{:>6} {:>7.3f}  {:.2f} to {:.2f}\n", step.medoids.size(),
                            step.error_by_count.back(), least, most);
    }
    return text;
}

std::string population_json(const std::vector<PlantFeatures>& individuals,
                            const std::vector<Quantised>& steps) {
    using nlohmann::ordered_json;
    const auto [lowest, tallest] = std::ranges::minmax(individuals, {}, &PlantFeatures::height_m);
    ordered_json rows = ordered_json::array();
    for (const Quantised& step : steps) {
        const auto [least, most] = std::ranges::minmax(step.scale_of);
        rows.push_back({{"models", step.medoids.size()},
                        {"error", step.error_by_count.back()},
                        {"scale_least", least},
                        {"scale_most", most},
                        {"individuals", step.medoids}});
    }
    return ordered_json{{"individuals", individuals.size()},
                        {"height_least_m", lowest.height_m},
                        {"height_most_m", tallest.height_m},
                        {"quantised", std::move(rows)}}
               .dump(2) +
           "\n";
}

Status run(const InspectCommand& command) {
    const bool species = command.file.ends_with(".json");
    if (species != (command.individual_count > 0))
        return fail(ErrorId::usage, command.file, "",
                    species ? "a species, and no --individuals" : "--individuals of what is no species",
                    "coppice inspect SPECIES.json --individuals 100, or coppice inspect NAME.plant");
    std::string text;
    if (species) {
        COPPICE_TRY(const std::vector<PlantFeatures> individuals, measure_species(command));
        const std::vector<Quantised> steps = quantise_by_doubling(individuals);
        text = command.json ? population_json(individuals, steps)
                            : population_table(command.file, individuals, steps);
    } else {
        COPPICE_TRY(const Plant plant, load_plant(command.file));
        text = command.json ? inspect_plant_json(plant) + "\n" : inspect_plant(plant);
    }
    std::fputs(text.c_str(), stdout);
    return {};
}

}  // namespace

void add_inspect(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<InspectCommand>();
    CLI::App* inspect = app.add_subcommand(
        "inspect", "Show what is inside a packed plant, or how few models a species needs");
    inspect->footer(k_examples);
    inspect->add_option("file", command->file, "The packed plant, *.plant; or a species, *.json")->required();
    inspect
        ->add_option(
            "--individuals", command->individual_count,
            "Grow so many of the species and show what is lost by drawing them as 1, 2, 4 ... models")
        ->check(CLI::Range(1u, k_individual_limit));
    inspect->add_flag("--json", command->json, "As JSON");
    inspect->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
