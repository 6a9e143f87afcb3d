// Scenes of so few triangles that their pictures are known.
#pragma once
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <vector>
#include "tools/reference/light.h"
#include "tools/reference/trace.h"

namespace coppice {

// A flat square of ground about its origin, at height 0: two triangles, one patch, one level.
class FlatGround : public Terrain {
  public:
    FlatGround(float half_side_m, uint32_t surface, dvec3 origin_world) : origin_world_(origin_world) {
        const float h = half_side_m;
        for (vec2 p : {vec2(-h, -h), vec2(-h, h), vec2(h, h), vec2(-h, -h), vec2(h, h), vec2(h, -h)}) {
            vertices_.push_back({p.x, 0.0f, p.y, surface});
            bounds_.include(vec3(p.x, 0.0f, p.y));
        }
        patches_ = {{bounds_, 0, 1}};
        levels_ = {{0, 6, 0, 0, 0.0f}};
    }
    dvec3 origin_world() const override { return origin_world_; }
    Box bounds_local() const override { return bounds_; }
    float height_at(float, float) const override { return 0.0f; }
    vec3 normal_at(float, float) const override { return vec3(0, 1, 0); }
    std::span<const TerrainPatch> patches() const override { return patches_; }
    std::span<const TerrainLevel> levels() const override { return levels_; }
    std::span<const PackedVertex> vertices() const override { return vertices_; }
    uint32_t vertex_count() const override { return uint32_t(vertices_.size()); }
    void write_vertices(std::span<PackedVertex> all) const override {
        std::copy(vertices_.begin(), vertices_.end(), all.begin());
    }
    void write_level(uint32_t, std::span<PackedVertex> of_level) const override { write_vertices(of_level); }
    void shade(float, float, float, float) override {}

  private:
    dvec3 origin_world_;
    Box bounds_;
    std::vector<TerrainPatch> patches_;
    std::vector<TerrainLevel> levels_;
    std::vector<PackedVertex> vertices_;
};

inline PackedVertex vertex_at(vec3 p, uint32_t surface) { return {p.x, p.y, p.z, surface}; }

inline uint32_t surface_word(vec3 normal, vec3 color, float openness, bool leaf) {
    return encode_surface({normal, color, openness, leaf}, 0);
}

// A parallelogram from corner along two edges, counter-clockwise about cross(edge_u, edge_v).
inline std::vector<PackedVertex> plate(vec3 corner, vec3 edge_u, vec3 edge_v, uint32_t surface) {
    const vec3 b = corner + edge_u, c = corner + edge_u + edge_v, d = corner + edge_v;
    std::vector<PackedVertex> vertices;
    for (vec3 p : {corner, b, c, corner, c, d}) vertices.push_back(vertex_at(p, surface));
    return vertices;
}

struct SmallScene {
    std::vector<std::vector<PackedVertex>> models;
    Scene scene;
    std::shared_ptr<Terrain> bare;
    Camera camera;
    ReferenceSettings settings;

    // The camera stands in the origin and looks along -z; half the picture's height is seen at distance 1.
    SmallScene() {
        camera.position_world = dvec3(0.0);
        camera.vertical_fov_rad = k_pi * 0.5f;
        scene.light.haze_density_per_m = 0.0f;
        settings.width = settings.height = 64;
    }

    uint32_t add_model(std::vector<PackedVertex> vertices) {
        models.push_back(std::move(vertices));
        scene.models.emplace_back();
        return uint32_t(models.size() - 1);
    }
    // A tile of its own for each plant.
    void add_plant(uint32_t model, dvec3 origin_world, PlantTurn turn = {0, 0, 0, 32767},
                   float scale = 1.0f) {
        SceneTile tile{};
        tile.tile.origin_world = origin_world;
        tile.first_plant = uint32_t(scene.positions.size());
        tile.plant_count = 1;
        scene.tiles.push_back(tile);
        scene.positions.push_back({0.0f, 0.0f, 0.0f, scale});
        scene.turns.push_back(turn);
        scene.plant_models.push_back({model, 0});
    }
    void add_plate(vec3 corner, vec3 edge_u, vec3 edge_v, uint32_t surface) {
        add_plant(add_model(plate(corner, edge_u, edge_v, surface)), dvec3(0.0));
    }
    void add_ground(float half_side_m, uint32_t bare_surface, uint32_t drawn_surface, dvec3 origin_world) {
        bare = std::make_shared<FlatGround>(half_side_m, bare_surface, origin_world);
        scene.terrain = std::make_shared<FlatGround>(half_side_m, drawn_surface, origin_world);
    }

    Result<std::unique_ptr<RayScene>> create() const {
        std::vector<Plant> plants(models.size());
        for (size_t i = 0; i < models.size(); ++i) plants[i].triangle_vertices = models[i];
        return create_ray_scene(scene, plants, bare.get());
    }
    Result<ReferencePicture> try_trace() const {
        COPPICE_TRY(const std::unique_ptr<RayScene> rays, create());
        return rays->trace(camera, settings);
    }
    ReferencePicture trace() const {
        auto picture = try_trace();
        EXPECT_TRUE(picture) << to_string(picture.error());
        return picture ? std::move(*picture) : ReferencePicture{};
    }
    Light light() const { return with_unit_sun(scene.light); }
};

inline vec3 pixel_of(const FloatPicture& picture, uint32_t column, uint32_t row) {
    const float* rgb = &picture.rgb[(size_t(row) * picture.width + column) * 3];
    return vec3(rgb[0], rgb[1], rgb[2]);
}

inline void expect_near(vec3 got, vec3 wanted, float tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], tolerance) << "channel " << c;
}

}  // namespace coppice
