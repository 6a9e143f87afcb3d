#include "plugins/terrain/build_patches.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

struct Patch {
    uint32_t column, row, width, height;  // in cells
    uint32_t levels() const {
        uint32_t count = 1;
        while ((1u << count) <= k_patch_cells && width % (1u << count) == 0 && height % (1u << count) == 0)
            ++count;
        return count;
    }
};

uint32_t level_vertices(const Patch& patch, uint32_t step) {
    uint32_t across = patch.width / step, down = patch.height / step;
    return 6 * across * down + 6 * 2 * (across + down);
}

// Two triangles between samples that are a level's spacing apart.
struct LevelCell {
    float first, east, south, last;
    LevelCell(const HeightField& field, uint32_t column, uint32_t row, uint32_t step)
        : first(field.sample(column, row)),
          east(field.sample(column + step, row)),
          south(field.sample(column, row + step)),
          last(field.sample(column + step, row + step)) {}
    float height(float u, float v) const {
        return u > v ? first + u * (east - first) + v * (last - east)
                     : first + v * (south - first) + u * (last - south);
    }
};

// The coarse surface has its diagonals along the fine one's, so the difference is largest at a sample.
float vertical_error(const HeightField& field, const Patch& patch, uint32_t step) {
    float error = 0.0f;
    for (uint32_t z = 0; z < patch.height; z += step)
        for (uint32_t x = 0; x < patch.width; x += step) {
            uint32_t column = patch.column + x, row = patch.row + z;
            const LevelCell cell(field, column, row, step);
            for (uint32_t j = 0; j <= step; ++j)
                for (uint32_t i = 0; i <= step; ++i) {
                    float u = float(i) / float(step), v = float(j) / float(step);
                    error = std::max(error, std::fabs(cell.height(u, v) - field.sample(column + i, row + j)));
                }
        }
    return error;
}

// A triangle's slope along x is that of one of its sides, and so along z; a coarse side's is a mean of fine ones'.
float steepest_slope(const HeightField& field, const Patch& patch) {
    float along_x = 0.0f, along_z = 0.0f;
    for (uint32_t row = patch.row; row <= patch.row + patch.height; ++row)
        for (uint32_t column = patch.column; column <= patch.column + patch.width; ++column) {
            const float height = field.sample(column, row);
            if (column < patch.column + patch.width)
                along_x = std::max(along_x, std::fabs(field.sample(column + 1, row) - height));
            if (row < patch.row + patch.height)
                along_z = std::max(along_z, std::fabs(field.sample(column, row + 1) - height));
        }
    return std::sqrt(along_x * along_x + along_z * along_z) / field.cell_m;
}

// No diagonal of a coarse level crosses a block but from corner to corner, so the level's surface over a block is lowest
// at a vertex or at a corner of the block.
void find_least_heights(const HeightField& field, const Patch& patch, uint32_t step, float* least) {
    const uint32_t stride = std::min(step, k_block_cells);
    for (uint32_t z = 0; z < patch.height; z += stride)
        for (uint32_t x = 0; x < patch.width; x += stride) {
            const uint32_t x_cell = x / step * step, z_cell = z / step * step;
            const LevelCell cell(field, patch.column + x_cell, patch.row + z_cell, step);
            float& block = least[z / k_block_cells * k_blocks_across + x / k_block_cells];
            float lowest = INFINITY;
            for (uint32_t j : {z, z + stride})
                for (uint32_t i : {x, x + stride})
                    lowest = std::min(lowest, cell.height(float(i - x_cell) / float(step),
                                                          float(j - z_cell) / float(step)));
            block = std::isfinite(block) ? std::min(block, lowest) : lowest;
        }
}

