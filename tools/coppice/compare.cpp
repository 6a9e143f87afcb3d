// `coppice compare`: whether NEW is slower than BASE, or draws more.
#include <filesystem>
#include <memory>
#include <fmt/format.h>
#include "runtime/core/file.h"
#include "tools/coppice/command.h"
#include "tools/coppice/compare_folders.h"
#include "tools/coppice/compare_programs.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice compare old/bin/coppice build/release/bin/coppice --scene content/scenes/pines.eco.json
      both programs draw the same frames in turn: slower, faster or the same, and counts that changed
  coppice play content/scenes/pines.eco.json --headless 795x700 --repeats 5 --out out/before
  coppice play content/scenes/pines.eco.json --headless 795x700 --repeats 5 --out out/after
  coppice compare out/before out/after
      two reports; what changed on the machine between them cannot be told from what changed in the program
Slower or more by less than --floor is the same. Exit codes: 0 same or faster, 1 slower or a count grew, 4 the machine is
too noisy: BASE would fail against itself.)";

struct CompareCommand {
    ProgramsToCompare programs;
    std::string scene, size = "480x320", json_file;
    double floor_percent = 3.0;
};

Status run(CompareCommand command) {
    ProgramsToCompare& programs = command.programs;
    programs.floor_share = command.floor_percent / 100.0;
    const bool folders =
        std::filesystem::is_directory(programs.base) && std::filesystem::is_directory(programs.changed);
    if (!folders && command.scene.empty())
        return fail(ErrorId::usage, "", "--scene", "two programs need a scene to fly",
                    "name it, or two folders of reports");
    programs.arguments = {command.scene, "--headless", command.size};
    Result<Comparison> comparison =
        folders ? compare_folders(programs.base, programs.changed, programs.floor_share)
                : compare_programs(programs);
    if (!comparison) return fail(std::move(comparison.error()));
    fmt::print("{}", describe(*comparison));
    if (!command.json_file.empty())
        COPPICE_CHECK(write_text_file(command.json_file, to_json(*comparison).dump(2) + "\n"));
    return status_of(*comparison);
}

}  // namespace

void add_compare(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<CompareCommand>();
    CLI::App* compare =
        app.add_subcommand("compare", "Is NEW slower than BASE? Two programs, or two reports");
    compare->footer(k_examples);
    compare->add_option("base", command->programs.base, "Program, or folder that play --out left")
        ->required();
    compare->add_option("new", command->programs.changed, "Likewise")->required();
    compare->add_option("--scene", command->scene, "Of two programs: what both fly through");
    compare->add_option("--headless", command->size, "Of two programs: size of the picture")
        ->capture_default_str();
    compare->add_option("--seconds", command->programs.seconds, "Of two programs: time to draw")
        ->check(CLI::Range(0.1, 3600.0))
        ->capture_default_str();
    compare->add_option("--floor", command->floor_percent, "Percent below which a difference is none")
        ->check(CLI::Range(0.0, 100.0))
        ->capture_default_str();
    compare->add_option("--json", command->json_file, "Also write the comparison into this file");
    compare->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
