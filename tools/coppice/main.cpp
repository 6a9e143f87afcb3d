// The `coppice` program: one file a subcommand. Whatever goes wrong is one line on standard error and an exit
// code.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include "tools/coppice/command.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice play content/scenes/woodland.eco.json --headless 1280x720 --out out/woodland
      flies through a scene and leaves pictures, a table of frames and a page to read
  coppice cook content/species/birch.json -o out/birch.plant
      grows a birch and packs it with its points and lines
  coppice inspect out/birch.plant
      shows what is inside
  coppice bench raster --json out/raster.json
      measures the rasteriser

Every subcommand explains itself: coppice SUBCOMMAND --help

Exit codes:
  0 passed   1 failed or regressed   2 bad input or usage   3 no usable device   4 inconclusive (noise))";

int report_error(const Error& error) {
    std::fflush(stdout);
    std::fprintf(stderr, "coppice: %s\n", to_string(error).c_str());
    return exit_code_of(error.id);
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(command->get_name());
    return names;
}

int run(int argc, char** argv) {
    CLI::App app{"Coppice draws plant ecosystems of any size at a frame cost set by the picture."};
    app.name("coppice");
    app.footer(k_examples);
    app.set_version_flag("--version", "coppice " COPPICE_VERSION);
    app.get_formatter()->column_width(34);
    Command chosen;
    add_cook(app, chosen);
    add_inspect(app, chosen);
    add_play(app, chosen);
    add_populate(app, chosen);
    add_bench(app, chosen);
    add_compare(app, chosen);
    add_bundle(app, chosen);

    const std::vector<std::string> names = subcommand_names(app);
    const std::string first = argc < 2 ? "" : argv[1];
    const bool is_option = first.starts_with('-');
    const std::string remedy = fmt::format("use one of: {}; or --help", fmt::join(names, ", "));
    if (first.empty()) return report_error({ErrorId::usage, "", "", "no subcommand", remedy});
    if (!is_option && std::find(names.begin(), names.end(), first) == names.end())
        return report_error(
            {ErrorId::name_unknown, "", "", fmt::format("no subcommand is called '{}'", first), remedy});
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
        const std::string command = is_option ? "" : fmt::format(" {}", first);
        return report_error({ErrorId::usage, "", "", error.what(), "see coppice" + command + " --help"});
    }
    if (!chosen) return report_error({ErrorId::usage, "", "", "no subcommand", remedy});
    Status status = chosen();
    return status ? 0 : report_error(status.error());
}

}  // namespace
}  // namespace coppice

int main(int argc, char** argv) {
    try {
        return coppice::run(argc, argv);
    } catch (const std::bad_alloc&) {
        return coppice::report_error({coppice::ErrorId::limit_exceeded, "", "", "out of memory",
                                      "a smaller scene or picture, or more memory"});
    } catch (const std::exception& exception) {
        return coppice::report_error({coppice::ErrorId::value_out_of_range, "", "", exception.what(),
                                      "please report this with the command line"});
    }
}
