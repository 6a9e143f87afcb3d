#include "plugins/vegetation/cook/import/read_named_places.h"

#include <filesystem>
#include "plugins/vegetation/cook/import/gltf_scene.h"

namespace coppice {
namespace {

constexpr size_t k_size_limit_bytes = size_t(1) << 31;

}  // namespace

Result<std::vector<NamedPlaces>> read_named_places_memory(std::span<const std::byte> bytes, const std::string& name,
                                                          const std::string& base_dir, size_t size_limit_bytes) {
    try {
        if (bytes.size() > size_limit_bytes)
            return fail(ErrorId::limit_exceeded, name, "", "the file has " + std::to_string(bytes.size()) + " bytes",
                        "at most " + std::to_string(size_limit_bytes));
        GlbChunks chunks{std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), {}};
        if (is_glb(bytes)) {
            COPPICE_TRY(chunks, split_glb(bytes, name));
        }
        COPPICE_TRY(const GltfDocument document, parse_gltf(chunks.json, name));
        COPPICE_TRY(const GltfBuffers buffers, GltfBuffers::load(document, chunks.binary, base_dir, size_limit_bytes));
        return place_nodes(document, buffers, k_named_place_limit);
    } catch (const std::bad_alloc&) {
        return fail(ErrorId::limit_exceeded, name, "", "not enough memory to read it", "a smaller file");
    } catch (const std::exception& thrown) {
        return fail(ErrorId::file_corrupt, name, "", std::string("cannot be read: ") + thrown.what(), "a valid glTF file");
    }
}

Result<std::vector<NamedPlaces>> read_named_places(const std::string& path) {
    COPPICE_TRY(const MappedFile file, MappedFile::open(path));
    return read_named_places_memory(file.bytes(), path, std::filesystem::path(path).parent_path().string(),
                                    k_size_limit_bytes);
}

}  // namespace coppice
