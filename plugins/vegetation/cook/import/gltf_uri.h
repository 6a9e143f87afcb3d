// URIs of buffers and images: data inside the document, or files in the document's own folder and below it.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

bool is_data_uri(std::string_view uri);
// The bytes of "data:...;base64,...". file and place are for messages. Errors: syntax, limit_exceeded.
Result<std::vector<std::byte>> decode_data_uri(std::string_view uri, const std::string& file,
                                               const std::string& place);
// "my%20leaf.png" in base_dir. Refuses absolute paths, schemes and ".." that leaves the folder
// (value_out_of_range). Symbolic links are followed: they are the user's, not the file's.
Result<std::string> resolve_uri(std::string_view uri, const std::string& base_dir, const std::string& file,
                                const std::string& place);

}  // namespace coppice
