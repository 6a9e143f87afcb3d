// The files on the way from the first one to the one being read, each of which names the next: none may come to stand in
// itself, and only so many stand inside each other.
#pragma once
#include <string>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

inline constexpr uint32_t k_reference_depth_limit = 16;

// However a path is written, one file has one key.
std::string file_key(const std::string& path);

class FileChain {
  public:
    void enter(const std::string& path) { links_.push_back({path, file_key(path)}); }
    void leave() { links_.pop_back(); }
    size_t length() const { return links_.size(); }
    const std::string& last() const { return links_.back().path; }  // as it was named

    // Of a file that the last one names at `place`. Errors: value_out_of_range where it is on the way already; the fault is
    // the way round.
    Status check_is_new(const std::string& path, const std::string& place) const;
    // depth: of the longest chain below that file. Errors: limit_exceeded.
    Status check_depth(const std::string& path, const std::string& place, uint32_t depth) const;

  private:
    struct Link {
        std::string path, key;
    };
    std::vector<Link> links_;
};

}  // namespace coppice
