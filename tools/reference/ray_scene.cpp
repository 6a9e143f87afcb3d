#include "tools/reference/ray_scene.h"

#include <algorithm>
#include <numeric>
#include <string>
#include "plugins/vegetation/plant/description.h"
#include "tools/reference/light.h"

namespace coppice {
namespace {

constexpr size_t k_model_vertex_limit = size_t(1) << 30;  // Embree: 16 GiB a buffer
// Far beyond what is meant; within them no product or sum overflows.
constexpr float k_radiance_limit = 1e9f, k_place_limit_m = 1e9f, k_scale_limit = 1e6f;
// Fixed, so that processors with wider vectors find the same; rays that go one by one gain nothing from those.
constexpr const char* k_device = "max_isa=avx2";

auto wrong(std::string place, std::string fault, std::string remedy) {
    return fail(ErrorId::value_out_of_range, "", std::move(place), std::move(fault), std::move(remedy));
}

Status check_device(RTCDevice device) {
    switch (rtcGetDeviceError(device)) {
        case RTC_ERROR_NONE:
            return {};
        case RTC_ERROR_OUT_OF_MEMORY:
            return fail(ErrorId::limit_exceeded, "", "ray tracer", "no memory for the scene's triangles",
                        "a smaller scene, or more memory");
        default:
            return fail(ErrorId::limit_exceeded, "", "ray tracer", "Embree refuses the scene",
                        "a processor and a scene that Embree 3 takes");
    }
}

bool within(vec3 v, float limit) {
    return std::fabs(v.x) <= limit && std::fabs(v.y) <= limit && std::fabs(v.z) <= limit;  // false for NaN
}
bool within(dvec3 v, float limit) { return within(vec3(v), limit); }

Status check_light(const Light& light) {
    if (!is_finite(light.direction_to_sun))
        return wrong("sun", "a direction that is not finite", "a vector towards it");
    for (vec3 color : {light.sun_color, light.sky_zenith_color, light.sky_horizon_color, light.ground_color,
                       light.haze_color})
        if (!within(color, k_radiance_limit))
            return wrong("light", "a radiance that is not finite, or over 1e9", "around 1");
    if (!(light.haze_density_per_m >= 0.0f) || !std::isfinite(light.haze_density_per_m))
        return wrong("haze", std::to_string(light.haze_density_per_m) + " per metre", "0 or more");
    return {};
}

Status check_plants(const Scene& scene, std::span<const Plant> plants) {
    if (plants.size() != scene.models.size())
        return wrong("plants", std::to_string(plants.size()) + " packed plants",
                     "one for each of the scene's " + std::to_string(scene.models.size()) + " models");
    for (size_t i = 0; i < plants.size(); ++i)
        for (const PackedVertex& v : plants[i].triangle_vertices)
            if (!within(vec3(v.x_plant, v.y_plant, v.z_plant), k_position_limit_m))
                return wrong("models[" + std::to_string(i) + "]", "a vertex that is not finite, or too far",
                             "at most 1e5 m from the foot");
    const size_t placed = scene.positions.size();
    if (scene.turns.size() != placed || scene.plant_models.size() != placed)
        return wrong("plants", "arrays of different length", "one position, turn and model a plant");
    for (const SceneTile& tile : scene.tiles) {
        if (tile.first_plant > placed || tile.plant_count > placed - tile.first_plant)
            return wrong("tiles", "a tile of plants that do not exist", "ranges inside the arrays");
        if (!within(tile.tile.origin_world, k_place_limit_m))
            return wrong("tiles", "an origin that is not finite, or too far", "at most 1e9 m");
    }
    for (size_t i = 0; i < placed; ++i) {
        const PlantPosition& p = scene.positions[i];
        if (scene.plant_models[i].model >= plants.size())
            return wrong("plants[" + std::to_string(i) + "]",
                         "model " + std::to_string(scene.plant_models[i].model),
                         "the scene has " + std::to_string(plants.size()) + " models");
        if (!within(vec3(p.x_tile, p.y_tile, p.z_tile), k_place_limit_m) ||
            !(p.scale >= 1.0f / k_scale_limit && p.scale <= k_scale_limit))
            return wrong("plants[" + std::to_string(i) + "]", "a place or scale that cannot be meant",
                         "at most 1e9 m, and a scale from 1e-6 to 1e6");
    }
    return {};
}

// Watertight, because a ray that slips between two leaves' triangles would see through a crown. Tuned for tracing: a
// model's tree is made once and crossed a hundred million times.
EmbreeScene new_scene(RTCDevice device, RTCBuildQuality quality) {
    EmbreeScene scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), quality);
    return scene;
}

void attach(RTCScene scene, RTCGeometry geometry, uint32_t id) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
}

}  // namespace

