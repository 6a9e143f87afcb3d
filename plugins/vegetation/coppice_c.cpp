// coppice.h over EmbeddedForest: structs of any size in, results and a message out, no exception.
#include "plugins/vegetation/coppice.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include "plugins/vegetation/embedded_forest.h"

struct CoppiceForest {
    std::unique_ptr<coppice::EmbeddedForest> forest;
};

namespace coppice {
namespace {

thread_local std::string g_message;

// New members go to the end, and must not come to lie in what older programs left undefined.
static_assert(offsetof(CoppicePicture, reserved) + sizeof(uint32_t) == sizeof(CoppicePicture));
static_assert(offsetof(CoppicePlant, reserved) + sizeof(uint32_t) == sizeof(CoppicePlant));
static_assert(offsetof(CoppiceStem, reserved) + sizeof(uint32_t) == sizeof(CoppiceStem));
static_assert(offsetof(CoppiceCamera, position) + 3 * sizeof(double) == sizeof(CoppiceCamera));
static_assert(offsetof(CoppiceQuality, without_shadows) + sizeof(uint32_t) == sizeof(CoppiceQuality));
static_assert(offsetof(CoppiceReport, cpu_ms) + sizeof(float) == sizeof(CoppiceReport));
static_assert(offsetof(CoppiceHit, normal) + 3 * sizeof(float) == sizeof(CoppiceHit));
static_assert(offsetof(CoppiceLight, haze_density_per_m) + sizeof(float) == sizeof(CoppiceLight));

// What a caller forgot: guarded() makes an answer of it.
template <class T>
T& required(T* given, const char* name) {
    if (!given) throw std::invalid_argument(std::string(name) + " is NULL");
    return *given;
}

// As much as the caller has of it; the rest is 0, or as `taken` came.
template <class T>
T take(const T* given, T taken = {}) {
    if (!given) return taken;
    if (given->size_bytes < sizeof given->size_bytes)
        throw std::invalid_argument("a struct without its size: set size_bytes to its sizeof");
    std::memcpy(&taken, given, std::min<size_t>(given->size_bytes, sizeof(T)));
    return taken;
}

// As much as the caller has room for.
template <class T>
void give(T result, T* to) {
    required(to, "the answer's struct");
    if (to->size_bytes < sizeof to->size_bytes)
        throw std::invalid_argument("a struct without its size: set size_bytes to its sizeof");
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

void note(const char* words) noexcept {
    try {
        g_message = words;
    } catch (...) {
        g_message = "out of memory";
    }
}

EmbeddedForest& of(CoppiceForest* forest) { return *required(forest, "forest").forest; }
const EmbeddedForest& of(const CoppiceForest* forest) { return *required(forest, "forest").forest; }

// work() -> int
template <class Work>
int guarded(Work&& work) noexcept {
    try {
        g_message.clear();
        return work();
    } catch (const std::bad_alloc&) {
        g_message = "out of memory";  // as short as strings that allocate nothing
        return COPPICE_LIMIT_EXCEEDED;
    } catch (const std::invalid_argument& wrong) {
        note(wrong.what());
        return COPPICE_BAD_INPUT;
    } catch (const std::exception& thrown) {
        note(thrown.what());
        return COPPICE_FAILED;
    } catch (...) {  // of the host's own
        g_message = "unknown";
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
    const CoppicePlant plant = take(&required(given, "plant"));
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
    return guarded([&] {
        required(forest, "forest") = nullptr;
        const CoppiceForestSettings taken = take(&required(given, "settings"));
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

void destroy(CoppiceForest* forest) {
    guarded([&] {
        delete forest;
        return int(COPPICE_DONE);
    });
}

int record(CoppiceForest* forest, const CoppiceFrame* given) {
    return guarded([&] {
        const CoppiceFrame frame = take(&required(given, "frame"));
        required(frame.commands, "frame->commands");
        return result_of(of(forest).record({frame.commands, frame.slot, camera_of(frame.camera),
                                                 settings_of(frame.quality), picture_of(frame.picture)}));
    });
}

int resize(CoppiceForest* forest, uint32_t width, uint32_t height) {
    return guarded([&] { return result_of(of(forest).resize(width, height)); });
}

int set_light(CoppiceForest* forest, const CoppiceLight* given) {
    return guarded([&] {
        Light light = of(forest).scene().light;
        CoppiceLight taken{};
        put(taken.direction_to_sun, light.direction_to_sun);
        put(taken.sun_color, light.sun_color);
        put(taken.sky_zenith_color, light.sky_zenith_color);
        put(taken.sky_horizon_color, light.sky_horizon_color);
        put(taken.ground_color, light.ground_color);
        put(taken.haze_color, light.haze_color);
        taken.haze_density_per_m = light.haze_density_per_m;
        taken = take(&required(given, "light"), taken);
        light.direction_to_sun = vector_of(taken.direction_to_sun);
        light.sun_color = vector_of(taken.sun_color);
        light.sky_zenith_color = vector_of(taken.sky_zenith_color);
        light.sky_horizon_color = vector_of(taken.sky_horizon_color);
        light.ground_color = vector_of(taken.ground_color);
        light.haze_color = vector_of(taken.haze_color);
        light.haze_density_per_m = taken.haze_density_per_m;
        of(forest).vegetation().set_light(light);
        return int(COPPICE_DONE);
    });
}

void set_frame_ms(CoppiceForest* forest, uint32_t slot, double ms) {
    guarded([&] {
        of(forest).vegetation().set_frame_ms(slot, ms);
        return int(COPPICE_DONE);
    });
}

void report(const CoppiceForest* forest, CoppiceReport* to) {
    guarded([&] {
        const FrameReport& drawn = of(forest).report();
        give(CoppiceReport{0, drawn.plants_visible, drawn.plants, drawn.triangles, drawn.lines, drawn.points, drawn.leaves,
                           drawn.vertices, drawn.gpu_bytes, drawn.sample_distance_px,
                           float(drawn.cull_ms + drawn.lod_ms + drawn.write_ms)},
             to);
        return int(COPPICE_DONE);
    });
}

void scene_camera(const CoppiceForest* forest, double time_s, CoppiceCamera* to) {
    guarded([&] {
        const Camera camera = camera_at(of(forest).scene().camera_path, time_s);
        CoppiceCamera result{};
        result.vertical_fov_rad = camera.vertical_fov_rad;
        result.near_m = camera.near_m;
        put(result.forward, camera.forward());
        put(result.up, camera.up());
        put(result.position, camera.position_world);
        give(result, to);
        return int(COPPICE_DONE);
    });
}

int reload_if_changed(CoppiceForest* forest, uint32_t* changed) {
    return guarded([&] {
        required(changed, "changed") = 0;
        const Result<bool> reloaded = of(forest).reload_if_changed();
        if (reloaded) *changed = *reloaded;
        return result_of(reloaded);
    });
}

uint32_t model_count(const CoppiceForest* forest) {
    return forest ? uint32_t(forest->forest->scene().models.size()) : 0;
}

const char* model_name(const CoppiceForest* forest, uint32_t model) {
    if (!forest) return nullptr;
    const auto& models = forest->forest->scene().models;
    return model < models.size() ? models[model].name.c_str() : nullptr;
}

int add_plant(CoppiceForest* forest, const CoppicePlant* plant, uint32_t* number) {
    return guarded([&] {
        uint32_t& to = required(number, "number");
        const Result<uint32_t> added = of(forest).plants().add(placement_of(plant));
        if (added) to = *added;
        return result_of(added);
    });
}

int move_plant(CoppiceForest* forest, uint32_t number, const CoppicePlant* plant) {
    return guarded([&] { return result_of(of(forest).plants().move(number, placement_of(plant))); });
}

int remove_plant(CoppiceForest* forest, uint32_t number) {
    return guarded([&] { return result_of(of(forest).plants().remove(number)); });
}

void first_hit(const CoppiceForest* forest, const double from[3], const float direction[3],
               float most_distance_m, CoppiceHit* hit) {
    guarded([&] {
        give(hit_of({}), hit);
        give(hit_of(of(forest).stems().first_hit(place_of(&required(from, "from")), vector_of(&required(direction, "direction")),
                                                 most_distance_m)),
             hit);
        return int(COPPICE_DONE);
    });
}

void nearest_stem(const CoppiceForest* forest, const double at[3], float within_m, CoppiceHit* hit) {
    guarded([&] {
        give(hit_of({}), hit);
        give(hit_of(of(forest).stems().nearest(place_of(&required(at, "at")), within_m)), hit);
        return int(COPPICE_DONE);
    });
}

size_t stems_in_box(const CoppiceForest* forest, const double least[3], const double most[3],
                    CoppiceStem* stems, size_t room, size_t stride_bytes) {
    size_t count = 0;
    const int result = guarded([&] {
        std::vector<Stem> found;
        of(forest).stems().in_box(place_of(&required(least, "least")), place_of(&required(most, "most")), found);
        if (!stems || stride_bytes < sizeof(uint32_t)) room = 0;
        count = found.size();
        for (size_t i = 0; i < std::min(room, count); ++i) {
            CoppiceStem stem{uint32_t(std::min(stride_bytes, sizeof(CoppiceStem))),
                             found[i].plant,
                             {},
                             {},
                             found[i].radius_m,
                             0};
            put(stem.foot, found[i].foot_world);
            put(stem.head, found[i].head_world);
            std::memcpy(reinterpret_cast<std::byte*>(stems) + i * stride_bytes, &stem, stem.size_bytes);
        }
        return int(COPPICE_DONE);
    });
    return result == COPPICE_LIMIT_EXCEEDED ? SIZE_MAX : count;
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
