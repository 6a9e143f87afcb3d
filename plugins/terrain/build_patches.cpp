#include "plugins/terrain/build_patches.h"

#include <algorithm>
#include <array>
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

struct Writer {
    const HeightField& field;
    PackedVertex* vertex;
    uint32_t* sample;
    void put(uint32_t column, uint32_t row, float below_m = 0.0f, vec2 outwards_m = vec2(0.0f)) {
        *vertex++ = {field.x_of(column) + outwards_m.x, field.sample(column, row) - below_m,
                     field.z_of(row) + outwards_m.y, 0};
        *sample++ = row * field.columns + column;
    }
};

void write_level(const Patch& patch, uint32_t step, float skirt_m, Writer writer) {
    uint32_t column_end = patch.column + patch.width, row_end = patch.row + patch.height;
    for (uint32_t row = patch.row; row < row_end; row += step)
        for (uint32_t column = patch.column; column < column_end; column += step) {
            writer.put(column, row);
            writer.put(column, row + step);
            writer.put(column + step, row + step);
            writer.put(column, row);
            writer.put(column + step, row + step);
            writer.put(column + step, row);
        }
    // Skirts lean outwards: one that hangs straight down shows its edge, and the crack, to who looks along the border.
    auto hang = [&](uint32_t c0, uint32_t r0, uint32_t c1, uint32_t r1, vec2 outwards) {
        vec2 lean_m = outwards * (0.5f * skirt_m);
        writer.put(c0, r0);
        writer.put(c0, r0, skirt_m, lean_m);
        writer.put(c1, r1, skirt_m, lean_m);
        writer.put(c0, r0);
        writer.put(c1, r1, skirt_m, lean_m);
        writer.put(c1, r1);
    };
    for (uint32_t column = patch.column; column < column_end; column += step) {
        hang(column + step, patch.row, column, patch.row, vec2(0, -1));
        hang(column, row_end, column + step, row_end, vec2(0, 1));
    }
    for (uint32_t row = patch.row; row < row_end; row += step) {
        hang(patch.column, row, patch.column, row + step, vec2(-1, 0));
        hang(column_end, row + step, column_end, row, vec2(1, 0));
    }
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

TerrainMesh build_patches(const HeightField& field) {
    uint32_t cells_x = field.columns - 1, cells_z = field.rows - 1;
    uint32_t across = (cells_x + k_patch_cells - 1) / k_patch_cells;
    uint32_t down = (cells_z + k_patch_cells - 1) / k_patch_cells;
    std::vector<Patch> cut(size_t(across) * down);
    TerrainMesh mesh;
    mesh.patches.resize(cut.size());
    uint32_t vertex_count = 0;
    for (uint32_t j = 0; j < down; ++j)
        for (uint32_t i = 0; i < across; ++i) {
            Patch patch{i * k_patch_cells, j * k_patch_cells,
                        std::min(k_patch_cells, cells_x - i * k_patch_cells),
                        std::min(k_patch_cells, cells_z - j * k_patch_cells)};
            TerrainPatch& out = mesh.patches[j * across + i];
            out.first_level = uint32_t(mesh.levels.size());
            out.level_count = patch.levels();
            for (uint32_t level = 0; level < out.level_count; ++level) {
                uint32_t count = level_vertices(patch, 1u << level);
                mesh.levels.push_back({vertex_count, count, 0.0f});
                mesh.vertex_level.push_back(uint8_t(level));
                vertex_count += count;
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
    mesh.vertices.resize(vertex_count);
    mesh.vertex_samples.resize(vertex_count);
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
                uint32_t index = out.first_level + level, step = 1u << level;
                TerrainLevel& at = mesh.levels[index];
                at.error_m =
                    level == 0 ? 0.0f
                               : std::max(vertical[index], k_color_error_share * float(step) * field.cell_m);
                find_least_heights(field, cut[p], step,
                                   &mesh.least_heights[index * k_blocks_across * k_blocks_across]);
                float skirt_m = vertical[index] + beside + 0.05f * float(step) * field.cell_m;
                write_level(cut[p], step, skirt_m,
                            {field, &mesh.vertices[at.first_vertex], &mesh.vertex_samples[at.first_vertex]});
                for (uint32_t v = at.first_vertex; v < at.first_vertex + at.vertex_count; ++v) {
                    const PackedVertex& vertex = mesh.vertices[v];
                    out.bounds_local.include(vec3(vertex.x_plant, vertex.y_plant, vertex.z_plant));
                }
            }
        }
    });
    return mesh;
}

void color_vertices(const HeightField& field, const GroundSurface& ground, TerrainMesh& mesh) {
    parallel_for(mesh.patches.size(), 1, [&](size_t first, size_t last) {
        std::vector<uint32_t> words;
        std::vector<vec3> owed;
        for (size_t p = first; p < last; ++p) {
            const TerrainPatch& patch = mesh.patches[p];
            uint32_t corner = mesh.vertex_samples[mesh.levels[patch.first_level].first_vertex];
            uint32_t column_first = corner % field.columns, row_first = corner / field.columns;
            for (uint32_t index = patch.first_level; index < patch.first_level + patch.level_count; ++index) {
                uint32_t shift = mesh.vertex_level[index];
                uint32_t across = (std::min(k_patch_cells, field.columns - 1 - column_first) >> shift) + 1;
                uint32_t down = (std::min(k_patch_cells, field.rows - 1 - row_first) >> shift) + 1;
                words.resize(size_t(across) * down);
                owed.assign(words.size() + across + 1, vec3(0.0f));
                for (uint32_t row = 0; row < down; ++row)
                    for (uint32_t column = 0; column < across; ++column) {
                        size_t at = size_t(row) * across + column;
                        uint32_t sample =
                            ((row << shift) + row_first) * field.columns + (column << shift) + column_first;
                        // The same dither wherever a sample is the same place.
                        uint32_t place =
                            uint32_t(field.wrapped_sample(sample % field.columns, sample / field.columns));
                        Mean mean = mean_around(field, ground, sample, 1u << shift);
                        // On the border nothing is owed: both patches there must come to the same colour.
                        bool border = column == 0 || row == 0 || column + 1 == across || row + 1 == down;
                        vec3 wanted = border ? mean.color : mean.color + owed[at],
                             color = nearest_color(wanted, mean.color);
                        vec3 rest = (wanted - color) * (1.0f / 16.0f);
                        if (column + 1 < across) {
                            owed[at + 1] += rest * 7.0f;
                            owed[at + across + 1] += rest;
                        }
                        if (column > 0) owed[at + across - 1] += rest * 3.0f;
                        owed[at + across] += rest * 5.0f;
                        words[at] = encode_surface(
                            {normalize_or(mean.normal, vec3(0, 1, 0)), color, mean.light, false},
                            mix_bits(place + mix_bits(shift + 1u)));
                    }
                const TerrainLevel& level = mesh.levels[index];
                for (uint32_t v = level.first_vertex; v < level.first_vertex + level.vertex_count; ++v) {
                    uint32_t sample = mesh.vertex_samples[v];
                    uint32_t row = (sample / field.columns - row_first) >> shift;
                    mesh.vertices[v].surface =
                        words[size_t(row) * across + ((sample % field.columns - column_first) >> shift)];
                }
            }
        }
    });
}

}  // namespace coppice
