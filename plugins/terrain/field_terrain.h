// A terrain that is a height field: what an author described, whose look is made when it is first asked for, after all
// shading; or a packed ground, whose look is known.
#pragma once
#include <mutex>
#include <optional>
#include "plugins/terrain/build_patches.h"
#include "plugins/terrain/color_ground.h"
#include "plugins/terrain/ground_file.h"
#include "plugins/terrain/terrain.h"

namespace coppice {

class FieldTerrain final : public Terrain {
  public:
    FieldTerrain(HeightField field, GroundSettings settings, dvec3 origin_world);
    FieldTerrain(PackedGround packed, dvec3 origin_world);

    dvec3 origin_world() const override { return origin_world_; }
    Box bounds_local() const override { return bounds_local_; }
    float height_at(float x_local, float z_local) const override {
        return field_.height_at(x_local, z_local);
    }
    vec3 normal_at(float x_local, float z_local) const override;
    std::span<const TerrainPatch> patches() const override { return mesh_.patches; }
    std::span<const TerrainLevel> levels() const override { return mesh_.levels; }
    std::span<const PackedVertex> vertices() const override;
    uint32_t vertex_count() const override { return mesh_.vertex_count; }
    void write_vertices(std::span<PackedVertex> all) const override;
    void write_level(uint32_t level, std::span<PackedVertex> of_level) const override;
    void shade(float x_local, float z_local, float radius_m, float amount) override;
    TerrainLayout layout() const override {
        return {vec2(field_.x_of(0), field_.z_of(0)), field_.cell_m, field_.columns - 1, field_.rows - 1};
    }
    std::span<const float> least_heights() const override { return mesh_.least_heights; }
    PackedTerrain pack() const override;

  private:
    // Under the mutex.
    const std::vector<uint32_t>& words() const;

    HeightField field_;
    TerrainMesh mesh_;
    dvec3 origin_world_;
    Box bounds_local_;
    std::optional<GroundSettings> settings_;  // none: packed
    std::vector<float> light_;                // of an authored ground, [0, 1], one a sample
    mutable std::mutex mutex_;
    mutable std::vector<uint32_t> words_;         // empty until asked for, and again after shading
    mutable std::vector<PackedVertex> vertices_;  // likewise
};

}  // namespace coppice
