#include "plugins/vegetation/eco/make_tiles.h"

#include <algorithm>
#include <cassert>
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr uint32_t k_levels = 24;  // of the quad tree; 2^24 steps along a side

uint64_t spread_bits(uint64_t x) {
    x = (x | x << 16) & 0x0000ffff0000ffffull;
    x = (x | x << 8) & 0x00ff00ff00ff00ffull;
    x = (x | x << 4) & 0x0f0f0f0f0f0f0f0full;
    x = (x | x << 2) & 0x3333333333333333ull;
    return (x | x << 1) & 0x5555555555555555ull;
}

uint64_t gather_bits(uint64_t x) {
    x &= 0x5555555555555555ull;
    x = (x | x >> 1) & 0x3333333333333333ull;
    x = (x | x >> 2) & 0x0f0f0f0f0f0f0f0full;
    x = (x | x >> 4) & 0x00ff00ff00ff00ffull;
    x = (x | x >> 8) & 0x0000ffff0000ffffull;
    return (x | x >> 16) & 0x00000000ffffffffull;
}

struct Key {
    uint64_t morton;
    uint32_t index;
    bool operator<(const Key& other) const {
        return morton != other.morton ? morton < other.morton : index < other.index;
    }
};

struct Square {
    size_t first, last;
    uint32_t level;  // its side is root / 2^level
};

// Leaves of the quad tree: ranges of the sorted keys.
std::vector<Square> cut_squares(const std::vector<Key>& keys, double root_m) {
    std::vector<Square> open{{0, keys.size(), 0}}, leaves;
    while (!open.empty()) {
        Square square = open.back();
        open.pop_back();
        double side_m = root_m / double(1u << square.level);
        if (square.last - square.first <= k_tile_plant_limit) {
            if (square.first < square.last) leaves.push_back(square);
        } else if (square.level + 1 >= k_levels || side_m < 2.0 * k_tile_least_side_m) {
            for (size_t first = square.first; first < square.last; first += k_tile_plant_limit)
                leaves.push_back({first, std::min(first + k_tile_plant_limit, square.last), square.level});
        } else {
            uint32_t shift = 2 * (k_levels - square.level - 1);
            uint64_t base = keys[square.first].morton >> (shift + 2) << 2;
            size_t end = square.last;
            for (uint64_t child = 4; child-- > 0;) {  // last first, so that the stack gives them in order
                Key bound{(base + child) << shift, 0};
                size_t begin = child == 0 ? square.first
                                          : size_t(std::lower_bound(keys.begin() + ptrdiff_t(square.first),
                                                                    keys.begin() + ptrdiff_t(end), bound) -
                                                   keys.begin());
                open.push_back({begin, end, square.level + 1});
                end = begin;
            }
        }
    }
    return leaves;
}

double round_sixteenth(double x) { return std::floor(x * 16.0 + 0.5) / 16.0; }

// Sorted in pieces by many threads, then merged pairwise: the keys are all different, so the result is one.
void sort_keys(std::vector<Key>& keys) {
    constexpr size_t k_piece = size_t(1) << 15;
    auto at = [&](size_t i) { return keys.begin() + ptrdiff_t(std::min(i, keys.size())); };
    parallel_for((keys.size() + k_piece - 1) / k_piece, 1, [&](size_t first, size_t last) {
        for (size_t p = first; p < last; ++p) std::sort(at(p * k_piece), at((p + 1) * k_piece));
    });
    for (size_t width = k_piece; width < keys.size(); width *= 2)
        parallel_for((keys.size() + 2 * width - 1) / (2 * width), 1, [&](size_t first, size_t last) {
            for (size_t p = first; p < last; ++p)
                std::inplace_merge(at(2 * p * width), at((2 * p + 1) * width), at((2 * p + 2) * width));
        });
}

}  // namespace

