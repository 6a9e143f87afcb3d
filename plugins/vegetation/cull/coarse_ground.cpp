#include "plugins/vegetation/cull/coarse_ground.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

// Heights and colours at the corners of a grid of `cells` a side.
struct Grid {
    uint32_t cells;
    vec2 corner, step_m;
    std::vector<float> heights;
    std::vector<vec3> colors_linear;

    uint32_t index(uint32_t i, uint32_t j) const { return j * (cells + 1) + i; }
    vec3 at(uint32_t i, uint32_t j) const {
        return {corner.x + step_m.x * float(i), heights[index(i, j)], corner.y + step_m.y * float(j)};
    }
    // On its triangles, cut from the corner of least x and z to that of greatest.
    float height(float x, float z) const {
        const float u = std::clamp((x - corner.x) / step_m.x, 0.0f, float(cells));
        const float v = std::clamp((z - corner.y) / step_m.y, 0.0f, float(cells));
        const uint32_t i = std::min(uint32_t(u), cells - 1), j = std::min(uint32_t(v), cells - 1);
        const float a = u - float(i), b = v - float(j);
        const float low = heights[index(i, j)], high = heights[index(i + 1, j + 1)];
        const float beside = a > b ? heights[index(i + 1, j)] : heights[index(i, j + 1)];
        return low + std::max(a, b) * (beside - low) + std::min(a, b) * (high - beside);
    }
};

// The terrain's coarsest levels carry the mean colours of what their vertices stand for.
void gather_colors(const Terrain& terrain, Grid& grid) {
    std::vector<dvec3> sums(grid.heights.size(), dvec3(0.0));
    std::vector<uint32_t> counts(grid.heights.size(), 0);
    dvec3 all(0.0);
    uint32_t all_count = 0;
    std::vector<PackedVertex> vertices;
    for (const TerrainPatch& patch : terrain.patches()) {
        if (patch.level_count == 0) continue;
        const TerrainLevel& level = terrain.levels()[patch.first_level + patch.level_count - 1];
        vertices.resize(level.vertex_count);
        terrain.write_level(patch.first_level + patch.level_count - 1, vertices);
        for (const PackedVertex& vertex : vertices) {
            auto nearest = [&](float at, float from, float step) {
                return uint32_t(std::clamp((at - from) / step + 0.5f, 0.0f, float(grid.cells)));
            };
            const uint32_t k = grid.index(nearest(vertex.x_plant, grid.corner.x, grid.step_m.x),
                                          nearest(vertex.z_plant, grid.corner.y, grid.step_m.y));
            const dvec3 color(decode_surface(vertex.surface).color_linear);
            sums[k] += color;
            ++counts[k];
            all += color;
            ++all_count;
        }
    }
    const dvec3 mean = all / double(std::max(all_count, 1u));
    for (size_t k = 0; k < sums.size(); ++k)
        grid.colors_linear[k] = vec3(counts[k] > 0 ? sums[k] / double(counts[k]) : mean);
}

vec3 normal_of(const Grid& grid, uint32_t i, uint32_t j) {
    const vec3 along_x = grid.at(std::min(i + 1, grid.cells), j) - grid.at(i > 0 ? i - 1 : 0, j);
    const vec3 along_z = grid.at(i, std::min(j + 1, grid.cells)) - grid.at(i, j > 0 ? j - 1 : 0);
    return normalize_or(glm::cross(along_z, along_x), vec3(0.0f, 1.0f, 0.0f));
}

// Largest vertical distances of the grids to the terrain's samples, which are many: each is asked for once.
std::array<float, k_coarse_ground_levels> find_errors(const Terrain& terrain,
                                                      const std::array<Grid, k_coarse_ground_levels>& grids) {
    const TerrainLayout layout = terrain.layout();
    std::array<float, k_coarse_ground_levels> errors_m{};
    std::mutex mutex;
    parallel_for(layout.cells_z + 1, 16, [&](size_t first, size_t last) {
        std::array<float, k_coarse_ground_levels> some_m{};
        for (size_t j = first; j < last; ++j)
            for (uint32_t i = 0; i <= layout.cells_x; ++i) {
                const float x = layout.corner_local.x + float(i) * layout.cell_m;
                const float z = layout.corner_local.y + float(j) * layout.cell_m;
                const float height_m = terrain.height_at(x, z);
                for (size_t l = 0; l < grids.size(); ++l)
                    some_m[l] = std::max(some_m[l], std::fabs(height_m - grids[l].height(x, z)));
            }
        std::lock_guard lock(mutex);
        for (size_t l = 0; l < grids.size(); ++l) errors_m[l] = std::max(errors_m[l], some_m[l]);
    });
    return errors_m;
}

