#include "plugins/vegetation/cook/cook_file.h"

#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "plugins/vegetation/cook/import/gltf_uri.h"
#include "plugins/vegetation/cook/import/import_gltf.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

enum class SourceKind { species, gltf, unknown };

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

SourceKind kind_of(const std::string& path) {
    std::string ending = ending_of(path);
    if (ending == ".json") return SourceKind::species;
    return ending == ".glb" || ending == ".gltf" ? SourceKind::gltf : SourceKind::unknown;
}

// The JSON of a glTF file: all of it, or the first chunk of a GLB. Empty where it is neither; the importer
// says why.
std::string_view json_of(std::span<const std::byte> bytes) {
    const char* text = reinterpret_cast<const char*>(bytes.data());
    if (bytes.size() < 20 || std::memcmp(text, "glTF", 4) != 0) return {text, bytes.size()};
    uint32_t chunk_bytes;
    std::memcpy(&chunk_bytes, text + 12, sizeof chunk_bytes);
    return chunk_bytes <= bytes.size() - 20 ? std::string_view(text + 20, chunk_bytes) : std::string_view();
}

// Of the files a glTF document refers to. One that cannot be read counts as empty: cooking reports it.
uint64_t hash_references(const std::string& path, std::span<const std::byte> bytes) {
    uint64_t hash = 0;
    auto document = parse_gltf(json_of(bytes), path);
    if (!document) return hash;
    std::string base_dir = std::filesystem::path(path).parent_path().string();
    auto add = [&](const std::optional<std::string>& uri) {
        if (!uri || is_data_uri(*uri)) return;
        auto file_path = resolve_uri(*uri, base_dir, path, "");
        if (!file_path) return;
        auto file = MappedFile::open(*file_path);
        hash = hash_combine(hash, file ? hash_bytes(file->bytes().data(), file->bytes().size()) : 0);
    };
    for (const GltfBuffer& buffer : document->buffers) add(buffer.uri);
    for (const GltfImage& image : document->images) add(image.uri);
    return hash;
}

}  // namespace

Result<PlantDescription> read_plant(const std::string& source_path, uint64_t variation,
                                    const ModellerInterface* modeller, const ImagesInterface* images) {
    switch (kind_of(source_path)) {
        case SourceKind::species: {
            if (!modeller)
                return fail(ErrorId::name_unknown, source_path, "", "species need the plugin \"modeller\"",
                            "install it beside the program");
            COPPICE_TRY(std::string json, read_text_file(source_path));
            return modeller->grow(json, source_path, variation);
        }
        case SourceKind::gltf: {
            ImportSettings import;
            import.images = images;
            return import_gltf(source_path, import);
        }
        default:
            return fail(ErrorId::format_unknown, source_path, "",
                        "the ending \"" + ending_of(source_path) + "\"",
                        "plants are .glb or .gltf, species .json");
    }
}

Status cook_file(const std::string& source_path, const std::string& out_path, uint64_t variation,
                 const CookSettings& settings, const ModellerInterface* modeller,
                 const ImagesInterface* images) {
    COPPICE_TRY(PlantDescription plant, read_plant(source_path, variation, modeller, images));
    auto bytes = cook_plant(plant, settings);
    if (!bytes) {
        // The description only knows its own name; the reader needs the file.
        bytes.error().file = source_path;
        return fail(std::move(bytes.error()));
    }
    return write_file(out_path, *bytes);
}

Result<std::string> cooked_path(const std::string& cache_dir, const std::string& source_path,
                                uint64_t variation, const CookSettings& settings) {
    COPPICE_TRY(MappedFile source, MappedFile::open(source_path));
    uint64_t key = hash_bytes(source.bytes().data(), source.bytes().size(), hash_settings(settings));
    if (kind_of(source_path) == SourceKind::species) {
        key = hash_combine(key, variation);
        key = hash_combine(key, k_modeller_version);
    } else {
        key = hash_combine(key, hash_references(source_path, source.bytes()));
    }
    std::string name =
        fmt::format("{}-{}.plant", std::filesystem::path(source_path).stem().string(), hash_to_hex(key));
    return (std::filesystem::path(cache_dir) / "plants" / name).string();
}

Result<std::string> find_or_cook(const std::string& cache_dir, const std::string& source_path,
                                 uint64_t variation, const CookSettings& settings,
                                 const ModellerInterface* modeller, const ImagesInterface* images) {
    COPPICE_TRY(std::string path, cooked_path(cache_dir, source_path, variation, settings));
    if (load_plant(path)) return path;
    COPPICE_CHECK(cook_file(source_path, path, variation, settings, modeller, images));
    return path;
}

}  // namespace coppice
