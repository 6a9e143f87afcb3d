// Edits that were not saved yet, written beside the scene one by one as they are made: what a program that was killed leaves
// behind. Cut anywhere, all whole records before the cut hold.
#pragma once
#include <string>
#include <vector>
#include "editor/document/document.h"

namespace coppice {

// What a file was when the journal began: which of NAME and NAME.bak has these bytes, the edits are of.
struct JournalBase {
    std::string path;  // of a scene's text, or of placed plants
    uint64_t hash;
    auto operator<=>(const JournalBase&) const = default;
};

inline constexpr uint64_t k_no_file = 0;  // there was none

struct JournalContent {
    std::vector<JournalBase> base;
    std::vector<std::string> edits;  // write_edit
    size_t whole_bytes = 0, dropped_bytes = 0;  // up to the last whole record, and behind it
};

class Journal {
  public:
    // Errors: file_missing; format_unknown where not even the base is whole.
    static Result<JournalContent> read(const std::string& path);

    Journal() = default;
    Journal(Journal&& other) noexcept;
    Journal& operator=(Journal&& other) noexcept;
    ~Journal();  // closes the file and leaves it
    // A new one with these edits in place of what is there, which stays until the new one is whole. Errors: write_failed.
    static Result<Journal> create(const std::string& path, const std::vector<JournalBase>& base,
                                  const std::vector<std::string>& edits = {});
    // The one that is there goes on behind its last whole record. Errors: write_failed.
    static Result<Journal> resume(const std::string& path, const JournalContent& content);
    // It is on the disk when this returns, so that it outlives the machine as well. Errors: write_failed; the record is cut off
    // again as far as that can be done, and later ones may go in.
    Status append(std::string_view edit);

  private:
    std::string path_;
    int file_ = -1;
    int64_t size_bytes_ = 0;
};

std::string journal_path(const std::string& scene_path);
// Puts a journal whose edits are not all done again aside, where nothing is yet: NAME.journal.old, NAME.journal.old.2 ...;
// also leaves it where it is, if `stays`. The name. Errors: write_failed.
Result<std::string> keep_old_journal(const std::string& path, bool stays);
std::vector<JournalBase> journal_base(const Document& document);

}  // namespace coppice
