// `coppice-editor`: lays out scenes by hand, or by a script without a window.
#include <cstdio>
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include "editor/session/run_script.h"
#include "editor/view/bench_editing.h"
#include "editor/window/window_interface.h"
#include "runtime/plugin/registry.h"

namespace coppice {
namespace {

struct Options {
    std::string scene, script;
    bool recover = false, discard = false, bench = false;
    EditorWindowSettings window;
};

int report_error(const Error& error) {
    fmt::print(stderr, "error: {}\n", to_string(error));
    return exit_code_of(error.id);
}

void print_warnings(Session& session) {
    for (const Error& warning : session.take_warnings())
        fmt::print(stderr, "warning: {}\n", to_string(warning));
}

Status settle_recovery(Session& session, const Options& options) {
    const size_t count = session.recoverable_count();
    if (count == 0) return {};
    if (options.discard) return session.discard_recovery();
    if (!options.recover)
        return fail(ErrorId::usage, journal_path(session.document().root_path()), "",
                    fmt::format("an earlier run left {} steps that were not saved", count),
                    "add --recover to have them back, or --discard");
    COPPICE_TRY(const size_t recovered, session.recover());
    fmt::print("recovered {} of {} steps\n", recovered, count);
    return {};
}

Status run(const Options& options) {
    Registry registry;
    const TerrainInterface* terrain = nullptr;
    if (registry.load("terrain"))
        terrain = registry.find<TerrainInterface>(k_terrain_interface, k_terrain_version);
    if (options.bench) {
        EditorViewSettings view;
        view.device = options.window.device;
        view.validation = options.window.validation;
        return bench_editing(registry, terrain, options.scene, view);
    }
    COPPICE_TRY(const std::unique_ptr<Session> session, Session::open(options.scene, {terrain, true, [&registry]() -> const ImagesInterface* {
                                       if (!registry.load("images")) return nullptr;
                                       return registry.find<ImagesInterface>(k_images_interface,
                                                                             k_images_version);
                                   }}));
    if (options.script.empty()) {
        COPPICE_CHECK(registry.load("editor_window"));
        const auto* window =
            registry.find<EditorWindowInterface>(k_editor_window_interface, k_editor_window_version);
        if (!window)
            return fail(ErrorId::name_unknown, "", "plugin editor_window", "does not provide its interface",
                        "install the plugin of this version");
        return window->run(registry, *session, options.window);
    }
    print_warnings(*session);
    const bool has_recovered = options.recover && session->recoverable_count() > 0;
    COPPICE_CHECK(settle_recovery(*session, options));
    const Status done = run_script(*session, options.script);
    print_warnings(*session);
    // It came to its end: what it did not save it did not mean to. Only a run that is killed leaves a journal, and one that had
    // steps of an earlier run back and did not save them.
    if (!has_recovered || session->saved()) session->drop_journal();
    return done;
}

int run(int argc, char** argv) {
    CLI::App app(
        "Lays out plants in a scene.\nExit codes: 0 done, 1 not as expected, 2 bad input or usage, 3 no "
        "usable device.",
        "coppice-editor");
    Options options;
    app.add_option("SCENE", options.scene, "an *.eco.json file; made where there is none")->required();
    app.add_option("--script", options.script, "does the commands of this file, without a window");
    app.add_flag("--bench", options.bench,
                 "measures editing in this scene, without a window, and saves nothing")
        ->excludes("--script");
    app.add_flag("--recover", options.recover, "what an earlier run left unsaved is done again first");
    app.add_flag("--discard", options.discard, "what an earlier run left unsaved is dropped")
        ->excludes("--recover");
    app.add_option("--width", options.window.width, "of the window")->check(CLI::Range(64, 16384));
    app.add_option("--height", options.window.height, "of the window")->check(CLI::Range(64, 16384));
    app.add_option("--scale", options.window.scale, "size of all text; else the display's")
        ->check(CLI::Range(0.5, 4.0));
    app.add_flag("--light", options.window.light, "begin with the light theme");
    app.add_option("--device", options.window.device, "index or part of the name of a Vulkan device");
    app.add_flag("--validation", options.window.validation, "with Vulkan's validation layer");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        const int code = app.exit(error);
        return code == 0 ? 0 : 2;
    }
    if (Status done = run(options); !done) return report_error(done.error());
    return 0;
}

}  // namespace
}  // namespace coppice

int main(int argc, char** argv) {
    try {
        return coppice::run(argc, argv);
    } catch (const std::bad_alloc&) {
        return coppice::report_error(
            {coppice::ErrorId::limit_exceeded, "", "", "out of memory", "a smaller scene, or more memory"});
    }
}