void write_level(const Grid& grid, dvec3 origin, float skirt_m, CoarseGround& ground) {
    auto corner = [&](uint32_t i, uint32_t j, float below_m) {
        const vec3 at = vec3(origin) + grid.at(i, j);
        const Surface surface{normal_of(grid, i, j), grid.colors_linear[grid.index(i, j)], 1.0f, false};
        return PackedVertex{at.x, at.y - below_m, at.z, encode_surface(surface, 1u << 31)};
    };
    auto quad = [&ground](PackedVertex a, PackedVertex b, PackedVertex c, PackedVertex d) {
        ground.vertices.insert(ground.vertices.end(), {a, b, c, a, c, d});
    };
    for (uint32_t j = 0; j < grid.cells; ++j)
        for (uint32_t i = 0; i < grid.cells; ++i)
            quad(corner(i, j, 0), corner(i, j + 1, 0), corner(i + 1, j + 1, 0), corner(i + 1, j, 0));
    const uint32_t last = grid.cells;
    for (uint32_t k = 0; k < last; ++k) {
        quad(corner(k, 0, 0), corner(k + 1, 0, 0), corner(k + 1, 0, skirt_m), corner(k, 0, skirt_m));
        quad(corner(k, last, 0), corner(k, last, skirt_m), corner(k + 1, last, skirt_m),
             corner(k + 1, last, 0));
        quad(corner(0, k, 0), corner(0, k, skirt_m), corner(0, k + 1, skirt_m), corner(0, k + 1, 0));
        quad(corner(last, k, 0), corner(last, k + 1, 0), corner(last, k + 1, skirt_m),
             corner(last, k, skirt_m));
    }
}

}  // namespace

CoarseGround make_coarse_ground(const Terrain& terrain) {
    CoarseGround ground;
    const TerrainLayout layout = terrain.layout();
    if (layout.cells_x == 0 || layout.cells_z == 0) return ground;
    std::array<Grid, k_coarse_ground_levels> grids;
    for (uint32_t l = 0; l < k_coarse_ground_levels; ++l) {
        Grid& grid = grids[l];
        grid.cells = 1u << l;
        grid.corner = layout.corner_local;
        grid.step_m =
            vec2(float(layout.cells_x), float(layout.cells_z)) * (layout.cell_m / float(grid.cells));
        for (uint32_t j = 0; j <= grid.cells; ++j)
            for (uint32_t i = 0; i <= grid.cells; ++i)
                grid.heights.push_back(terrain.height_at(grid.corner.x + grid.step_m.x * float(i),
                                                         grid.corner.y + grid.step_m.y * float(j)));
        grid.colors_linear.resize(grid.heights.size());
        gather_colors(terrain, grid);
    }
    const std::array<float, k_coarse_ground_levels> errors_m = find_errors(terrain, grids);
    for (uint32_t l = 0; l < k_coarse_ground_levels; ++l) {
        const uint32_t first = uint32_t(ground.vertices.size());
        // A neighbour may be off by as much the other way.
        write_level(grids[l], terrain.origin_world(), 2.0f * errors_m[l] + 0.1f * layout.cell_m, ground);
        const float colors_m = k_color_error_share * std::max(grids[l].step_m.x, grids[l].step_m.y);
        ground.levels.push_back(
            {first, uint32_t(ground.vertices.size()) - first, std::max(errors_m[l], colors_m)});
    }
    return ground;
}

CoarseGround make_flat_ground(const Box& bounds, vec3 color_linear) {
    const uint32_t surface = encode_surface({vec3(0.0f, 1.0f, 0.0f), color_linear, 1.0f, false}, 1u << 31);
    auto corner = [&](float x, float z) { return PackedVertex{x, bounds.min.y, z, surface}; };
    const PackedVertex low = corner(bounds.min.x, bounds.min.z), high = corner(bounds.max.x, bounds.max.z);
    CoarseGround ground;
    ground.vertices = {low,  corner(bounds.min.x, bounds.max.z), high, low,
                       high, corner(bounds.max.x, bounds.min.z)};
    ground.levels.push_back({0, 6, bounds.max.y - bounds.min.y});
    return ground;
}

}  // namespace coppice
