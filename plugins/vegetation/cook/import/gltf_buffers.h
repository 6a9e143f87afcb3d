// The bytes behind buffer views: from the GLB's chunk, data URIs, or files beside the document; decompressed
// where EXT_meshopt_compression says so. After load, view(i) is in memory and in bounds.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "runtime/core/mapped_file.h"

namespace coppice {

// A GLB taken apart: its JSON and its binary chunk (empty if it has none).
struct GlbChunks {
    std::string_view json;
    std::span<const std::byte> binary;
};
bool is_glb(std::span<const std::byte> bytes);
// Errors: format_unknown (version), file_truncated, file_corrupt.
Result<GlbChunks> split_glb(std::span<const std::byte> bytes, const std::string& file);

class GltfBuffers {
  public:
    // glb_binary must outlive the object. All buffers together hold at most size_limit_bytes, and so do all
    // decompressed views.
    static Result<GltfBuffers> load(const GltfDocument& document, std::span<const std::byte> glb_binary,
                                    const std::string& base_dir, uint64_t size_limit_bytes);
    std::span<const std::byte> view(uint32_t index) const { return views_[index]; }

  private:
    Result<std::span<const std::byte>> load_buffer(const GltfDocument& document, size_t index,
                                                   std::span<const std::byte> glb_binary,
                                                   const std::string& base_dir);
    Result<std::span<const std::byte>> decompress(const GltfMeshopt& packed, std::span<const std::byte> bytes,
                                                  const std::string& file, const std::string& place);

    std::vector<MappedFile> files_;
    std::vector<std::vector<std::byte>> owned_;
    std::vector<std::span<const std::byte>> views_;
};

}  // namespace coppice
