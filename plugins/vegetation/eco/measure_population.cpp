#include "plugins/vegetation/eco/measure_population.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "runtime/core/mapped_file.h"
#include "runtime/core/progress.h"

namespace coppice {
namespace {

std::string path_in_cache(const std::string& cache_dir, const PopulationSource& source,
                          std::string_view species) {
    uint64_t key = hash_text(species);
    for (uint32_t part : {k_growth_version, k_features_version, source.individual_count})
        key = hash_combine(key, part);
    const std::string stem = std::filesystem::path(source.path).stem().string();
    return (std::filesystem::path(cache_dir) / "populations" /
            fmt::format("{}-{}.features", stem, hash_to_hex(key)))
        .string();
}

bool is_sound(const PlantFeatures& one) {
    std::array<float, sizeof one / sizeof(float)> numbers;
    std::memcpy(numbers.data(), &one, sizeof one);
    return one.height_m > 0.0f &&
           std::all_of(numbers.begin(), numbers.end(), [](float x) { return std::isfinite(x); });
}

// The file: the hash of what follows, then each individual's features.
Result<std::vector<PlantFeatures>> read_features(const std::string& path, uint32_t count) {
    COPPICE_TRY(const MappedFile file, MappedFile::open(path));
    const std::span<const std::byte> bytes = file.bytes();
    std::vector<PlantFeatures> features(count);
    const size_t size_bytes = count * sizeof(PlantFeatures);
    uint64_t checksum;
    if (bytes.size() != sizeof checksum + size_bytes)
        return fail(ErrorId::file_truncated, path, "", fmt::format("{} bytes", bytes.size()),
                    fmt::format("{}, for {} individuals", sizeof checksum + size_bytes, count));
    std::memcpy(&checksum, bytes.data(), sizeof checksum);
    std::memcpy(features.data(), bytes.data() + sizeof checksum, size_bytes);
    if (checksum != hash_bytes(features.data(), size_bytes) ||
        !std::all_of(features.begin(), features.end(), is_sound))
        return fail(ErrorId::file_corrupt, path, "", "the checksum is wrong", "delete the file");
    return features;
}

Status write_features(const std::string& path, const std::vector<PlantFeatures>& features) {
    const size_t size_bytes = features.size() * sizeof(PlantFeatures);
    const uint64_t checksum = hash_bytes(features.data(), size_bytes);
    std::vector<std::byte> bytes(sizeof checksum + size_bytes);
    std::memcpy(bytes.data(), &checksum, sizeof checksum);
    std::memcpy(bytes.data() + sizeof checksum, features.data(), size_bytes);
    return write_file(path, bytes);
}

Result<std::vector<PlantFeatures>> grow_and_measure(const PopulationSource& source, std::string_view species,
                                                    const ModellerInterface& modeller) {
    std::vector<Result<PlantFeatures>> grown(source.individual_count);
    Progress progress("growing a population", grown.size());
    parallel_for(grown.size(), 1, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            grown[i] = modeller.grow(species, source.path, i).map(measure_features);
            progress.advance();
        }
    });
    std::vector<PlantFeatures> features;
    features.reserve(grown.size());
    for (Result<PlantFeatures>& one : grown) {
        COPPICE_TRY(features.emplace_back(), std::move(one));
    }
    return features;
}

}  // namespace

Result<std::vector<PlantFeatures>> measure_population(const PopulationSource& source,
                                                      const ModellerInterface* modeller,
                                                      const std::string& cache_dir) {
    assert(source.individual_count >= 1 && source.individual_count <= k_individual_limit);
    if (!modeller)
        return fail(ErrorId::name_unknown, source.path, "", "species need the plugin \"modeller\"",
                    "install it beside the program");
    COPPICE_TRY(const std::string species, read_text_file(source.path));
    if (cache_dir.empty()) return grow_and_measure(source, species, *modeller);
    const std::string cached = path_in_cache(cache_dir, source, species);
    auto found = read_features(cached, source.individual_count);
    if (found) return found;
    if (found.error().id != ErrorId::file_missing)
        log_note("{}; the population is grown again", to_string(found.error()));
    auto grown = grow_and_measure(source, species, *modeller);
    if (grown)
        if (Status written = write_features(cached, *grown); !written)
            log_warning("{}; the population is grown again the next time", to_string(written.error()));
    return grown;
}

}  // namespace coppice
