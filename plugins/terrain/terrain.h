// Interface "coppice.terrain": height fields. Every cell of a square grid is two triangles, cut from its
// corner of least x and z to that of greatest; level 0 draws exactly these, and height_at samples them: what
// is drawn is stood upon.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "runtime/core/math.h"
#include "runtime/core/result.h"

namespace coppice {

struct PackedVertex;  // plugins/vegetation/plant/plant.h

// Fewer vertices are wrong by at least this share of their spacing: they carry the colour too, and even flat ground must
// not lose it to a triangle of a hundred metres.
inline constexpr float k_color_error_share = 1.0f / 10.0f;

struct TerrainLevel {
    // Into Terrain::vertices, three a triangle: the surface, then skirts, which hide what opens to a neighbour of another
    // level: of the sides of least z and of greatest z, x_skirt_vertex_count each, and of least x and of greatest x.
    uint32_t first_vertex, vertex_count;
    uint32_t x_skirt_vertex_count, z_skirt_vertex_count;
    // Largest vertical distance to the full grid; above level 0 at least k_color_error_share of its vertices' spacing.
    float error_m;

    uint32_t surface_vertex_count() const {
        return vertex_count - 2 * (x_skirt_vertex_count + z_skirt_vertex_count);
    }
};

inline constexpr uint32_t k_patch_cells = 32;
// A level's least heights are known for blocks of this many cells a side.
inline constexpr uint32_t k_block_cells = 2;
inline constexpr uint32_t k_blocks_across = k_patch_cells / k_block_cells;

// How patches() tile the field: row by row from its corner of least x and z, each k_patch_cells a side but for the last
// of a row or column, which may have fewer.
struct TerrainLayout {
    vec2 corner_local{0.0f};  // x, z
    float cell_m = 0.0f;
    uint32_t cells_x = 0, cells_z = 0;  // 0: not told
};

// A square piece with its levels, 0 the finest.
struct TerrainPatch {
    Box bounds_local;
    uint32_t first_level, level_count;  // into Terrain::levels
    // No piece of its surface, at any level, rises more m a metre; skirts do.
    float steepest = INFINITY;
};

// A file from which the same ground is loaded, as "packed", at little cost: its heights and its look.
struct PackedTerrain {
    std::vector<std::byte> bytes;  // none: the ground cannot be packed
    uint64_t content_hash = 0;
};

class Terrain {
  public:
    virtual ~Terrain() = default;
    // Local coordinates: metres from origin_world(). Outside the field the border's values hold.
    virtual dvec3 origin_world() const = 0;
    virtual Box bounds_local() const = 0;
    virtual float height_at(float x_local, float z_local) const = 0;  // m
    virtual vec3 normal_at(float x_local, float z_local) const = 0;   // unit
    virtual std::span<const TerrainPatch> patches() const = 0;
    virtual std::span<const TerrainLevel> levels() const = 0;
    virtual std::span<const PackedVertex> vertices() const = 0;  // positions local
    // The same, without keeping them here as well: of all levels, as many as vertex_count(), or those of one.
    virtual uint32_t vertex_count() const = 0;
    virtual void write_vertices(std::span<PackedVertex> all) const = 0;
    virtual void write_level(uint32_t level, std::span<PackedVertex> of_level) const = 0;
    // Multiplies the ground's colour around a point, for what shades it; call before vertices are used.
    // amount in [0, 1]; falls off smoothly to nothing at radius_m. A packed ground stays as it is.
    virtual void shade(float x_local, float z_local, float radius_m, float amount) = 0;
    // What the ground hides can be told only where these two are known.
    virtual TerrainLayout layout() const { return {}; }
    // Of each level k_blocks_across^2 blocks, row by row: the least height of its drawn surface, skirts left out;
    // -infinity where a narrow patch has no block.
    virtual std::span<const float> least_heights() const { return {}; }
    // After all shading.
    virtual PackedTerrain pack() const { return {}; }
};

inline constexpr const char* k_terrain_interface = "coppice.terrain";
inline constexpr uint32_t k_terrain_version = 6;

struct TerrainInterface {
    uint32_t size_bytes;
    // json: the scene's "terrain" object; base_dir: what its paths are relative to; file: for messages.
    Result<std::shared_ptr<Terrain>> (*load)(std::string_view json, const std::string& base_dir,
                                             const std::string& file);
};

}  // namespace coppice
