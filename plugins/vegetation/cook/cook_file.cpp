#include "plugins/vegetation/cook/cook_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <utility>
#include <fmt/format.h>
#include "plugins/vegetation/cook/import/gltf_document.h"
#include "plugins/vegetation/cook/import/gltf_uri.h"
#include "plugins/vegetation/cook/import/import_gltf.h"
#include "plugins/vegetation/cook/part_settings.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "runtime/core/progress.h"

namespace coppice {
namespace {

enum class SourceKind { species, gltf, packed, unknown };

std::string ending_of(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

SourceKind kind_of(const std::string& path) {
    std::string ending = ending_of(path);
    if (ending == ".json") return SourceKind::species;
    if (ending == ".plant") return SourceKind::packed;
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

// Of the files a glTF document refers to. One that is missing counts as empty: cooking reports it, or does without. One that is there
// and cannot be read is an error: cooking might read it, and what came of it would be kept as what is made without.
Result<uint64_t> hash_references(const std::string& path, std::span<const std::byte> bytes) {
    uint64_t hash = 0;
    auto document = parse_gltf(json_of(bytes), path);
    if (!document) return hash;
    std::string base_dir = std::filesystem::path(path).parent_path().string();
    auto add = [&](const std::optional<std::string>& uri) -> Status {
        if (!uri || is_data_uri(*uri)) return {};
        auto file_path = resolve_uri(*uri, base_dir, path, "");
        if (!file_path) return {};
        auto file = MappedFile::open(*file_path);
        if (!file && file.error().id != ErrorId::file_missing) return fail(file.error());
        hash = hash_combine(hash, file ? hash_bytes(file->bytes().data(), file->bytes().size()) : 0);
        return {};
    };
    for (const GltfBuffer& buffer : document->buffers) COPPICE_CHECK(add(buffer.uri));
    for (const GltfImage& image : document->images) COPPICE_CHECK(add(image.uri));
    return hash;
}

Result<PlantDescription> read_source(const std::string& source_path, uint64_t variation,
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

Result<std::vector<PartSettings>> settings_of(const PlantSource& source) {
    if (source.settings) return *source.settings;
    return read_part_settings(source.path);
}

Result<std::vector<std::byte>> cook_source(const PlantSource& source, const CookSettings& settings,
                                           const ModellerInterface* modeller, const ImagesInterface* images) {
    COPPICE_TRY(PlantDescription plant, read_source(source.path, source.variation, modeller, images));
    COPPICE_TRY(plant.settings, settings_of(source));
    auto bytes = cook_plant(plant, settings);
    // The description only knows its own name; the reader needs the file.
    if (!bytes) bytes.error().file = source.path;
    return bytes;
}

// unwritten: why the cache could not take what was cooked, where it could not.
Result<Plant> find_or_cook_one(const std::string& cache_dir, const PlantSource& source,
                               const CookSettings& settings, const ModellerInterface* modeller,
                               const ImagesInterface* images, Status& unwritten) {
    if (kind_of(source.path) == SourceKind::packed) return load_plant(source.path);
    COPPICE_TRY(const std::string path, cooked_path(cache_dir, source, settings));
    Result<Plant> found = load_plant(path);
    if (found) return found;
    if (found.error().id != ErrorId::file_missing)
        log_note("{}; it is cooked again", to_string(found.error()));
    COPPICE_TRY(std::vector<std::byte> bytes, cook_source(source, settings, modeller, images));
    unwritten = write_file(path, bytes);
    if (unwritten) return load_plant(path);
    return load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(bytes)),
                                  source.path);
}

}  // namespace

Result<PlantDescription> read_plant(const std::string& source_path, uint64_t variation,
                                    const ModellerInterface* modeller, const ImagesInterface* images) {
    COPPICE_TRY(PlantDescription plant, read_source(source_path, variation, modeller, images));
    COPPICE_TRY(plant.settings, read_part_settings(source_path));
    return plant;
}

Status cook_file(const std::string& source_path, const std::string& out_path, uint64_t variation,
                 const CookSettings& settings, const ModellerInterface* modeller,
                 const ImagesInterface* images) {
    COPPICE_TRY(const std::vector<std::byte> bytes,
                cook_source({source_path, variation}, settings, modeller, images));
    return write_file(out_path, bytes);
}

Result<std::string> cooked_path(const std::string& cache_dir, const PlantSource& source,
                                const CookSettings& settings) {
    COPPICE_TRY(MappedFile file, MappedFile::open(source.path));
    uint64_t key = hash_bytes(file.bytes().data(), file.bytes().size(), hash_settings(settings));
    if (kind_of(source.path) == SourceKind::species) {
        key = hash_combine(key, source.variation);
        key = hash_combine(key, k_growth_version);
    } else {
        COPPICE_TRY(const uint64_t referred, hash_references(source.path, file.bytes()));
        key = hash_combine(key, referred);
    }
    COPPICE_TRY(const std::vector<PartSettings> parts, settings_of(source));
    if (!parts.empty()) key = hash_combine(key, hash_part_settings(parts));
    std::string name =
        fmt::format("{}-{}.plant", std::filesystem::path(source.path).stem().string(), hash_to_hex(key));
    return (std::filesystem::path(cache_dir) / "plants" / name).string();
}

Result<std::vector<Plant>> find_or_cook(const std::string& cache_dir, std::span<const PlantSource> sources,
                                        const CookSettings& settings, const ModellerInterface* modeller,
                                        const ImagesInterface* images) {
    std::vector<Result<Plant>> found(sources.size());
    std::vector<Status> unwritten(sources.size());
    Progress progress("cooking plants", sources.size());
    parallel_for(sources.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            found[i] = find_or_cook_one(cache_dir, sources[i], settings, modeller, images, unwritten[i]);
            progress.advance();
        }
    });
    auto failed = std::find_if(unwritten.begin(), unwritten.end(), [](const Status& s) { return !s; });
    if (failed != unwritten.end())
        log_warning("{}; plants are cooked again the next time", to_string(failed->error()));
    std::vector<Plant> plants;
    plants.reserve(sources.size());
    for (Result<Plant>& one : found) {
        COPPICE_TRY(Plant plant, std::move(one));
        plants.push_back(std::move(plant));
    }
    return plants;
}

}  // namespace coppice
