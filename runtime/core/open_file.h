// A file that is read at places, from any thread. What is read is copied: a file that somebody cuts short while it is open
// is an error here, where it would be a signal in a MappedFile, and none of it stays in memory.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include "runtime/core/result.h"

namespace coppice {

class OpenFile {
  public:
    // Errors: file_missing, file_unreadable.
    static Result<OpenFile> open(const std::string& path);
    OpenFile(OpenFile&& other) noexcept;
    OpenFile& operator=(OpenFile&& other) noexcept;
    ~OpenFile();

    uint64_t size_bytes() const { return size_bytes_; }  // when it was opened
    const std::string& path() const { return path_; }
    // Fills `into`. Errors: file_truncated, file_unreadable.
    Status read(uint64_t offset_bytes, std::span<std::byte> into) const;

  private:
    OpenFile() = default;
    std::string path_;
    uint64_t size_bytes_ = 0;
    int descriptor_ = -1;
};

}  // namespace coppice