void make_tiles(std::span<const Placement> placements, Scene& scene) {
    size_t count = placements.size();
    assert(count <= k_plant_limit);
    scene.tiles.clear();
    scene.positions.resize(count);
    scene.turns.resize(count);
    scene.plant_models.resize(count);
    if (count == 0) return;

    double x_low = INFINITY, z_low = INFINITY, x_high = -INFINITY, z_high = -INFINITY;
    for (const Placement& plant : placements) {
        x_low = std::min(x_low, plant.position_world.x);
        x_high = std::max(x_high, plant.position_world.x);
        z_low = std::min(z_low, plant.position_world.z);
        z_high = std::max(z_high, plant.position_world.z);
    }
    double root_m = 1.0;
    while (root_m < std::max(x_high - x_low, z_high - z_low) + 1e-3) root_m *= 2.0;
    double step_m = root_m / double(1u << k_levels);
    std::vector<Key> keys(count);
    parallel_for(count, 16384, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            auto step = [&](double d) {
                return std::min(uint64_t(d / step_m), uint64_t(1u << k_levels) - 1);
            };
            const dvec3& at = placements[i].position_world;
            keys[i] = {spread_bits(step(at.x - x_low)) | spread_bits(step(at.z - z_low)) << 1, uint32_t(i)};
        }
    });
    sort_keys(keys);
    std::vector<Square> squares = cut_squares(keys, root_m);
    scene.tiles.resize(squares.size());
    parallel_for(squares.size(), 4, [&](size_t first, size_t last) {
        for (size_t t = first; t < last; ++t) {
            const Square& square = squares[t];
            auto begin = keys.begin() + ptrdiff_t(square.first), end = keys.begin() + ptrdiff_t(square.last);
            uint32_t shift = k_levels - square.level;
            uint64_t corner = begin->morton >> (2 * shift) << (2 * shift);
            double half_m = 0.5 * step_m * double(uint64_t(1) << shift), y_sum = 0.0;
            for (auto key = begin; key != end; ++key) y_sum += placements[key->index].position_world.y;
            dvec3 origin(round_sixteenth(x_low + double(gather_bits(corner)) * step_m + half_m),
                         round_sixteenth(y_sum / double(square.last - square.first)),
                         round_sixteenth(z_low + double(gather_bits(corner >> 1)) * step_m + half_m));
            std::sort(begin, end, [&](const Key& a, const Key& b) {
                uint32_t model_a = placements[a.index].model.model, model_b = placements[b.index].model.model;
                return model_a != model_b ? model_a < model_b : a < b;
            });
            SceneTile& tile = scene.tiles[t];
            tile = {{origin, {}}, uint32_t(square.first), uint32_t(square.last - square.first)};
            for (size_t row = square.first; row < square.last; ++row) {
                const Placement& plant = placements[keys[row].index];
                vec3 local(plant.position_world - origin);
                scene.positions[row] = {local.x, local.y, local.z, plant.scale};
                scene.turns[row] = plant.turn;
                scene.plant_models[row] = plant.model;
                tile.tile.bounds_tile.include(local);
            }
        }
    });
}

void finish_tiles(Scene& scene, std::span<const Box> model_bounds_plant) {
    assert(model_bounds_plant.size() >= scene.models.size());
    parallel_for(scene.tiles.size(), 4, [&](size_t first, size_t last) {
        for (size_t t = first; t < last; ++t) {
            SceneTile& tile = scene.tiles[t];
            tile.tile.bounds_tile = {};
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
                const PlantPosition& p = scene.positions[row];
                Box bounds = model_bounds_plant[scene.plant_models[row].model];
                if (bounds.empty()) bounds = {vec3(0.0f), vec3(0.0f)};
                vec3 half = bounds.size() * (0.5f * p.scale), center = bounds.center() * p.scale;
                mat3 turn = rotation_matrix(scene.turns[row]);
                vec3 middle = vec3(p.x_tile, p.y_tile, p.z_tile) + turn * center;
                // Turns are rounded to 16 bits: a thousandth more holds for certain.
                vec3 reach =
                    (glm::abs(turn[0]) * half.x + glm::abs(turn[1]) * half.y + glm::abs(turn[2]) * half.z) *
                        1.001f +
                    1e-4f * glm::length(center);
                tile.tile.bounds_tile.include(Box{middle - reach, middle + reach});
            }
        }
    });
}

}  // namespace coppice
