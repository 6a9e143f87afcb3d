// A scene as it is edited: its *.eco.json file and those it refers to, each with the plants placed in it.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>
#include "editor/document/edit.h"
#include "editor/document/plant_set.h"

namespace coppice {

struct EcoFile {
    SceneTextPtr text;        // none: the file was made by an edit that was undone
    PlantSet plants;          // of the placement "packed"
    std::string placed_path;  // where they are saved
    bool plants_lost =
        false;  // they are there but could not be read: nothing is placed here, and nothing written over them
    bool is_made_up = false;  // to show a plant by itself: it is not saved
    // What is on the disk as far as is known; none: no file.
    std::optional<uint64_t> saved_text_hash, saved_plants_hash;
};

class Document {
  public:
    static constexpr size_t k_kind_limit = 65536;

    // The root must be a JSON object; what else cannot be read is among the faults. Errors: file_*, syntax.
    static Result<Document> open(const std::string& path);
    // One that does not exist yet, with nothing in it.
    static Document make(const std::string& path);
    // A scene of one population, named and seen as the plant is, that is never saved: what is set of the plant's parts is. Its
    // root lies beside the plant.
    static Document for_plant(const std::string& plant_path);

    const std::string& root_path() const { return root_path_; }
    EcoFile& root() { return files_.at(root_path_); }
    const EcoFile& root() const { return files_.at(root_path_); }
    // By where they lie. Some may have no text.
    const std::map<std::string, EcoFile>& files() const { return files_; }
    EcoFile* find(const std::string& path);
    const EcoFile* find(const std::string& path) const;
    // Reads it, and all it refers to, if that was not done yet; faults are added.
    Status read(const std::string& path);
    // Files and plants that could not be read when they were met.
    const std::vector<Error>& faults() const { return faults_; }

    // Names are numbered as they are met, and keep their number.
    const std::vector<std::string>& kinds() const { return kinds_; }
    uint16_t kind_of(const std::string& name);
    // Whether so many more can be numbered.
    bool has_room_for_kinds(size_t count) const { return kinds_.size() + count <= k_kind_limit; }

    // False, and nothing is changed, where the edit is not one of this document as it is.
    bool apply(const Edit& edit);

    // As they would be saved. A file without text, or without placed plants, has none.
    std::optional<std::string> text_bytes(const EcoFile& file) const;
    std::optional<std::string> plants_bytes(const EcoFile& file) const;
    // Of all texts and plants.
    uint64_t hash() const;
    bool saved() const;
    // Replaces the files that differ from what is on the disk, each whole, after copying what is there to NAME.bak; plants
    // before the files that name them. Errors: write_failed; what was written before stays, and a later save goes on. Where
    // another program changed one of them nothing is written, unless they are to be overwritten.
    Status save(bool overwrite = false);
    // Files that would be saved, and are not what was read or saved last.
    std::vector<std::string> changed_elsewhere() const;

    // "grove.eco.json" as the file's own folder has it.
    static std::string resolve(const std::string& of_file, const std::string& name);
    // Scenes that the text refers to, resolved, once each.
    static std::vector<std::string> references_of(const std::string& path, const SceneText& text);

  private:
    struct Write {
        std::string path, bytes;
        std::optional<uint64_t> saved_hash;  // of what is there, as far as is known
    };
    // What is not saved, in the order in which it is written.
    std::vector<Write> list_writes() const;
    Status read_one(const std::string& path);

    std::string root_path_;
    std::map<std::string, EcoFile> files_;
    std::vector<std::string> kinds_;
    std::map<std::string, uint16_t> kind_numbers_;
    std::vector<Error> faults_;
};

// A text with a placement for the file's placed plants: the same where it has one.
SceneTextPtr with_placed(const SceneTextPtr& text, const std::string& path);
// Of a text: what its placement "packed" says, or none.
std::optional<std::string> placed_name(const SceneText& text);

}  // namespace coppice
