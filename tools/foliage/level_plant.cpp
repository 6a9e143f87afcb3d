#include "tools/foliage/level_plant.h"

#include <cassert>
#include <vector>
#include "runtime/core/hash.h"
#include "tools/accuracy/substitute_models.h"

namespace coppice {

Result<Plant> make_level_plant(const Plant& plant, std::span<const Leaf> leaves, const OpennessGrid& openness,
                               bool with_wood) {
    std::vector<PackedVertex> corners;
    corners.reserve(6 * leaves.size());
    for (size_t i = 0; i < leaves.size(); ++i) {
        const Leaf& leaf = leaves[i];
        for (size_t k : {0, 1, 2, 0, 2, 3}) {
            const vec3 at = leaf.corners_plant[k];
            const Surface surface{leaf.normal_plant, leaf.color_linear, openness.at(at), true};
            corners.push_back({at.x, at.y, at.z, encode_surface(surface, mix_bits(uint32_t(6 * i + k)))});
        }
    }
    PlantBlocks blocks = empty_blocks_like(plant);
    const PackedPart* leaf_part = nullptr;
    for (const PackedPart& part : plant.parts) {
        if (part.flags & k_part_leaf) {
            leaf_part = &part;
        } else if (with_wood) {
            const auto triangles = plant.triangle_vertices.subspan(3 * size_t(part.first_triangle),
                                                                   3 * size_t(part.triangle_count));
            add_triangle_part(part, triangles, blocks);
        }
    }
    assert(leaf_part);
    add_triangle_part(*leaf_part, corners, blocks);
    return pack_substitute(blocks);
}

}  // namespace coppice
