// Packed plants of a few triangles.
#pragma once
#include <gtest/gtest.h>
#include "tools/accuracy/substitute_models.h"

namespace coppice::shapes {

inline PackedVertex packed_vertex(vec3 position, vec3 normal = vec3(0, 1, 0), vec3 color = vec3(0.25f),
                                  bool leaf = false) {
    return {position.x, position.y, position.z, encode_surface({normal, color, 1.0f, leaf}, 1)};
}

// Each entry of `parts` is a part, three corners a triangle.
inline Plant packed_plant(const std::vector<std::vector<PackedVertex>>& parts, uint32_t flags = 0) {
    PlantBlocks blocks;
    blocks.name = "shape";
    for (const auto& corners : parts) {
        PackedPart part{};
        part.importance = 1.0f;
        part.flags = flags;
        part.coverage_gain.fill(1.0f);
        add_triangle_part(part, corners, blocks);
        for (const PackedVertex& v : corners)
            blocks.bounds_plant.include(vec3(v.x_plant, v.y_plant, v.z_plant));
    }
    auto plant = pack_substitute(blocks);
    EXPECT_TRUE(plant) << to_string(plant.error());
    return std::move(*plant);
}

inline vec3 place_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

}  // namespace coppice::shapes
