// Where files that are read come from: the disk, unless a host has an archive of its own.
#pragma once
#include <cstddef>
#include <string>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

// A whole file. path: as it was asked for, with the folder of the file that names it before it. From any thread, from several
// at once. What it says is file_missing is looked for on the disk, where what was made from them is kept; any other error is the answer.
using FileSource = Result<std::vector<std::byte>> (*)(void* context, const std::string& path);
// source == nullptr: the disk alone. While nothing is read.
void set_file_source(FileSource source, void* context);

// For what opens files: a descriptor, which the caller closes; what a source gave lies in memory behind it. Errors:
// file_missing (also where it is not a regular file), file_unreadable, the source's.
Result<int> open_to_read(const std::string& path);

}  // namespace coppice
