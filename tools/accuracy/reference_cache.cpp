#include "tools/accuracy/reference_cache.h"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/log.h"
#include "runtime/core/mapped_file.h"

namespace coppice {
namespace {

// Raise it when the tracer's pictures of an unchanged scene change.
constexpr uint64_t k_tracer_version = 1;

// Feeds values one by one, so that the padding of structs does not count.
class SceneHash {
  public:
    explicit SceneHash(uint64_t seed) : hash_(seed) {}
    template <class... T>
    void add(const T&... values) {
        (add_one(values), ...);
    }
    template <class T>
    void add_array(std::span<const T> values) {
        hash_ = hash_combine(hash_, hash_bytes(values.data(), values.size_bytes()));
    }
    uint64_t value() const { return hash_; }

  private:
    template <class T>
    void add_one(const T& value) {
        hash_ = hash_combine(hash_, hash_bytes(&value, sizeof value));
    }
    uint64_t hash_;
};

void add_terrain(SceneHash& hash, const Terrain* terrain) {
    if (!terrain) return;
    hash.add(terrain->origin_world());
    hash.add_array(terrain->vertices());
    for (const TerrainPatch& patch : terrain->patches()) hash.add(patch.first_level, patch.level_count);
    for (const TerrainLevel& level : terrain->levels()) hash.add(level.first_vertex, level.vertex_count);
}

struct NamedPicture {
    const char* name;
    FloatPicture ReferencePicture::*picture;
};
constexpr std::array<NamedPicture, 3> k_pictures{{{"shadowed", &ReferencePicture::shadowed},
                                                  {"unshadowed", &ReferencePicture::unshadowed},
                                                  {"coverage", &ReferencePicture::coverage}}};

std::string picture_path(const std::string& stem, const char* name) {
    return fmt::format("{}-{}.exr", stem, name);
}

Result<uint64_t> hash_file(const std::string& path) {
    COPPICE_TRY(const MappedFile file, MappedFile::open(path));
    return hash_bytes(file.bytes().data(), file.bytes().size());
}

// The list of checksums beside the pictures is written last: a run that was cut off leaves none.
Result<ReferencePicture> read_pictures(const std::string& stem, const ReferenceSettings& settings,
                                       const ImagesInterface& images) {
    const std::string list_path = stem + ".json";
    COPPICE_TRY(const std::string text, read_text_file(list_path));
    const nlohmann::json list = nlohmann::json::parse(text, nullptr, false);
    auto broken = [](const std::string& path, const char* what) {
        return fail(ErrorId::file_corrupt, path, "", what, "it is made again");
    };
    if (!list.is_object() || !list.value("samples_per_pixel", nlohmann::json()).is_number_unsigned())
        return broken(list_path, "not a list of checksums");
    ReferencePicture reference;
    reference.samples_per_pixel = list["samples_per_pixel"].get<uint32_t>();
    for (const NamedPicture& named : k_pictures) {
        const std::string path = picture_path(stem, named.name);
        COPPICE_TRY(const uint64_t hash, hash_file(path));
        if (list.value(named.name, nlohmann::json()) != fmt::format("{:016x}", hash))
            return broken(path, "its bytes are not those that were written");
        COPPICE_TRY(reference.*named.picture, images.read_float(path));
        const FloatPicture& picture = reference.*named.picture;
        if (picture.width != settings.width || picture.height != settings.height)
            return broken(path, "the picture has another size");
    }
    return reference;
}

Status write_pictures(const std::string& stem, const ReferencePicture& reference,
                      const ImagesInterface& images) {
    nlohmann::json list{{"samples_per_pixel", reference.samples_per_pixel}};
    for (const NamedPicture& named : k_pictures) {
        const std::string path = picture_path(stem, named.name);
        COPPICE_CHECK(images.write_float(path, reference.*named.picture));
        COPPICE_TRY(const uint64_t hash, hash_file(path));
        list[named.name] = fmt::format("{:016x}", hash);
    }
    return write_text_file(stem + ".json", list.dump(2) + "\n");
}

}  // namespace

uint64_t hash_scene(const Scene& scene, std::span<const Plant> plants, const Terrain* bare_terrain) {
    SceneHash hash(k_tracer_version);
    for (const Plant& plant : plants) hash.add(plant.content_hash);
    for (const SceneTile& tile : scene.tiles)
        hash.add(tile.tile.origin_world, tile.first_plant, tile.plant_count);
    hash.add_array(std::span(scene.positions));
    hash.add_array(std::span(scene.turns));
    hash.add_array(std::span(scene.plant_models));
    const Light& light = scene.light;
    hash.add(light.direction_to_sun, light.sun_color, light.sky_zenith_color, light.sky_horizon_color,
             light.ground_color, light.haze_color, light.haze_density_per_m);
    add_terrain(hash, scene.terrain.get());
    add_terrain(hash, bare_terrain);
    return hash.value();
}

ReferenceCache::ReferenceCache(const ReferenceSource& source)
    : source_(source), scene_hash_(hash_scene(*source.scene, source.plants, source.bare_terrain)) {}

Result<ReferencePicture> ReferenceCache::find_or_trace(const Camera& camera,
                                                       const ReferenceSettings& settings) {
    SceneHash key(scene_hash_);
    key.add(camera.position_world, camera.yaw_rad, camera.pitch_rad, camera.vertical_fov_rad, camera.near_m,
            settings.width, settings.height, settings.samples_per_pixel);
    const std::string stem = fmt::format("{}/references/{:016x}", source_.cache_dir, key.value());
    auto found = read_pictures(stem, settings, *source_.images);
    if (found) return found;
    if (found.error().id != ErrorId::file_missing) log_note("{}", to_string(found.error()));

    if (!rays_) {
        COPPICE_TRY(rays_, source_.tracer->create(*source_.scene, source_.plants, source_.bare_terrain));
    }
    COPPICE_TRY(ReferencePicture traced, rays_->trace(camera, settings));
    ++traced_count_;
    if (auto written = write_pictures(stem, traced, *source_.images); !written)
        log_warning("{}", to_string(written.error()));
    return traced;
}

}  // namespace coppice
