#include "plugins/vegetation/cook/import/gltf_buffers.h"

#include <cstring>
#include <meshoptimizer.h>
#include "plugins/vegetation/cook/import/gltf_uri.h"

namespace coppice {
namespace {

constexpr uint32_t k_glb_magic = 0x46546c67, k_json_chunk = 0x4e4f534a, k_binary_chunk = 0x004e4942;

uint32_t read_u32(std::span<const std::byte> bytes, size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

}  // namespace

bool is_glb(std::span<const std::byte> bytes) {
    return bytes.size() >= 4 && read_u32(bytes, 0) == k_glb_magic;
}

Result<GlbChunks> split_glb(std::span<const std::byte> bytes, const std::string& file) {
    auto truncated = [&](size_t at, const std::string& fault) {
        return fail(ErrorId::file_truncated, file, "byte " + std::to_string(at), fault, "the whole GLB file");
    };
    if (bytes.size() < 20) return truncated(bytes.size(), "the GLB header ends early");
    if (read_u32(bytes, 4) != 2)
        return fail(ErrorId::format_unknown, file, "byte 4",
                    "GLB version " + std::to_string(read_u32(bytes, 4)), "version 2");
    uint32_t announced = read_u32(bytes, 8);
    if (announced > bytes.size())
        return truncated(bytes.size(), "the header announces " + std::to_string(announced) +
                                           " bytes, the file has " + std::to_string(bytes.size()));
    bytes = bytes.first(announced);  // what follows is not ours
    GlbChunks chunks;
    size_t at = 12;
    for (uint32_t number = 0; at < bytes.size(); ++number) {
        if (bytes.size() - at < 8) return truncated(at, "a chunk's header ends early");
        uint32_t size = read_u32(bytes, at), type = read_u32(bytes, at + 4);
        if (size > bytes.size() - at - 8)
            return truncated(at, "a chunk announces " + std::to_string(size) + " bytes, but " +
                                     std::to_string(bytes.size() - at - 8) + " are left");
        auto corrupt = [&](const char* fault) {
            return fail(ErrorId::file_corrupt, file, "byte " + std::to_string(at), fault,
                        "one JSON chunk first, at most one binary chunk second, lengths in multiples of 4");
        };
        auto content = bytes.subspan(at + 8, size);
        if (size % 4 != 0) return corrupt("a chunk's length is no multiple of 4");
        if ((type == k_json_chunk) != (number == 0))
            return corrupt("the JSON chunk is not the first, or not the only one");
        if (type == k_binary_chunk && number != 1) return corrupt("a binary chunk that is not the second");
        if (type == k_json_chunk)
            chunks.json = std::string_view(reinterpret_cast<const char*>(content.data()), content.size());
        if (type == k_binary_chunk) chunks.binary = content;
        at += 8 + size_t(size);
    }
    return chunks;
}

Result<std::span<const std::byte>> GltfBuffers::load_buffer(const GltfDocument& document, size_t index,
                                                            std::span<const std::byte> glb_binary,
                                                            const std::string& base_dir) {
    const GltfBuffer& buffer = document.buffers[index];
    std::string place = "buffers[" + std::to_string(index) + "]";
    std::span<const std::byte> bytes;
    if (!buffer.uri) {
        if (index != 0 || glb_binary.empty()) return bytes;  // a fallback: whoever reads it is told
        bytes = glb_binary;
    } else if (is_data_uri(*buffer.uri)) {
        COPPICE_TRY(auto data, decode_data_uri(*buffer.uri, document.file, place + ".uri"));
        bytes = owned_.emplace_back(std::move(data));
    } else {
        COPPICE_TRY(std::string path, resolve_uri(*buffer.uri, base_dir, document.file, place + ".uri"));
        COPPICE_TRY(MappedFile file, MappedFile::open(path));
        bytes = files_.emplace_back(std::move(file)).bytes();
    }
    if (bytes.size() < buffer.size_bytes)
        return fail(ErrorId::file_truncated, document.file, place,
                    "byteLength is " + std::to_string(buffer.size_bytes) + ", but there are " +
                        std::to_string(bytes.size()) + " bytes",
                    "the whole buffer");
    return bytes.first(buffer.size_bytes);
}

Result<std::span<const std::byte>> GltfBuffers::decompress(const GltfMeshopt& packed,
                                                           std::span<const std::byte> bytes,
                                                           const std::string& file,
                                                           const std::string& place) {
    auto source = reinterpret_cast<const unsigned char*>(bytes.data());
    size_t count = packed.count, stride = packed.stride_bytes;
    std::vector<std::byte>& out = owned_.emplace_back(count * stride);
    int failed = 0;
    switch (packed.mode) {
        case GltfMeshopt::Mode::attributes:
            failed = meshopt_decodeVertexBuffer(out.data(), count, stride, source, bytes.size());
            break;
        case GltfMeshopt::Mode::triangles:
            failed = meshopt_decodeIndexBuffer(out.data(), count, stride, source, bytes.size());
            break;
        case GltfMeshopt::Mode::indices:
            failed = meshopt_decodeIndexSequence(out.data(), count, stride, source, bytes.size());
            break;
    }
    if (failed)
        return fail(ErrorId::file_corrupt, file, place, "the compressed data does not decode",
                    "data written by a meshoptimizer encoder");
    switch (packed.filter) {
        case GltfMeshopt::Filter::none:
            break;
        case GltfMeshopt::Filter::octahedral:
            meshopt_decodeFilterOct(out.data(), count, stride);
            break;
        case GltfMeshopt::Filter::quaternion:
            meshopt_decodeFilterQuat(out.data(), count, stride);
            break;
        case GltfMeshopt::Filter::exponential:
            meshopt_decodeFilterExp(out.data(), count, stride);
            break;
    }
    return std::span<const std::byte>(out);
}

Result<GltfBuffers> GltfBuffers::load(const GltfDocument& document, std::span<const std::byte> glb_binary,
                                      const std::string& base_dir, uint64_t size_limit_bytes) {
    GltfBuffers loaded;
    loaded.owned_.reserve(document.buffers.size() + document.views.size());  // spans into them stay valid
    loaded.files_.reserve(document.buffers.size());
    std::vector<std::span<const std::byte>> buffers;
    uint64_t total_bytes = 0;
    auto too_large = [&](const std::string& place) {
        return fail(ErrorId::limit_exceeded, document.file, place, "more data than is taken from one file",
                    "at most " + std::to_string(size_limit_bytes) + " bytes altogether");
    };
    for (size_t i = 0; i < document.buffers.size(); ++i) {
        if (document.buffers[i].size_bytes > size_limit_bytes - total_bytes)
            return too_large("buffers[" + std::to_string(i) + "]");
        total_bytes += document.buffers[i].size_bytes;
        COPPICE_TRY(auto bytes, loaded.load_buffer(document, i, glb_binary, base_dir));
        buffers.push_back(bytes);
    }
    uint64_t decoded_bytes = 0;
    for (size_t i = 0; i < document.views.size(); ++i) {
        const GltfBufferView& view = document.views[i];
        std::string place = "bufferViews[" + std::to_string(i) + "]";
        uint32_t buffer = view.meshopt ? view.meshopt->buffer : view.buffer;
        uint64_t offset = view.meshopt ? view.meshopt->offset_bytes : view.offset_bytes;
        uint64_t size = view.meshopt ? view.meshopt->size_bytes : view.size_bytes;
        uint64_t buffer_size = document.buffers[buffer].size_bytes;
        if (offset > buffer_size || size > buffer_size - offset)
            return fail(ErrorId::value_out_of_range, document.file, place,
                        "bytes " + std::to_string(offset) + " to " + std::to_string(offset + size) +
                            " of a buffer of " + std::to_string(buffer_size),
                        "a range inside the buffer");
        if (buffers[buffer].empty()) {  // no data anywhere: whoever reads it is told
            loaded.views_.emplace_back();
            continue;
        }
        auto bytes = buffers[buffer].subspan(offset, size);
        if (view.meshopt) {
            // No codec packs tighter than 64 to 1, so larger counts are lies; checked before anything is
            // allocated.
            if (view.size_bytes > 64 * size + 1024 || view.size_bytes > size_limit_bytes - decoded_bytes)
                return too_large(place);
            decoded_bytes += view.size_bytes;
            COPPICE_TRY(bytes, loaded.decompress(*view.meshopt, bytes, document.file, place));
        }
        loaded.views_.push_back(bytes);
    }
    return loaded;
}

}  // namespace coppice
