// A scene's models as the frame needs them: their parts, and where these lie in the geometry buffer.
#pragma once
#include <span>
#include <vector>
#include "plugins/vegetation/cull/list_grounds.h"
#include "plugins/vegetation/draw/rasteriser.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/eco/tile_tree.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

struct DrawModel {
    vec3 center_plant;
    float radius_m;       // of the sphere around center_plant that holds the plant
    float foot_radius_m;  // likewise around its foot
    uint32_t first_part, part_count;
    uint64_t triangle_count;
    bool has_cells;  // in any of its parts
    ColorTints tints;
};

// The octree cells of a part, which are parts as well.
struct PartCells {
    uint32_t first = 0, count = 0;  // none: the part was not cut
};

// Holds a part.
struct PartSphere {
    vec3 center_plant;
    float radius_m;
};

// A tile's cloud: points in tile space.
struct DrawCloud {
    PackedPart part;
    std::vector<float> densities;  // of its points, ascending
    PartGeometry geometry;
};

// A ground's place in the geometry buffer.
struct DrawGround {
    std::shared_ptr<const Terrain> terrain;  // may be null
    uint32_t first_vertex = 0, first_coarse_vertex = 0;
    std::vector<CoarseGround::Level> coarse_levels;
    float steepest = 0.0f;  // of all its patches
};

struct SceneGeometry {
    std::vector<DrawModel> models;
    // Those given, then empty ones for what is streamed in: set_cloud.
    std::vector<DrawCloud> clouds;
    std::vector<DrawGround> grounds;
    // Of each model its parts, then their cells; importance times the scene's.
    std::vector<PackedPart> parts;
    std::vector<PartGeometry> part_geometry;
    std::vector<PartCells> part_cells;
    std::vector<PartSphere> part_spheres;
    bool has_tints = false;  // of any of the models
    // For widest_spread_px.
    float least_importance = 1.0f, most_line_width = 1.0f;
    // Until uploaded.
    std::vector<PackedVertex> vertices;
    std::vector<uint32_t> owners;
    uint32_t reserved_points = 0;  // behind both, for the streamed clouds
};

struct GeometrySource {
    std::string path;  // for messages
    std::span<const SceneModel> models;
    std::span<const Plant> plants;         // plants[i] belongs to models[i]
    std::vector<const TileCloud*> clouds;  // always drawable
    uint32_t streamed_clouds = 0;          // room for so many more of k_cloud_points
    std::span<const Ground> grounds;
};

// Errors: limit_exceeded beyond 2^32 vertices.
Result<SceneGeometry> gather_geometry(const GeometrySource& source);
// Of a scene whose tiles are all in memory.
Result<SceneGeometry> gather_geometry(const Scene& scene, std::span<const Plant> plants,
                                      std::span<const TileNode> tiles = {});

// What is drawn for geometry.clouds[index], whose points and densities lie where its geometry says. Requires at most
// k_cloud_points of a streamed one.
void set_cloud(SceneGeometry& geometry, uint32_t index, const TileCloud& cloud);

}  // namespace coppice