// A level's skirts, quad by quad: put(column, row) is on the ground, in samples of the level, and put(column, row, below_m,
// outwards_m) hangs from there. Skirts lean outwards: one that hangs straight down shows its edge, and the crack, to who
// looks along the border.
template <class Put>
void each_skirt_vertex(const LevelGrid& grid, Put&& put) {
    auto hang = [&](uint32_t c0, uint32_t r0, uint32_t c1, uint32_t r1, vec2 outwards) {
        const vec2 lean_m = outwards * (0.5f * grid.skirt_m);
        put(c0, r0, 0.0f, vec2(0.0f));
        put(c0, r0, grid.skirt_m, lean_m);
        put(c1, r1, grid.skirt_m, lean_m);
        put(c0, r0, 0.0f, vec2(0.0f));
        put(c1, r1, grid.skirt_m, lean_m);
        put(c1, r1, 0.0f, vec2(0.0f));
    };
    const uint32_t last_column = grid.across - 1, last_row = grid.down - 1;
    for (uint32_t column = 0; column < last_column; ++column) hang(column + 1, 0, column, 0, vec2(0, -1));
    for (uint32_t column = 0; column < last_column; ++column)
        hang(column, last_row, column + 1, last_row, vec2(0, 1));
    for (uint32_t row = 0; row < last_row; ++row) hang(0, row, 0, row + 1, vec2(-1, 0));
    for (uint32_t row = 0; row < last_row; ++row) hang(last_column, row + 1, last_column, row, vec2(1, 0));
}

// Where a sample of a level lies.
struct LevelPlaces {
    const HeightField& field;
    const LevelGrid& grid;
    vec3 operator()(uint32_t column, uint32_t row, float below_m = 0.0f, vec2 outwards_m = vec2(0.0f)) const {
        const uint32_t c = grid.first_column + (column << grid.shift),
                       r = grid.first_row + (row << grid.shift);
        return {field.x_of(c) + outwards_m.x, field.sample(c, r) - below_m, field.z_of(r) + outwards_m.y};
    }
};

Box bounds_of(const HeightField& field, std::span<const LevelGrid> levels) {
    Box bounds;
    for (const LevelGrid& grid : levels) {
        const LevelPlaces place{field, grid};
        // Coarser levels have no other samples.
        if (grid.shift == 0)
            for (uint32_t row = 0; row < grid.down; ++row)
                for (uint32_t column = 0; column < grid.across; ++column) bounds.include(place(column, row));
        each_skirt_vertex(grid, [&](auto... at) { bounds.include(place(at...)); });
    }
    return bounds;
}

void write_grid(const HeightField& field, const LevelGrid& grid, const uint32_t* words,
                PackedVertex* vertex) {
    const LevelPlaces place{field, grid};
    auto put = [&](uint32_t column, uint32_t row, float below_m, vec2 outwards_m) {
        const vec3 at = place(column, row, below_m, outwards_m);
        *vertex++ = {at.x, at.y, at.z, words[row * grid.across + column]};
    };
    // Each corner is looked up once for the two rows of cells, not for the six triangles that meet in it.
    std::vector<PackedVertex> north(grid.across), south(grid.across);
    auto look_up = [&](uint32_t row, std::vector<PackedVertex>& corners) {
        for (uint32_t column = 0; column < grid.across; ++column) {
            const vec3 at = place(column, row);
            corners[column] = {at.x, at.y, at.z, words[row * grid.across + column]};
        }
    };
    look_up(0, south);
    for (uint32_t row = 0; row + 1 < grid.down; ++row) {
        std::swap(north, south);
        look_up(row + 1, south);
        for (uint32_t column = 0; column + 1 < grid.across; ++column, vertex += 6) {
            vertex[0] = vertex[3] = north[column];
            vertex[1] = south[column];
            vertex[2] = vertex[4] = south[column + 1];
            vertex[5] = north[column + 1];
        }
    }
    each_skirt_vertex(grid, put);
}

// The mean over the samples a vertex of spacing `step` stands for: half way to its neighbours on each side.
struct Mean {
    vec3 normal{0.0f}, color{0.0f};
    float light = 0.0f;
};

Mean mean_around(const HeightField& field, const GroundSurface& ground, uint32_t sample, uint32_t step) {
    uint32_t row = sample / field.columns, column = sample % field.columns, reach = step / 2;
    // Of a periodic field's samples, those beyond the border are inside again.
    auto ends = [&](uint32_t at, uint32_t samples) {
        int64_t first = int64_t(at) - reach, last = int64_t(at) + reach;
        if (!field.periodic) first = std::max<int64_t>(first, 0), last = std::min<int64_t>(last, samples - 1);
        return std::pair(first, last);
    };
    const auto [column_first, column_last] = ends(column, field.columns);
    const auto [row_first, row_last] = ends(row, field.rows);
    Mean mean;
    float count = 0.0f;
    for (int64_t j = row_first; j <= row_last; ++j)
        for (int64_t i = column_first; i <= column_last; ++i) {
            size_t at = field.wrapped_sample(i, j);
            mean.normal += ground.normals[at];
            // Not all the way: openness already takes the skylight away, colour stands for the sun's share.
            mean.color += ground.colors_linear[at] * (0.4f + 0.6f * ground.light[at]);
            mean.light += ground.light[at];
            count += 1.0f;
        }
    mean.color /= count;
    mean.light /= count;
    return mean;
}

