#include "plugins/terrain/build_patches.h"

#include <gtest/gtest.h>
#include "runtime/core/random.h"

namespace coppice {
namespace {

vec3 position(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

// Height of the triangle over a place, or infinity beside it.
double height_over(const vec3* t, double x, double z) {
    const dvec3 a(t[0]), ab = dvec3(t[1]) - a, ac = dvec3(t[2]) - a;
    const double area = ab.x * ac.z - ab.z * ac.x;
    const double u = ((x - a.x) * ac.z - (z - a.z) * ac.x) / area;
    const double v = (ab.x * (z - a.z) - ab.z * (x - a.x)) / area;
    return u < -1e-6 || v < -1e-6 || u + v > 1.000001 ? double(INFINITY) : a.y + u * ab.y + v * ac.y;
}

// The surface is linear between the samples of the full grid, so its lowest place in a block is over one of them.
TEST(BuildPatches, LeastHeightsAreThoseOfEachLevelsSurface) {
    Random random(7);
    for (auto [columns, rows] :
         {std::pair(33u, 33u), std::pair(65u, 41u), std::pair(39u, 6u), std::pair(2u, 3u)}) {
        HeightField field;
        field.columns = columns;
        field.rows = rows;
        field.cell_m = 1.5f;
        for (uint32_t i = 0; i < columns * rows; ++i)
            field.heights_m.push_back(random.next_in(-20.0f, 30.0f));
        const TerrainMesh mesh = build_patches(field);
        std::vector<PackedVertex> vertices(mesh.vertex_count);
        write_vertices(field, mesh, std::vector<uint32_t>(mesh.word_count), vertices);
        ASSERT_EQ(mesh.least_heights.size(), mesh.levels.size() * k_blocks_across * k_blocks_across);
        const uint32_t across = (columns - 1 + k_patch_cells - 1) / k_patch_cells;
        for (uint32_t p = 0; p < mesh.patches.size(); ++p) {
            const uint32_t column0 = p % across * k_patch_cells, row0 = p / across * k_patch_cells;
            const uint32_t width = std::min(k_patch_cells, columns - 1 - column0);
            const uint32_t height = std::min(k_patch_cells, rows - 1 - row0);
            for (uint32_t l = 0; l < mesh.patches[p].level_count; ++l) {
                const uint32_t index = mesh.patches[p].first_level + l;
                std::vector<double> lowest(k_blocks_across * k_blocks_across, double(INFINITY));
                // The surface comes first, skirts follow.
                const uint32_t surface = 6 * (width >> l) * (height >> l);
                for (uint32_t v = 0; v < surface; v += 3) {
                    vec3 t[3];
                    for (uint32_t c = 0; c < 3; ++c)
                        t[c] = position(vertices[mesh.levels[index].first_vertex + v + c]);
                    // Cells of the patch that the triangle's square has.
                    auto cell_at = [&](float at, float first) {
                        return uint32_t((at - first) / field.cell_m + 0.5f);
                    };
                    const uint32_t x0 = cell_at(t[0].x, field.x_of(column0)),
                                   z0 = cell_at(t[0].z, field.z_of(row0));
                    for (uint32_t z = z0; z <= z0 + (1u << l); ++z)
                        for (uint32_t x = x0; x <= x0 + (1u << l); ++x) {
                            const double y = height_over(t, field.x_of(column0 + x), field.z_of(row0 + z));
                            for (uint32_t bz : {z / k_block_cells, (z - std::min(z, 1u)) / k_block_cells})
                                for (uint32_t bx : {x / k_block_cells, (x - std::min(x, 1u)) / k_block_cells})
                                    if (bx < k_blocks_across && bz < k_blocks_across) {
                                        double& low = lowest[bz * k_blocks_across + bx];
                                        low = std::min(low, y);
                                    }
                        }
                }
                for (uint32_t b = 0; b < lowest.size(); ++b) {
                    const float least = mesh.least_heights[index * k_blocks_across * k_blocks_across + b];
                    const bool exists = b % k_blocks_across * k_block_cells < width &&
                                        b / k_blocks_across * k_block_cells < height;
                    if (exists)
                        ASSERT_NEAR(least, lowest[b], 1e-4) << columns << ' ' << p << ' ' << l << ' ' << b;
                    else
                        ASSERT_EQ(least, -INFINITY);
                }
            }
        }
    }
}

}  // namespace
}  // namespace coppice
