// `coppice inspect`: what is inside a packed plant.
#include "plugins/vegetation/cook/inspect.h"

#include <cstdio>
#include <memory>
#include "tools/coppice/command.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice inspect out/birch.plant
  coppice inspect out/birch.plant --json | jq '.parts[].points'

One line a part: what stands for it in the distance, triangles, points and lines stored, area, length of its lines and
their largest distance from the surface (eps_l), importance, projected area from above and from beside, mean colour.)";

struct InspectCommand {
    std::string file;
    bool json = false;
};

Status run(const InspectCommand& command) {
    COPPICE_TRY(const Plant plant, load_plant(command.file));
    std::fputs((command.json ? inspect_plant_json(plant) + "\n" : inspect_plant(plant)).c_str(), stdout);
    return {};
}

}  // namespace

void add_inspect(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<InspectCommand>();
    CLI::App* inspect = app.add_subcommand("inspect", "Show what is inside a packed plant");
    inspect->footer(k_examples);
    inspect->add_option("file", command->file, "The packed plant, *.plant")->required();
    inspect->add_flag("--json", command->json, "As JSON");
    inspect->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
