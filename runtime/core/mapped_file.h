// A whole file as read-only memory, without copying it.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include "runtime/core/result.h"

namespace coppice {

class MappedFile {
  public:
    // Errors: file_missing, file_unreadable. An empty file is an empty span.
    static Result<MappedFile> open(const std::string& path);
    MappedFile() = default;
    MappedFile(MappedFile&& other) noexcept;
    MappedFile& operator=(MappedFile&& other) noexcept;
    ~MappedFile();

    std::span<const std::byte> bytes() const { return bytes_; }

  private:
    std::span<const std::byte> bytes_;
};

}  // namespace coppice
