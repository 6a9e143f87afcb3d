#include "editor/session/session.h"

#include <cassert>
#include <filesystem>
#include <map>
#include "plugins/vegetation/eco/scene_file.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

// Of a file, or nothing.
std::optional<std::string> bytes_of(const std::string& path) {
    auto bytes = read_text_file(path, k_scene_file_limit_bytes);
    return bytes ? std::optional(std::move(*bytes)) : std::nullopt;
}

// A species file has a form, which scenes have not.
bool is_plant(const std::string& path) {
    if (path.ends_with(".glb") || path.ends_with(".gltf")) return true;
    if (!path.ends_with(".json")) return false;
    const auto bytes = bytes_of(path);
    if (!bytes) return false;
    const auto json = nlohmann::json::parse(*bytes, nullptr, false);
    return json.is_object() && json.contains("form") && !json.contains("placements");
}

Result<Document> open_document(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return Document::make(path);
    return is_plant(path) ? Document::for_plant(path) : Document::open(path);
}

void remove_file(const std::string& path) {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
}

}  // namespace

Result<std::unique_ptr<Session>> Session::open(const std::string& path, const Settings& settings) {
    // Before anything is read: what is read is then what stays.
    SceneLock lock;
    if (settings.journal) {
        COPPICE_TRY(lock, SceneLock::take(path));
    }
    COPPICE_TRY(Document document, open_document(path));
    std::unique_ptr<Session> session(new Session(std::move(document)));
    session->lock_ = std::move(lock);
    session->settings_ = settings;
    session->path_ = path;
    session->pictures_ = MapPictures(settings.find_images);
    session->warnings_ = session->document_.faults();
    const std::string journal = journal_path(session->document_.root_path());
    std::error_code ignored;
    if (settings.journal && std::filesystem::exists(journal, ignored)) {
        auto content = Journal::read(journal);
        if (content)
            session->recoverable_ = std::move(*content);
        else
            session->warnings_.push_back(content.error());
    }
    session->load_terrain();
    return session;
}

Session::~Session() {
    if (has_journal_ && saved()) drop_journal();
}

// Brings back, from beside them, the files that the edits were made of.
Status Session::restore_base(const JournalContent& journal) {
    std::map<std::string, std::string> wanted;
    bool changed = false;
    for (const JournalBase& file : journal.base) {
        if (file.hash == k_no_file) {
            if (file.path != document_.root_path())
                return fail(ErrorId::file_corrupt, journal_path(document_.root_path()), "",
                            "says that " + file.path + " was new; only the scene itself can be",
                            "the work is kept in the file that ends with .journal.old");
            std::error_code ignored;
            if (!std::filesystem::exists(file.path, ignored)) continue;
            std::filesystem::rename(file.path, file.path + ".bak", ignored);
            changed = true;
            continue;
        }
        bool found = false;
        for (const std::string& path : {file.path, file.path + ".bak"}) {
            auto bytes = bytes_of(path);
            if (!bytes || hash_text(*bytes) != file.hash) continue;
            if (path != file.path) wanted[file.path] = std::move(*bytes);
            found = true;
            break;
        }
        if (!found)
            return fail(ErrorId::file_corrupt, file.path, "", "was changed since the work that was not saved",
                        "the work is kept in the file that ends with .journal.old");
    }
    if (wanted.empty() && !changed) return {};
    // The newer files go aside as they were the older ones' backups until now.
    for (const auto& [path, bytes] : wanted) {
        const auto newer = bytes_of(path);
        COPPICE_CHECK(write_text_file(path, bytes));
        if (newer) COPPICE_CHECK(write_text_file(path + ".bak", *newer));
    }
    COPPICE_TRY(document_, open_document(path_));
    return {};
}

Result<size_t> Session::recover() {
    const std::string path = journal_path(document_.root_path());
    const JournalContent journal = std::exchange(recoverable_, {});
    if (Status restored = restore_base(journal); !restored) {
        COPPICE_CHECK(keep_old_journal(path, false));
        return fail(std::move(restored.error()));
    }
    std::vector<Edit> edits;
    for (const std::string& bytes : journal.edits) {
        auto named = read_named_edit(bytes, path);
        if (!named || !document_.has_room_for_kinds(named->kinds.size())) break;
        Edit edit =
            numbered(std::move(*named), [&](const std::string& name) { return document_.kind_of(name); });
        // What is read only when it is edited.
        for (const FileEdit& file : edit.files)
            if (file.before && !document_.find(file.path)) (void)document_.read(file.path);
        if (!document_.apply(edit)) break;
        edits.push_back(std::move(edit));
    }
    // The same journal goes on. Where not all of it holds, all of it is kept first, and one with what holds takes its place.
    const bool all = edits.size() == journal.edits.size();
    Result<Journal> made = Journal();
    if (!all) {
        if (auto kept = keep_old_journal(path, true)) {
            made = Journal::create(path, journal.base, {journal.edits.begin(), journal.edits.begin() + ptrdiff_t(edits.size())});
        } else {
            made = fail(kept.error());
        }
    } else {
        made = Journal::resume(path, journal);
    }
    if (made) {
        journal_ = std::move(*made);
        has_journal_ = true;
    } else {
        // It stays as it is; what is done from now on goes into no journal until there is room for one with everything.
        warnings_.push_back(made.error());
        unwritten_.assign(journal.edits.begin(), journal.edits.begin() + ptrdiff_t(edits.size()));
    }
    for (Edit& edit : edits) remember(std::move(edit));
    ++text_version_;
    load_terrain();
    return edits.size();
}

