// coppice.h over EmbeddedForest: structs of any size in, results and a message out, no exception.
#include "plugins/vegetation/coppice.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include "plugins/vegetation/embedded_forest.h"

struct CoppiceForest {
    std::unique_ptr<coppice::EmbeddedForest> forest;
};

namespace coppice {
namespace {

thread_local std::string g_message;

// As much as the caller has of it; the rest is 0, or as `taken` came.
template <class T>
T take(const T* given, T taken = {}) {
    if (given) std::memcpy(&taken, given, std::min<size_t>(given->size_bytes, sizeof(T)));
    return taken;
}

// As much as the caller has room for.
template <class T>
void give(T result, T* to) {
    result.size_bytes = to->size_bytes;
    std::memcpy(to, &result, std::min<size_t>(result.size_bytes, sizeof(T)));
}

template <class T>
T or_default(T value, T otherwise) {
    return value == T{} ? otherwise : value;
}

int failed(const Error& error) {
    g_message = to_string(error);
    switch (error.id) {
        case ErrorId::device_missing:
            return COPPICE_DEVICE_MISSING;
        case ErrorId::device_lost:
            return COPPICE_DEVICE_LOST;
        case ErrorId::limit_exceeded:
            return COPPICE_LIMIT_EXCEEDED;
        default:
            return exit_code_of(error.id) == 2 ? COPPICE_BAD_INPUT : COPPICE_FAILED;
    }
}

template <class T>
int result_of(const Result<T>& result) {
    return result ? int(COPPICE_DONE) : failed(result.error());
}

// work() -> int
template <class Work>
int guarded(Work&& work) noexcept {
    try {
        g_message.clear();
        return work();
    } catch (const std::bad_alloc&) {
        return COPPICE_LIMIT_EXCEEDED;
    } catch (const std::exception& thrown) {
        try {
            g_message = thrown.what();
        } catch (...) {
        }
        return COPPICE_FAILED;
    }
}

vec3 vector_of(const float* v) { return {v[0], v[1], v[2]}; }
dvec3 place_of(const double* v) { return {v[0], v[1], v[2]}; }
template <class To, class From>
void put(To* to, const From& from) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

Camera camera_of(const CoppiceCamera* given) {
    if (!given) return {};
    const CoppiceCamera camera = take(given);
    const Camera usual;
    return camera_along(place_of(camera.position), vector_of(camera.forward), vector_of(camera.up),
                        or_default(camera.vertical_fov_rad, usual.vertical_fov_rad),
                        or_default(camera.near_m, usual.near_m));
}

HostPicture picture_of(const CoppicePicture* given) {
    const CoppicePicture picture = take(given);
    const HostPicture usual;
    return {picture.color,
            or_default(picture.color_format, usual.color_format),
            or_default(picture.color_layout, usual.color_layout),
            picture.depth,
            or_default(picture.depth_format, usual.depth_format),
            or_default(picture.depth_layout, usual.depth_layout),
            picture.depth_offset,
            or_default(picture.depth_scale, usual.depth_scale)};
}

FrameSettings settings_of(const CoppiceQuality* given) {
    const CoppiceQuality quality = take(given);
    FrameSettings settings;
    settings.sample_distance_px = or_default(quality.sample_distance_px, settings.sample_distance_px);
    settings.vertex_budget = quality.vertex_budget;
    settings.time_budget_ms = quality.time_budget_ms;
    if (quality.without_shadows) settings.shadows = ShadowKind::none;
    return settings;
}

Placement placement_of(const CoppicePlant* given) {
    const CoppicePlant plant = take(given);
    return {place_of(plant.position),
            or_default(plant.scale, 1.0f),
            pack_turn_about_y(plant.turn_rad),
            {plant.model, plant.seed}};
}

CoppiceHit hit_of(const StemHit& found) {
    CoppiceHit hit{};
    hit.plant = found.plant;
    hit.distance_m = found.distance_m;
    put(hit.normal, found.normal_world);
    return hit;
}

const char* message() { return g_message.c_str(); }

int create(const CoppiceForestSettings* given, CoppiceForest** forest) {
    *forest = nullptr;
    return guarded([&] {
        const CoppiceForestSettings taken = take(given);
        EmbeddedForestSettings settings;
        settings.device = {taken.instance, taken.physical_device, taken.device, VK_NULL_HANDLE,
                           taken.queue_family};
        settings.scene = taken.scene ? taken.scene : "";
        settings.cache_dir = taken.cache_dir ? taken.cache_dir : "";
        settings.width = or_default(taken.width, settings.width);
        settings.height = or_default(taken.height, settings.height);
        settings.frame_slots = or_default(taken.frame_slots, settings.frame_slots);
        settings.loose_tiles = or_default(taken.loose_tiles, settings.loose_tiles);
        settings.tile_memory_bytes = or_default(taken.tile_memory_bytes, settings.tile_memory_bytes);
        auto made = EmbeddedForest::create(settings);
        if (made) *forest = new CoppiceForest{std::move(*made)};
        return result_of(made);
    });
}

void destroy(CoppiceForest* forest) { delete forest; }

int record(CoppiceForest* forest, const CoppiceFrame* given) {
    return guarded([&] {
        const CoppiceFrame frame = take(given);
        return result_of(forest->forest->record({frame.commands, frame.slot, camera_of(frame.camera),
                                                 settings_of(frame.quality), picture_of(frame.picture)}));
    });
}

int resize(CoppiceForest* forest, uint32_t width, uint32_t height) {
    return guarded([&] { return result_of(forest->forest->resize(width, height)); });
}

int set_light(CoppiceForest* forest, const CoppiceLight* given) {
    return guarded([&] {
        Light light = forest->forest->scene().light;
        CoppiceLight taken{};
        put(taken.direction_to_sun, light.direction_to_sun);
        put(taken.sun_color, light.sun_color);
        put(taken.sky_zenith_color, light.sky_zenith_color);
        put(taken.sky_horizon_color, light.sky_horizon_color);
        put(taken.ground_color, light.ground_color);
        put(taken.haze_color, light.haze_color);
        taken.haze_density_per_m = light.haze_density_per_m;
        taken = take(given, taken);
        light.direction_to_sun = vector_of(taken.direction_to_sun);
        light.sun_color = vector_of(taken.sun_color);
        light.sky_zenith_color = vector_of(taken.sky_zenith_color);
        light.sky_horizon_color = vector_of(taken.sky_horizon_color);
        light.ground_color = vector_of(taken.ground_color);
        light.haze_color = vector_of(taken.haze_color);
        light.haze_density_per_m = taken.haze_density_per_m;
        forest->forest->vegetation().set_light(light);
        return int(COPPICE_DONE);
    });
}

void set_frame_ms(CoppiceForest* forest, uint32_t slot, double ms) {
    guarded([&] {
        forest->forest->vegetation().set_frame_ms(slot, ms);
        return int(COPPICE_DONE);
    });
}

void report(const CoppiceForest* forest, CoppiceReport* to) {
    const FrameReport& of = forest->forest->report();
    give(CoppiceReport{0, of.plants_visible, of.plants, of.triangles, of.lines, of.points, of.leaves,
                       of.vertices, of.gpu_bytes, of.sample_distance_px,
                       float(of.cull_ms + of.lod_ms + of.write_ms)},
         to);
}

void scene_camera(const CoppiceForest* forest, double time_s, CoppiceCamera* to) {
    const Camera camera = camera_at(forest->forest->scene().camera_path, time_s);
    CoppiceCamera result{};
    result.vertical_fov_rad = camera.vertical_fov_rad;
    result.near_m = camera.near_m;
    put(result.forward, camera.forward());
    put(result.up, camera.up());
    put(result.position, camera.position_world);
    give(result, to);
}

int reload_if_changed(CoppiceForest* forest, uint32_t* changed) {
    *changed = 0;
    return guarded([&] {
        const Result<bool> reloaded = forest->forest->reload_if_changed();
        if (reloaded) *changed = *reloaded;
        return result_of(reloaded);
    });
}

uint32_t model_count(const CoppiceForest* forest) { return uint32_t(forest->forest->scene().models.size()); }

const char* model_name(const CoppiceForest* forest, uint32_t model) {
    const auto& models = forest->forest->scene().models;
    return model < models.size() ? models[model].name.c_str() : nullptr;
}

int add_plant(CoppiceForest* forest, const CoppicePlant* plant, uint32_t* number) {
    return guarded([&] {
        const Result<uint32_t> added = forest->forest->plants().add(placement_of(plant));
        if (added) *number = *added;
        return result_of(added);
    });
}

int move_plant(CoppiceForest* forest, uint32_t number, const CoppicePlant* plant) {
    return guarded([&] { return result_of(forest->forest->plants().move(number, placement_of(plant))); });
}

int remove_plant(CoppiceForest* forest, uint32_t number) {
    return guarded([&] { return result_of(forest->forest->plants().remove(number)); });
}

void first_hit(const CoppiceForest* forest, const double from[3], const float direction[3],
               float most_distance_m, CoppiceHit* hit) {
    give(hit_of(forest->forest->stems().first_hit(place_of(from), vector_of(direction), most_distance_m)),
         hit);
}

void nearest_stem(const CoppiceForest* forest, const double at[3], float within_m, CoppiceHit* hit) {
    give(hit_of(forest->forest->stems().nearest(place_of(at), within_m)), hit);
}

size_t stems_in_box(const CoppiceForest* forest, const double least[3], const double most[3],
                    CoppiceStem* stems, size_t room, size_t stride_bytes) {
    size_t count = 0;
    guarded([&] {
        std::vector<Stem> found;
        forest->forest->stems().in_box(place_of(least), place_of(most), found);
        count = found.size();
        for (size_t i = 0; i < std::min(room, count); ++i) {
            CoppiceStem stem{uint32_t(std::min(stride_bytes, sizeof(CoppiceStem))),
                             found[i].plant,
                             {},
                             {},
                             found[i].radius_m};
            put(stem.foot, found[i].foot_world);
            put(stem.head, found[i].head_world);
            std::memcpy(reinterpret_cast<std::byte*>(stems) + i * stride_bytes, &stem, stem.size_bytes);
        }
        return int(COPPICE_DONE);
    });
    return count;
}

constexpr CoppiceForestInterface k_interface{sizeof(CoppiceForestInterface),
                                             COPPICE_FOREST_VERSION,
                                             message,
                                             create,
                                             destroy,
                                             record,
                                             resize,
                                             set_light,
                                             set_frame_ms,
                                             report,
                                             scene_camera,
                                             reload_if_changed,
                                             model_count,
                                             model_name,
                                             add_plant,
                                             move_plant,
                                             remove_plant,
                                             first_hit,
                                             nearest_stem,
                                             stems_in_box};

}  // namespace
}  // namespace coppice

extern "C" const void* coppice_interface(const char* name, uint32_t version) {
    const bool known = name && std::strcmp(name, COPPICE_FOREST_INTERFACE) == 0;
    return known && version == COPPICE_FOREST_VERSION ? &coppice::k_interface : nullptr;
}
