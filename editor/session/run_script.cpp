#include "editor/session/run_script.h"

#include <fmt/format.h>
#include "editor/commands/exchange.h"
#include "editor/commands/target.h"
#include "runtime/core/file.h"

namespace coppice {
namespace {

constexpr const char* k_session_commands[] = {"undo", "redo", "save", "export_csv", "export_gltf", "expect"};

Status step_back(JsonObject& arguments, bool forward, Session& session) {
    const uint64_t times = arguments.whole("times", 1, UINT32_MAX, 1);
    arguments.close();
    COPPICE_CHECK(arguments.document().status());
    for (uint64_t i = 0; i < times; ++i)
        if ((forward ? session.redo() : session.undo()).empty())
            return fail(ErrorId::value_out_of_range, arguments.document().file(), arguments.place_of("times"),
                        fmt::format("there are only {} steps", i), "fewer");
    return {};
}

Status export_plants(JsonObject& arguments, bool csv, Session& session) {
    const Target target = read_target(session.context(), arguments);
    const std::string name = arguments.text(csv ? "csv" : "gltf");
    arguments.close();
    COPPICE_CHECK(arguments.document().status());
    return write_text_file(Document::resolve(target.path, name),
                           csv ? placed_as_csv(session.document(), *target.file)
                               : placed_as_gltf(session.document(), *target.file, target.terrain, name.ends_with(".glb")));
}

// So many chosen plants; without "least" and "most": exactly "count".
Status expect(JsonObject& arguments, Session& session) {
    const Target target = read_target(session.context(), arguments);
    if (!target.file) return arguments.document().status();
    COPPICE_TRY(const SceneNames names, names_of(session.changing_document(), *target.file, target.path));
    const std::vector<PlacedPlant> chosen =
        read_selection(arguments, session.document(), *target.file, names);
    const bool exact = arguments.has("count");
    const uint64_t count = arguments.whole("count", 0, UINT64_MAX, 0);
    const uint64_t least = arguments.whole("least", 0, UINT64_MAX, exact ? count : 0);
    const uint64_t most = arguments.whole("most", 0, UINT64_MAX, exact ? count : UINT64_MAX);
    const std::string place = arguments.place_of("count");
    arguments.close();
    COPPICE_CHECK(arguments.document().status());
    if (chosen.size() >= least && chosen.size() <= most) return {};
    return fail(ErrorId::regressed, arguments.document().file(), place,
                fmt::format("{} plants", chosen.size()),
                exact ? fmt::format("{} are expected", count)
                      : fmt::format("from {} to {} are expected", least, most));
}

Status run_command(Session& session, JsonDocument& script, const std::string& name,
                   const nlohmann::json& value, const std::string& place) {
    const bool own = std::find(std::begin(k_session_commands), std::end(k_session_commands), name) !=
                     std::end(k_session_commands);
    if (!own) {
        COPPICE_TRY([[maybe_unused]] const Edit* edit, session.perform(name, value, script.file(), place));
        return {};
    }
    JsonObject arguments(script, value, place);
    if (name == "undo" || name == "redo") return step_back(arguments, name == "redo", session);
    if (name == "expect") return expect(arguments, session);
    if (name != "save") return export_plants(arguments, name == "export_csv", session);
    const bool overwrite = arguments.truth("overwrite", false);
    arguments.close();
    COPPICE_CHECK(script.status());
    return session.save(overwrite);
}

}  // namespace

Status run_script(Session& session, const std::string& script_path) {
    COPPICE_TRY(const std::string text, read_text_file(script_path));
    COPPICE_TRY(JsonDocument script, JsonDocument::parse(text, script_path));
    JsonObject root(script, script.root(), "");
    const nlohmann::json* commands = root.find("commands");
    if (!commands || !commands->is_array())
        root.report(ErrorId::syntax, "commands", commands ? "found " + shown(*commands) : "missing",
                    "write [{\"paint\": {...}}, ...]");
    root.close();
    COPPICE_CHECK(script.status());
    for (size_t i = 0; i < commands->size(); ++i) {
        const nlohmann::json& entry = (*commands)[i];
        const std::string place = fmt::format("commands[{}]", i);
        if (!entry.is_object() || entry.size() != 1)
            return fail(ErrorId::syntax, script_path, place, "found " + shown(entry),
                        "one command with its arguments: {\"paint\": {...}}");
        const auto command = entry.begin();
        COPPICE_CHECK(
            run_command(session, script, command.key(), command.value(), place + "." + command.key()));
    }
    return {};
}

}  // namespace coppice