Result<RayGeometry> RayGeometry::create(const Scene& scene, std::span<const Plant> plants,
                                        const Terrain* bare_terrain) {
    COPPICE_CHECK(check_plants(scene, plants));
    COPPICE_CHECK(check_light(scene.light));
    if ((scene.terrain != nullptr) != (bare_terrain != nullptr))
        return wrong("terrain", scene.terrain ? "no bare one" : "a bare one of a scene without",
                     "the scene's terrain as it was before shade_ground");
    RayGeometry geometry;
    geometry.light_ = with_unit_sun(scene.light);
    geometry.tiles_ = scene.tiles;
    geometry.positions_ = scene.positions;
    geometry.turns_ = scene.turns;
    geometry.plant_models_ = scene.plant_models;
    for (const Plant& plant : plants) {
        RayModel& model = geometry.models_.emplace_back();
        model.vertices.assign(plant.triangle_vertices.begin(), plant.triangle_vertices.end());
    }
    if (scene.terrain) COPPICE_CHECK(geometry.add_ground(*scene.terrain, *bare_terrain));
    COPPICE_CHECK(geometry.plant_trees());
    return geometry;
}

Status RayGeometry::add_ground(const Terrain& drawn, const Terrain& bare) {
    if (drawn.vertices().size() != bare.vertices().size())
        return wrong("terrain", "a bare one of another size", "the same terrain before shade_ground");
    if (!within(drawn.origin_world(), k_place_limit_m))
        return wrong("terrain", "an origin that is not finite, or too far", "at most 1e9 m");
    RayModel ground;
    for (const TerrainPatch& patch : drawn.patches()) {
        if (patch.level_count == 0) continue;
        const TerrainLevel& level = drawn.levels()[patch.first_level];
        for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; ++v) {
            PackedVertex vertex = drawn.vertices()[v];
            if (!within(vec3(vertex.x_plant, vertex.y_plant, vertex.z_plant), k_place_limit_m))
                return wrong("terrain", "a vertex that is not finite, or too far", "at most 1e9 m");
            ground.drawn_surfaces.push_back(vertex.surface);
            vertex.surface = bare.vertices()[v].surface;
            ground.vertices.push_back(vertex);
        }
    }
    ground_origin_world_ = drawn.origin_world();
    if (ground.is_ground()) models_.push_back(std::move(ground));
    return {};
}

Status RayGeometry::plant_trees() {
    device_.reset(rtcNewDevice(k_device));
    COPPICE_CHECK(check_device(device_.get()));
    size_t most = 0;
    for (const RayModel& model : models_) most = std::max(most, model.vertices.size());
    if (most > k_model_vertex_limit)
        return fail(ErrorId::limit_exceeded, "", "ray tracer",
                    std::to_string(most) + " vertices in one model",
                    "at most " + std::to_string(k_model_vertex_limit));
    indices_.resize(most);
    std::iota(indices_.begin(), indices_.end(), 0u);
    for (RayModel& model : models_) {
        const size_t triangles = model.vertices.size() / 3;
        if (triangles == 0) continue;
        model.tree = new_scene(device_.get(), RTC_BUILD_QUALITY_HIGH);
        RTCGeometry mesh = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, model.vertices.data(),
                                   0, sizeof(PackedVertex), triangles * 3);
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices_.data(), 0,
                                   3 * sizeof(uint32_t), triangles);
        attach(model.tree.get(), mesh, 0);
        rtcCommitScene(model.tree.get());
        COPPICE_CHECK(check_device(device_.get()));
        if (model.is_ground()) triangle_count_ += triangles;
    }
    for (const SceneTile& tile : tiles_)
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row)
            triangle_count_ += models_[plant_models_[row].model].vertices.size() / 3;
    return {};
}

Result<RayView> RayGeometry::view_from(dvec3 position_world) const {
    if (!within(position_world, k_place_limit_m))
        return wrong("camera", "a place that is not finite, or too far", "at most 1e9 m");
    RayView view;
    for (const SceneTile& tile : tiles_) {
        const vec3 origin(tile.tile.origin_world - position_world);
        for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
            const PlantPosition& p = positions_[row];
            view.instances.push_back({rotation_matrix(turns_[row]),
                                      origin + vec3(p.x_tile, p.y_tile, p.z_tile), p.scale,
                                      plant_models_[row].model});
        }
    }
    if (!models_.empty() && models_.back().is_ground())
        view.instances.push_back(
            {mat3(1.0f), vec3(ground_origin_world_ - position_world), 1.0f, uint32_t(models_.size() - 1)});

    view.tree = new_scene(device_.get(), RTC_BUILD_QUALITY_MEDIUM);
    for (uint32_t i = 0; i < view.instances.size(); ++i) {
        const RayInstance& instance = view.instances[i];
        const RayModel& model = models_[instance.model];
        if (!model.tree) continue;
        RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, model.tree.get());
        float columns[12];
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 3; ++r)
                columns[c * 3 + r] = c < 3 ? instance.turn[c][r] * instance.scale : instance.place[r];
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        attach(view.tree.get(), geometry, i);
    }
    rtcCommitScene(view.tree.get());
    COPPICE_CHECK(check_device(device_.get()));
    return view;
}

}  // namespace coppice
