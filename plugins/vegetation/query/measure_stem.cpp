#include "plugins/vegetation/query/stem.h"

#include <algorithm>

namespace coppice {
namespace {

constexpr int k_slabs = 24;
// The next slab's wood belongs to the stem up to so many radii from where it was last, and at least so far. Stems do not widen
// upwards: the radius is the least so far, or branches that leave together would be taken for one.
constexpr float k_reach_radii = 2.0f, k_least_reach_share = 0.01f;  // of the height
// None to meet: wood that is less of the way around than that, which is a bunch of stalks, and what is low on its plant and hardly
// higher than wide, which is where stalks meet.
constexpr float k_least_solidity = 0.6f, k_low_share = 0.3f, k_least_height_radii = 4.0f;

struct Slab {
    vec3 middle{0.0f};
    float radius_m = 0.0f, area_m2 = 0.0f;
};

vec3 position(const PackedVertex& vertex) { return {vertex.x_plant, vertex.y_plant, vertex.z_plant}; }

float level_distance(vec3 a, vec3 b) {
    const vec3 d = a - b;
    return std::sqrt(d.x * d.x + d.z * d.z);
}

struct Wood {
    vec3 middle;
    float area_m2;
};

std::vector<Wood> find_wood(const Plant& plant) {
    std::vector<Wood> wood;
    for (const PackedPart& part : plant.parts) {
        if (part.flags & k_part_leaf) continue;
        for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t) {
            const vec3 a = position(plant.triangle_vertices[3 * t]),
                       b = position(plant.triangle_vertices[3 * t + 1]),
                       c = position(plant.triangle_vertices[3 * t + 2]);
            wood.push_back({(a + b + c) * (1.0f / 3.0f), 0.5f * glm::length(glm::cross(b - a, c - a))});
        }
    }
    return wood;
}

// Of the wood within reach of a place: its middle, and how far from it the surface is.
Slab gather(std::span<const Wood> wood, vec3 near, float reach_m) {
    Slab slab;
    auto each = [&](auto&& add) {
        for (const Wood& piece : wood)
            if (level_distance(piece.middle, near) <= reach_m) add(piece);
    };
    each([&](const Wood& piece) {
        slab.middle += piece.middle * piece.area_m2;
        slab.area_m2 += piece.area_m2;
    });
    if (slab.area_m2 <= 0.0f) return slab;
    slab.middle = slab.middle * (1.0f / slab.area_m2);
    each([&](const Wood& piece) {
        slab.radius_m += level_distance(piece.middle, slab.middle) * piece.area_m2;
    });
    slab.radius_m /= slab.area_m2;
    return slab;
}

}  // namespace

StemShape measure_stem(const Plant& plant) {
    std::vector<Wood> wood = find_wood(plant);
    if (wood.empty()) return {};
    std::ranges::stable_sort(wood, {}, [](const Wood& piece) { return piece.middle.y; });
    const float lowest_m = wood.front().middle.y, height_m = plant.bounds_plant.max.y - lowest_m;
    if (!(height_m > 0.0f)) return {};
    std::vector<Slab> stem;
    float least_radius_m = INFINITY;
    size_t first = 0;
    for (int i = 0; i < k_slabs; ++i) {
        const float top_m = lowest_m + height_m * float(i + 1) / float(k_slabs);
        size_t end = first;
        while (end < wood.size() && wood[end].middle.y <= top_m) ++end;
        const std::span<const Wood> here = std::span(wood).subspan(first, end - first);
        first = end;
        // All of the lowest is stem; a bush of many stems has a wide one.
        const bool lowest = stem.empty();
        const float reach_m =
            lowest ? INFINITY : std::max(k_reach_radii * least_radius_m, k_least_reach_share * height_m);
        const Slab slab = gather(here, lowest ? vec3(0.0f) : stem.back().middle, reach_m);
        if (slab.area_m2 > 0.0f) {
            stem.push_back(slab);
            least_radius_m = std::min(least_radius_m, slab.radius_m);
        } else if (!lowest) {
            break;
        }
    }
    if (stem.empty()) return {};
    StemShape shape;
    const size_t half = (stem.size() + 1) / 2;
    float around_m2 = 0.0f, area_m2 = 0.0f;
    for (size_t i = 0; i < half; ++i) {
        shape.radius_m += stem[i].radius_m / float(half);
        around_m2 += 2.0f * k_pi * stem[i].radius_m * height_m / float(k_slabs);
        area_m2 += stem[i].area_m2;
    }
    const float stem_m = stem.back().middle.y - lowest_m;
    if (area_m2 < k_least_solidity * around_m2) return {};
    if (stem_m < k_low_share * height_m && stem_m < k_least_height_radii * shape.radius_m) return {};
    shape.foot_plant = stem.front().middle;
    shape.foot_plant.y = lowest_m;
    shape.head_plant = stem.back().middle;
    return shape;
}

Stem place_stem(const StemShape& shape, dvec3 place_world, PlantTurn turn, float scale, uint32_t plant) {
    const mat3 rotation = rotation_matrix(turn);
    return {place_world + dvec3(rotation * (shape.foot_plant * scale)),
            place_world + dvec3(rotation * (shape.head_plant * scale)), shape.radius_m * scale, plant};
}

std::vector<Stem> stems_of(const Scene& scene, std::span<const StemShape> shapes) {
    std::vector<Stem> stems;
    for (const SceneTile& tile : scene.tiles)
        for (uint32_t i = tile.first_plant; i < tile.first_plant + tile.plant_count; ++i) {
            const PlantPosition& at = scene.positions[i];
            const StemShape& shape = shapes[scene.plant_models[i].model];
            if (shape.radius_m > 0.0f)
                stems.push_back(place_stem(shape,
                                           tile.tile.origin_world + dvec3(at.x_tile, at.y_tile, at.z_tile),
                                           scene.turns[i], at.scale, i));
        }
    std::ranges::sort(stems, {}, &Stem::plant);
    return stems;
}

}  // namespace coppice