// A color near `wanted` that a surface word can hold: rather somewhat brighter or darker than of another hue than `color`.
// What that leaves goes to the neighbours (Floyd and Steinberg): chance alone would stain the ground, where the vertices
// lie metres apart.
vec3 nearest_color(vec3 wanted, vec3 color) {
    const vec3 steps(31.0f, 63.0f, 31.0f);
    auto value = [&](int c, float level) {
        float coded = glm::clamp(level / steps[c], 0.0f, 1.0f);
        return coded * coded;
    };
    vec3 below;
    for (int c = 0; c < 3; ++c)
        below[c] = std::floor(std::sqrt(glm::clamp(wanted[c], 0.0f, 1.0f)) * steps[c]);
    constexpr float k_least = 1e-3f;  // of what ratios are taken
    color = glm::max(color, vec3(k_least));
    const float brightness = std::max(wanted.x + 3.0f * wanted.y, 4.0f * k_least);
    vec3 best(0.0f);
    float best_cost = INFINITY;
    for (float red : {0.0f, 1.0f})
        for (float green : {-1.0f, 0.0f, 1.0f, 2.0f})
            for (float blue : {0.0f, 1.0f}) {
                const vec3 out(value(0, below.x + red), value(1, below.y + green), value(2, below.z + blue));
                const vec3 change = glm::max(out, vec3(k_least)) / color;
                const float redder = change.x / change.y - 1.0f, bluer = change.z / change.y - 1.0f;
                const float brighter = (out.x + 3.0f * out.y) / brightness - 1.0f;
                const float cost = redder * redder + 0.15f * bluer * bluer + 0.3f * brighter * brighter;
                if (cost < best_cost) best_cost = cost, best = out;
            }
    return best;
}

}  // namespace

Box TerrainMesh::bounds() const {
    Box bounds;
    for (const TerrainPatch& patch : patches) bounds.include(patch.bounds_local);
    return bounds;
}

TerrainMesh build_patches(const HeightField& field) {
    uint32_t cells_x = field.columns - 1, cells_z = field.rows - 1;
    uint32_t across = (cells_x + k_patch_cells - 1) / k_patch_cells;
    uint32_t down = (cells_z + k_patch_cells - 1) / k_patch_cells;
    std::vector<Patch> cut(size_t(across) * down);
    TerrainMesh mesh;
    mesh.patches.resize(cut.size());
    for (uint32_t j = 0; j < down; ++j)
        for (uint32_t i = 0; i < across; ++i) {
            Patch patch{i * k_patch_cells, j * k_patch_cells,
                        std::min(k_patch_cells, cells_x - i * k_patch_cells),
                        std::min(k_patch_cells, cells_z - j * k_patch_cells)};
            TerrainPatch& out = mesh.patches[j * across + i];
            out.first_level = uint32_t(mesh.levels.size());
            out.level_count = patch.levels();
            for (uint32_t level = 0; level < out.level_count; ++level) {
                const uint32_t count = level_vertices(patch, 1u << level);
                mesh.levels.push_back({mesh.vertex_count, count, 6 * (patch.width >> level),
                                       6 * (patch.height >> level), 0.0f});
                mesh.grids.push_back({patch.column, patch.row, level, (patch.width >> level) + 1,
                                      (patch.height >> level) + 1, mesh.word_count, 0.0f});
                mesh.vertex_count += count;
                mesh.word_count += mesh.grids.back().across * mesh.grids.back().down;
            }
            cut[j * across + i] = patch;
        }

    std::vector<float> vertical(mesh.levels.size(), 0.0f);
    parallel_for(cut.size(), 1, [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p)
            for (uint32_t level = 1; level < mesh.patches[p].level_count; ++level)
                vertical[mesh.patches[p].first_level + level] = vertical_error(field, cut[p], 1u << level);
    });
    auto worst = [&](size_t p) {
        float error = 0.0f;
        for (uint32_t level = 0; level < mesh.patches[p].level_count; ++level)
            error = std::max(error, vertical[mesh.patches[p].first_level + level]);
        return error;
    };

    mesh.least_heights.assign(mesh.levels.size() * k_blocks_across * k_blocks_across, -INFINITY);
    parallel_for(cut.size(), 1, [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) {
            // Two surfaces that meet differ by no more than the sum of their errors; a little more hides what
            // rounding to pixels opens.
            float beside = 0.0f;
            size_t i = p % across, j = p / across;
            if (i > 0 || field.periodic) beside = std::max(beside, worst(i > 0 ? p - 1 : p + across - 1));
            if (i + 1 < across || field.periodic)
                beside = std::max(beside, worst(i + 1 < across ? p + 1 : p - i));
            if (j > 0 || field.periodic)
                beside = std::max(beside, worst(j > 0 ? p - across : p + across * (down - 1)));
            if (j + 1 < down || field.periodic)
                beside = std::max(beside, worst(j + 1 < down ? p + across : i));
            TerrainPatch& out = mesh.patches[p];
            for (uint32_t level = 0; level < out.level_count; ++level) {
                const uint32_t index = out.first_level + level, step = 1u << level;
                mesh.levels[index].error_m =
                    level == 0 ? 0.0f
                               : std::max(vertical[index], k_color_error_share * float(step) * field.cell_m);
                find_least_heights(field, cut[p], step,
                                   &mesh.least_heights[index * k_blocks_across * k_blocks_across]);
                mesh.grids[index].skirt_m = vertical[index] + beside + 0.05f * float(step) * field.cell_m;
            }
            out.steepest = steepest_slope(field, cut[p]);
            out.bounds_local =
                bounds_of(field, std::span(mesh.grids).subspan(out.first_level, out.level_count));
        }
    });
    return mesh;
}

