// What the editor opens: scenes, the plants placed in them, journals and scripts. Whatever came through must be a document that
// can be worked on, undone and saved.
#include <filesystem>
#include <iterator>
#include "editor/session/run_script.h"
#include "plugins/terrain/load_terrain.h"
#include "plugins/vegetation/eco/placed_plants.h"
#include "tests/hostile/editor_files.h"
#include "tests/hostile/reader.h"
#include "tests/hostile/require.h"
#include "tests/hostile/scratch.h"

namespace coppice::hostile {
namespace {

constexpr TerrainInterface k_terrain{sizeof(TerrainInterface), load_terrain};
const Session::Settings k_without_journal{&k_terrain, false};

void require_sound(Document& document) {
    for (const Error& fault : document.faults()) require_clear(fault);
    for (const auto& [path, file] : document.files()) {
        if (!file.text) continue;
        require(parse_scene_text(file.text->text, path).has_value(),
                "a text that would be saved can be read");
        const SceneTextPtr printed = print_scene_text(file.text->json);
        const auto again = parse_scene_text(printed->text, path);
        require(again && (*again)->json == file.text->json, "a text that is printed says the same");
        if (const auto plants = document.plants_bytes(file)) {
            const auto placed = coppice::read_placed(*plants, file.placed_path);
            require(placed && placed->plants.size() == file.plants.size(), "saved plants can be read");
        }
    }
}

// A step that may be refused, but leaves nothing behind when it is undone.
void require_work(Session& session) {
    static const nlohmann::json k_steps[] = {
        {{"place", {{"population", "oak"}, {"at", {1, 2}}}}},
        {{"paint",
          {{"scatter", {{"plant", "oak"}, {"density_per_m2", 0.2}}},
           {"stroke", {{0, 0}, {6, 0}}},
           {"radius_m", 3}}}},
        {{"delete", {{"region", {{"circle", {{"center", {0, 0}}, {"radius_m", 20}}}}}}}},
        {{"add_population", {{"name", "hostile_fern"}, {"source", "fern.json"}}}},
        {{"add_tile", {{"scene", "another.eco.json"}, {"at", {200, 0}}}}}};
    const size_t done_before = session.history().done_count();
    const auto work_and_undo = [&] {
        for (const nlohmann::json& step : k_steps) {
            const auto done = session.perform(step.begin().key(), step.begin().value(), "steps", "");
            if (!done) require_clear(done.error());
        }
        while (session.history().done_count() > done_before) session.undo();
        return session.document().hash();
    };
    // The first time, files that are referred to are read.
    const std::string text = session.document().root().text->text;
    const uint64_t before = work_and_undo();
    require(work_and_undo() == before && session.document().root().text->text == text,
            "what was undone is as it was");
    for (const Error& warning : session.take_warnings()) require_clear(warning);
}

// Refers to itself, and on to the scene of the test.
constexpr const char* k_another =
    R"({"plants": {}, "placements": [], "references": [{"scene": "another.eco.json", "at": [9, 9]}, {"scene": "further.eco.json", "at": [0, 0]}]})";

bool open_and_work(const std::string& path) {
    const Scratch another("another.eco.json", std::string_view(k_another));
    const auto session = Session::open(path, k_without_journal);
    if (!accepted(session)) return false;
    require_sound((*session)->changing_document());
    require_work(**session);
    return true;
}

// Commands that write files wherever the script says are not for scripts of strangers.
bool writes_files(std::span<const std::byte> bytes) {
    const auto script = JsonDocument::parse(as_text(bytes), "script.json");
    if (!script || !script->root().is_object()) return false;
    const auto commands = script->root().find("commands");
    if (commands == script->root().end() || !commands->is_array()) return false;
    for (const nlohmann::json& command : *commands)
        for (const char* name : {"save", "export_csv", "export_gltf"})
            if (command.is_object() && command.contains(name)) return true;
    return false;
}

}  // namespace

bool read_edited_scene(std::span<const std::byte> bytes) {
    const Scratch scene("edited.eco.json", bytes);
    return open_and_work(scene.path());
}

bool read_edited_plants(std::span<const std::byte> bytes) {
    const Scratch scene("planted.eco.json", k_edited_scene), plants("planted.plants", bytes);
    const auto document = Document::open(scene.path());
    require(document.has_value(), "the scene is right");
    const bool lost = document->root().plants_lost;
    require(lost != document->faults().empty(), "plants that are lost are said to be");
    return open_and_work(scene.path()) && !lost;
}

bool read_script(std::span<const std::byte> bytes) {
    if (writes_files(bytes)) return false;
    const Scratch scene("scripted.eco.json", k_edited_scene), script("script.json", bytes);
    std::filesystem::remove(Scratch::folder() + "/planted.plants");
    const auto session = Session::open(scene.path(), k_without_journal);
    require(session.has_value(), "the scene is right");
    const Status done = run_script(**session, script.path());
    const bool regressed = !done && done.error().id == ErrorId::regressed;  // its own expectations
    const bool right = regressed || accepted(done);
    require_sound((*session)->changing_document());
    while (!(*session)->undo().empty()) continue;
    require((*session)->saved(), "what was undone is as it was");
    return right;
}

// The journal's own scene stands where the journal lies, in whatever folder that is.
bool read_journal(std::span<const std::byte> bytes) {
    const Scratch given("given.journal", bytes);
    auto content = Journal::read(given.path());
    if (!accepted(content)) return false;
    const Scratch scene("journalled.eco.json", k_edited_scene);
    for (const char* other : {"planted.plants", "journalled.eco.json.journal.old"})
        std::filesystem::remove(Scratch::folder() + "/" + other);
    for (JournalBase& file : content->base)
        if (file.path == k_journalled_scene) file.path = scene.path();
    for (std::string& bytes_of_edit : content->edits) {
        auto named = read_named_edit(bytes_of_edit, given.path());
        if (!accepted(named)) continue;
        for (FileEdit& file : named->edit.files)
            if (file.path == k_journalled_scene) file.path = scene.path();
        bytes_of_edit = write_edit(named->edit, named->kinds);
    }
    const Scratch journal("journalled.eco.json.journal", write_journal(*content));
    const auto session = Session::open(scene.path(), {&k_terrain, true});
    require(session.has_value(), "the scene is right");
    const auto recovered = (*session)->recover();
    if (!recovered) require_clear(recovered.error());
    const bool right = recovered && *recovered == content->edits.size();
    require_sound((*session)->changing_document());
    require_work(**session);
    (*session)->drop_journal();
    std::filesystem::remove(journal.path());
    return right;
}

}  // namespace coppice::hostile
