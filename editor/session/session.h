// One scene being worked on: the document, what was done to it, the journal of what is not saved yet.
#pragma once
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>
#include "editor/commands/command.h"
#include "editor/document/history.h"
#include "editor/document/journal.h"
#include "editor/session/scene_lock.h"

namespace coppice {

class Session {
  public:
    struct Settings {
        const TerrainInterface* terrain = nullptr;  // null: the ground is the plane y = 0
        bool journal = true;  // false: nothing is to be saved, so that others may have the scene open as well
        MapPictures::Find find_images = {};  // for maps of density that are neither PGM nor PPM
    };
    // A path without a file starts a scene there; a plant is opened by itself. Errors: Document::open's; write_failed where another editor has it open.
    static Result<std::unique_ptr<Session>> open(const std::string& path, const Settings& settings);
    // Leaves the journal where something is not saved.
    ~Session();

    // Edits that an earlier run left unsaved; 0: none. They are kept until recovered or discarded, and nothing is done before.
    size_t recoverable_count() const { return recoverable_.edits.size(); }
    // Does again what holds; how many edits. The journal goes on; where not all edits hold, it is kept as NAME.journal.old as
    // well. Errors: file_corrupt where the scene is not the one they were made of: then none is done, and the journal is kept
    // so.
    Result<size_t> recover();
    Status discard_recovery();

    // One step of work. An edit that changes nothing is none. Errors: make_edit's; nothing is changed then.
    Result<const Edit*> perform(const std::string& name, const nlohmann::json& arguments,
                                const std::string& source = "", const std::string& place = "");
    // The same for an edit that fits the document as it is.
    void perform(Edit edit);
    // A step in pieces, each shown as it comes and journalled at the end as one.
    void extend(Edit piece);
    void finish(const std::string& name);
    bool is_extending() const { return !open_edit_.empty(); }
    // The name of what was undone or done again; empty: there is none.
    std::string undo();
    std::string redo();
    // Errors: write_failed, also where another program wrote what would be replaced, unless it is to be overwritten.
    Status save(bool overwrite = false);
    // What is not saved is not wanted: nothing of it is left for a later run.
    void drop_journal();
    // Whether there is nothing to lose.
    bool saved() const { return open_edit_.empty() && step_name() == saved_step_name_; }
    // Another number after each edit of a text, or of a file below the root.
    uint64_t text_version() const { return text_version_; }

    const Document& document() const { return document_; }
    const History& history() const { return history_; }
    const Terrain* terrain() const { return terrain_.get(); }
    const std::shared_ptr<Terrain>& shared_terrain() const { return terrain_; }
    CommandContext context() { return {document_, terrain_.get(), &pictures_}; }
    // For who draws: PlantSet::take_changed.
    Document& changing_document() { return document_; }
    // What lately went wrong without stopping work: a journal that cannot be written, a terrain that cannot be read.
    std::vector<Error> take_warnings() { return std::exchange(warnings_, {}); }

  private:
    explicit Session(Document document) : document_(std::move(document)) {}
    void apply(const Edit& edit);
    void remember(Edit edit);
    uint64_t step_name() const {
        return history_.done_count() == 0 ? 0 : step_names_[history_.done_count() - 1];
    }
    void write_journal(const Edit& edit);
    void load_terrain();
    Status restore_base(const JournalContent& journal);

    Settings settings_;
    SceneLock lock_;
    std::string path_;
    Document document_;
    MapPictures pictures_;
    History history_;
    Edit open_edit_;
    Journal journal_;
    bool has_journal_ = false;
    std::deque<std::string> unwritten_;  // edits that the journal had no room for
    JournalContent recoverable_;
    std::shared_ptr<Terrain> terrain_;
    std::string terrain_text_;
    std::vector<Error> warnings_;
    uint64_t text_version_ = 0;
    // Of each step in the history; what is shown is named after the last that is done, 0 before all.
    std::vector<uint64_t> step_names_;
    uint64_t last_step_name_ = 0, saved_step_name_ = 0;
};

}  // namespace coppice