Status Session::discard_recovery() {
    recoverable_ = {};
    remove_file(journal_path(document_.root_path()));
    return {};
}

void Session::load_terrain() {
    const auto& json = document_.root().text->json;
    const auto terrain = json.find("terrain");
    const std::string text = terrain == json.end() ? "" : terrain->dump();
    if (text == terrain_text_) return;
    terrain_text_ = text;
    terrain_.reset();
    if (text.empty() || !settings_.terrain) return;
    const std::string& path = document_.root_path();
    auto loaded = settings_.terrain->load(text, std::filesystem::path(path).parent_path().string(), path);
    if (loaded)
        terrain_ = std::move(*loaded);
    else
        warnings_.push_back(loaded.error());
}

void Session::apply(const Edit& edit) {
    [[maybe_unused]] const bool fits = document_.apply(edit);
    assert(fits && "an edit of another document");
    for (const FileEdit& file : edit.files) {
        if (file.before == file.after && file.path == document_.root_path()) continue;
        ++text_version_;
        load_terrain();
    }
}

void Session::remember(Edit edit) {
    step_names_.resize(history_.done_count());
    step_names_.push_back(++last_step_name_);
    history_.push(std::move(edit));
}

// What could not be written waits, and goes first when there is room again.
void Session::write_journal(const Edit& edit) {
    if (!settings_.journal) return;
    unwritten_.push_back(write_edit(edit, document_.kinds()));
    if (!has_journal_) {
        auto made = Journal::create(journal_path(document_.root_path()), journal_base(document_),
                                    {unwritten_.begin(), unwritten_.end()});
        if (!made) return warnings_.push_back(made.error());
        journal_ = std::move(*made);
        has_journal_ = true;
        unwritten_.clear();
    }
    while (!unwritten_.empty()) {
        if (Status written = journal_.append(unwritten_.front()); !written)
            return warnings_.push_back(written.error());
        unwritten_.pop_front();
    }
}

Result<const Edit*> Session::perform(const std::string& name, const nlohmann::json& arguments,
                                     const std::string& source, const std::string& place) {
    COPPICE_TRY(Edit edit, make_edit(context(), name, arguments, source, place));
    if (edit.empty()) return nullptr;
    perform(std::move(edit));
    return &history_.edits()[history_.done_count() - 1];
}

void Session::perform(Edit edit) {
    assert(recoverable_.edits.empty() && open_edit_.empty());
    if (edit.empty()) return;
    apply(edit);
    write_journal(edit);
    remember(std::move(edit));
}

void Session::extend(Edit piece) {
    if (piece.empty()) return;
    apply(piece);
    if (open_edit_.files.empty()) {
        open_edit_ = std::move(piece);
        return;
    }
    // A stroke has one file.
    assert(piece.files.size() == 1 && open_edit_.files.size() == 1 &&
           piece.files[0].path == open_edit_.files[0].path);
    FileEdit& file = open_edit_.files[0];
    const FileEdit& more = piece.files[0];
    file.after = more.after;
    file.removed.insert(file.removed.end(), more.removed.begin(), more.removed.end());
    file.added.insert(file.added.end(), more.added.begin(), more.added.end());
}

void Session::finish(const std::string& name) {
    Edit edit = std::exchange(open_edit_, {});
    if (edit.empty()) return;
    edit.name = name;
    write_journal(edit);
    remember(std::move(edit));
}

std::string Session::undo() {
    const Edit* edit = history_.next_undo();
    if (!edit || !open_edit_.empty()) return {};
    Edit back = inverse(*edit);
    const std::string name = edit->name;
    back.name = "undo " + name;
    apply(back);
    write_journal(back);
    history_.undone();
    return name;
}

std::string Session::redo() {
    const Edit* edit = history_.next_redo();
    if (!edit || !open_edit_.empty()) return {};
    apply(*edit);
    write_journal(*edit);
    history_.redone();
    return edit->name;
}

Status Session::save(bool overwrite) {
    COPPICE_CHECK(document_.save(overwrite));
    saved_step_name_ = step_name();
    // What follows is of the files as they are now.
    drop_journal();
    return {};
}

void Session::drop_journal() {
    unwritten_.clear();
    if (!has_journal_) return;
    journal_ = {};
    has_journal_ = false;
    remove_file(journal_path(document_.root_path()));
}

}  // namespace coppice
