// A scene's triangles in Embree: a tree of boxes for each model and for the ground, and over them one instance a plant.
// The models' trees are made once. The one over the instances is made for a viewer and relative to it, so that what is
// near keeps its precision however large the world is.
#pragma once
#include <memory>
#include <span>
#include <vector>
#include <embree3/rtcore.h>
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

template <class Handle, void (*release)(Handle)>
struct ReleaseEmbree {
    void operator()(Handle handle) const { release(handle); }
};
using EmbreeDevice = std::unique_ptr<RTCDeviceTy, ReleaseEmbree<RTCDevice, &rtcReleaseDevice>>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, ReleaseEmbree<RTCScene, &rtcReleaseScene>>;

// A plant model, or the ground.
struct RayModel {
    std::vector<PackedVertex> vertices;  // three a triangle; own space
    // Of the ground only: for each vertex, the surface that frames draw; the true one is in `vertices`.
    std::vector<uint32_t> drawn_surfaces;
    EmbreeScene tree;
    bool is_ground() const { return !drawn_surfaces.empty(); }
};

// Own space to camera-relative world: turn * (p * scale) + place.
struct RayInstance {
    mat3 turn;
    vec3 place;
    float scale;
    uint32_t model;
    vec3 to_world(vec3 p) const { return turn * (p * scale) + place; }
};

// The scene around a viewer. Hits name instances by their index.
struct RayView {
    std::vector<RayInstance> instances;
    EmbreeScene tree;
};

class RayGeometry {
  public:
    // As ReferenceInterface::create. Copies what it needs. Errors: value_out_of_range, limit_exceeded.
    static Result<RayGeometry> create(const Scene& scene, std::span<const Plant> plants,
                                      const Terrain* bare_terrain);

    // Same bytes on any number of threads. Refers to this geometry; 0.75 kB a plant while it lives.
    // Errors: value_out_of_range, limit_exceeded.
    Result<RayView> view_from(dvec3 position_world) const;

    std::span<const RayModel> models() const { return models_; }
    const Light& light() const { return light_; }  // its sun's direction unit or zero
    uint64_t triangle_count() const { return triangle_count_; }

  private:
    Status add_ground(const Terrain& drawn, const Terrain& bare);
    Status plant_trees();

    EmbreeDevice device_;
    std::vector<uint32_t> indices_;  // 0, 1, 2 ...: vertices are in order; shared by all models
    std::vector<RayModel> models_;   // as in the scene; then the ground, where there is one
    std::vector<SceneTile> tiles_;
    std::vector<PlantPosition> positions_;
    std::vector<PlantTurn> turns_;
    std::vector<PlantModel> plant_models_;
    dvec3 ground_origin_world_{0.0};
    Light light_;
    uint64_t triangle_count_ = 0;
};

}  // namespace coppice
