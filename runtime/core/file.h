// Reading and writing whole files. A write either replaces the file completely or leaves it as it was.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include "runtime/core/result.h"

namespace coppice {

// limit_exceeded above size_limit_bytes.
Result<std::string> read_text_file(const std::string& path, size_t size_limit_bytes = size_t(1) << 28);

// Temporary file beside the target, fsync, rename; with the permissions any new file gets. Makes missing
// parent folders. From any thread. Errors: write_failed.
Status write_file(const std::string& path, std::span<const std::byte> bytes);
// The pieces one behind the other, as one file.
Status write_file_pieces(const std::string& path, std::span<const std::span<const std::byte>> pieces);
Status write_text_file(const std::string& path, std::string_view text);

// $XDG_CACHE_HOME/coppice, else ~/.cache/coppice, else /tmp/coppice-cache. Not created.
std::string default_cache_dir();
// Folder of the running program, without a trailing slash.
std::string program_dir();

}  // namespace coppice
