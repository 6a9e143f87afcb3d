// A scene's models as the frame needs them: their parts, and where these lie in the geometry buffer.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/draw/rasteriser.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

struct DrawModel {
    vec3 center_plant;
    float radius_m;  // of the sphere around center_plant that holds the plant
    uint32_t first_part, part_count;
    uint64_t triangle_count;
};

struct SceneGeometry {
    std::vector<DrawModel> models;
    std::vector<PackedPart> parts;  // importance times the scene's
    std::vector<PartGeometry> part_geometry;
    uint32_t first_terrain_vertex = 0;
    // Until uploaded.
    std::vector<PackedVertex> vertices;
    std::vector<uint32_t> owners;
};

// plants[i] belongs to scene.models[i]. Errors: limit_exceeded beyond 2^32 vertices.
Result<SceneGeometry> gather_geometry(const Scene& scene, std::span<const Plant> plants);

}  // namespace coppice
