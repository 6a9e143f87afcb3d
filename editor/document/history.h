// What was done, and can be undone and done again.
#pragma once
#include <string>
#include <vector>
#include "editor/document/edit.h"

namespace coppice {

class History {
  public:
    // What was undone before cannot be done again.
    void push(Edit edit) {
        edits_.resize(done_);
        edits_.push_back(std::move(edit));
        ++done_;
    }
    // What to apply next time, or nullptr; the caller says then that it did.
    const Edit* next_undo() const { return done_ > 0 ? &edits_[done_ - 1] : nullptr; }  // its inverse
    const Edit* next_redo() const { return done_ < edits_.size() ? &edits_[done_] : nullptr; }
    void undone() { --done_; }
    void redone() { ++done_; }
    size_t done_count() const { return done_; }
    const std::vector<Edit>& edits() const { return edits_; }  // the first done_count() are done

  private:
    std::vector<Edit> edits_;
    size_t done_ = 0;
};

}  // namespace coppice