void write_level(const HeightField& field, const TerrainMesh& mesh, uint32_t level,
                 std::span<const uint32_t> words, std::span<PackedVertex> of_level) {
    assert(words.size() == mesh.word_count && of_level.size() == mesh.levels[level].vertex_count);
    write_grid(field, mesh.grids[level], &words[mesh.grids[level].first_word], of_level.data());
}

void write_vertices(const HeightField& field, const TerrainMesh& mesh, std::span<const uint32_t> words,
                    std::span<PackedVertex> all) {
    assert(all.size() == mesh.vertex_count);
    parallel_for(mesh.levels.size(), 8, [&](size_t first, size_t last) {
        for (size_t level = first; level < last; ++level)
            write_level(field, mesh, uint32_t(level), words,
                        all.subspan(mesh.levels[level].first_vertex, mesh.levels[level].vertex_count));
    });
}

std::vector<uint32_t> color_levels(const HeightField& field, const GroundSurface& ground,
                                   const TerrainMesh& mesh) {
    std::vector<uint32_t> words(mesh.word_count);
    parallel_for(mesh.grids.size(), 4, [&](size_t first, size_t last) {
        std::vector<vec3> owed;
        for (size_t level = first; level < last; ++level) {
            const auto& [first_column, first_row, shift, across, down, first_word, skirt_m] =
                mesh.grids[level];
            owed.assign(size_t(across) * down + across + 1, vec3(0.0f));
            for (uint32_t row = 0; row < down; ++row)
                for (uint32_t column = 0; column < across; ++column) {
                    const size_t at = size_t(row) * across + column;
                    const uint32_t sample =
                        ((row << shift) + first_row) * field.columns + (column << shift) + first_column;
                    // The same dither wherever a sample is the same place.
                    const uint32_t place =
                        uint32_t(field.wrapped_sample(sample % field.columns, sample / field.columns));
                    const Mean mean = mean_around(field, ground, sample, 1u << shift);
                    // On the border nothing is owed: both patches there must come to the same colour.
                    const bool border = column == 0 || row == 0 || column + 1 == across || row + 1 == down;
                    const vec3 wanted = border ? mean.color : mean.color + owed[at],
                               color = nearest_color(wanted, mean.color);
                    const vec3 rest = (wanted - color) * (1.0f / 16.0f);
                    if (column + 1 < across) {
                        owed[at + 1] += rest * 7.0f;
                        owed[at + across + 1] += rest;
                    }
                    if (column > 0) owed[at + across - 1] += rest * 3.0f;
                    owed[at + across] += rest * 5.0f;
                    words[first_word + at] =
                        encode_surface({normalize_or(mean.normal, vec3(0, 1, 0)), color, mean.light, false},
                                       mix_bits(place + mix_bits(shift + 1u)));
                }
        }
    });
    return words;
}

}  // namespace coppice
