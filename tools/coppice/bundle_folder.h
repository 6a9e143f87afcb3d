// A folder of files put together to be carried away, with a list of them, bundle.json: so a later bundle may
// take its place, and nothing else in the folder is ever touched.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

struct BundleFile {
    const char* what;    // the kind a reader is told: "library"
    std::string path;    // in the folder, as "lib/libfmt.so.9"
    std::string source;  // the file it is a copy of; empty: it has `text`
    std::string text;
    bool executable = false;
};

class BundleFolder {
  public:
    // The folder need not exist yet, and is not made yet. Errors: usage, where it holds anything but a
    // bundle.
    static Result<BundleFolder> open(const std::string& folder);

    // Each file is written whole or not at all, the last one last; then those of the bundle before that are
    // not among them are removed. After an error the folder still opens as a bundle. Errors: file_*,
    // write_failed.
    Status replace(std::span<const BundleFile> files) const;

  private:
    BundleFolder() = default;
    Status write_list(const std::vector<std::string>& paths) const;
    std::string folder_;
    std::vector<std::string> old_paths_;  // sorted
};

// Of the copy. Errors: file_*.
Result<uint64_t> size_bytes(const BundleFile& file);

}  // namespace coppice
