#include "plugins/vegetation/eco/tile_tree.h"

#include <algorithm>
#include <bit>
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr size_t k_most_children = 8;
constexpr uint32_t k_key_bits = 24;  // along each axis

// A tile that holds plants, and where its origin lies along a Morton curve.
struct Key {
    uint64_t morton;
    uint32_t tile;
    bool operator<(const Key& other) const {
        return morton != other.morton ? morton < other.morton : tile < other.tile;
    }
};

uint64_t spread_bits(uint64_t x) {
    uint64_t spread = 0;
    for (uint32_t bit = 0; bit < k_key_bits; ++bit) spread |= (x >> bit & 1u) << (2 * bit);
    return spread;
}

std::vector<Key> sort_along_curve(const Scene& scene) {
    std::vector<Key> keys;
    double low_x = INFINITY, low_z = INFINITY, high_x = -INFINITY, high_z = -INFINITY;
    for (uint32_t t = 0; t < scene.tiles.size(); ++t) {
        if (scene.tiles[t].plant_count == 0) continue;
        const dvec3& at = scene.tiles[t].tile.origin_world;
        low_x = std::min(low_x, at.x), high_x = std::max(high_x, at.x);
        low_z = std::min(low_z, at.z), high_z = std::max(high_z, at.z);
        keys.push_back({0, t});
    }
    const double side_m = std::max(high_x - low_x, high_z - low_z);
    auto step = [side_m](double away_m) {
        constexpr double k_steps = double(1u << k_key_bits);
        const double share = side_m > 0.0 ? away_m / side_m * k_steps : 0.0;
        return uint64_t(std::clamp(share == share ? share : 0.0, 0.0, k_steps - 1.0));
    };
    for (Key& key : keys) {
        const dvec3& at = scene.tiles[key.tile].tile.origin_world;
        key.morton = spread_bits(step(at.x - low_x)) | spread_bits(step(at.z - low_z)) << 1;
    }
    std::sort(keys.begin(), keys.end());
    return keys;
}

// Where to cut sorted keys [first, last): at the quarters of the smallest square that holds them, or, in one place, into
// equal shares. 2 to 8 ranges, by their ends. Requires two keys.
std::vector<size_t> cut_range(const std::vector<Key>& keys, size_t first, size_t last) {
    std::vector<size_t> ends;
    const uint64_t differing = keys[first].morton ^ keys[last - 1].morton;
    if (differing == 0) {
        const size_t count = std::min(last - first, k_most_children);
        for (size_t i = 1; i <= count; ++i) ends.push_back(first + (last - first) * i / count);
        return ends;
    }
    const uint32_t shift = uint32_t(std::bit_width(differing) - 1) & ~1u;
    for (size_t i = first + 1; i < last; ++i)
        if (keys[i].morton >> shift != keys[i - 1].morton >> shift) ends.push_back(i);
    ends.push_back(last);
    return ends;
}

// As tiles' origins are: differences of origins then are exact.
dvec3 round_sixteenth(dvec3 p) {
    return dvec3(std::floor(p.x * 16.0 + 0.5), std::floor(p.y * 16.0 + 0.5), std::floor(p.z * 16.0 + 0.5)) *
           0.0625;
}

void fill_leaf(const Scene& scene, std::span<const Plant> plants, TileNode& node) {
    const SceneTile& tile = scene.tiles[node.tile];
    node.origin_world = tile.tile.origin_world;
    node.bounds_tile = tile.tile.bounds_tile;
    if (node.bounds_tile.empty()) node.bounds_tile = {vec3(0.0f), vec3(0.0f)};
    node.plant_count = tile.plant_count;
    auto rows = [&tile](const auto& column) {
        return std::span(column).subspan(tile.first_plant, tile.plant_count);
    };
    node.cloud = gather_cloud(rows(scene.positions), rows(scene.turns), rows(scene.plant_models), plants);
}

void fill_parent(std::span<const TileNode> children, TileNode& node) {
    dvec3 low(INFINITY), high(-INFINITY);
    for (const TileNode& child : children) {
        low = glm::min(low, child.origin_world + dvec3(child.bounds_tile.min));
        high = glm::max(high, child.origin_world + dvec3(child.bounds_tile.max));
    }
    node.origin_world = round_sixteenth((low + high) * 0.5);
    // A float's rounding must not let a plant stick out.
    const vec3 reach = vec3(glm::max(high - node.origin_world, node.origin_world - low));
    const vec3 margin = reach * 0x1p-22f;
    node.bounds_tile = {vec3(low - node.origin_world) - margin, vec3(high - node.origin_world) + margin};

    std::vector<const TileCloud*> clouds;
    std::vector<vec3> offsets_m;
    uint64_t plant_count = 0;
    for (const TileNode& child : children) {
        clouds.push_back(&child.cloud);
        offsets_m.push_back(vec3(child.origin_world - node.origin_world));
        plant_count += child.plant_count;
    }
    node.plant_count = uint32_t(std::min<uint64_t>(plant_count, UINT32_MAX));
    node.cloud = merge_clouds(clouds, offsets_m);
}

}  // namespace

std::vector<TileNode> build_tile_tree(const Scene& scene, std::span<const Plant> plants) {
    const std::vector<Key> keys = sort_along_curve(scene);
    std::vector<TileNode> nodes;
    if (keys.empty()) return nodes;

    // Breadth first, so that children follow each other and a level is a range of nodes.
    struct Range {
        size_t first, last;
    };
    std::vector<Range> range_of_node{{0, keys.size()}};
    std::vector<size_t> level_begin{0};
    nodes.emplace_back();
    while (level_begin.back() < nodes.size()) {
        const size_t level_end = nodes.size();
        for (size_t n = level_begin.back(); n < level_end; ++n) {
            const Range range = range_of_node[n];
            if (range.last - range.first == 1) {
                nodes[n].tile = keys[range.first].tile;
                continue;
            }
            nodes[n].first_child = uint32_t(nodes.size());
            size_t first = range.first;
            for (size_t end : cut_range(keys, range.first, range.last)) {
                range_of_node.push_back({first, end});
                nodes.emplace_back();
                first = end;
            }
            nodes[n].child_count = uint32_t(nodes.size()) - nodes[n].first_child;
        }
        level_begin.push_back(level_end);
    }

    for (size_t level = level_begin.size() - 1; level-- > 0;)
        parallel_for(level_begin[level + 1] - level_begin[level], 1, [&](size_t first, size_t last) {
            for (size_t n = level_begin[level] + first; n < level_begin[level] + last; ++n)
                if (nodes[n].child_count == 0)
                    fill_leaf(scene, plants, nodes[n]);
                else
                    fill_parent(std::span(nodes).subspan(nodes[n].first_child, nodes[n].child_count),
                                nodes[n]);
        });
    return nodes;
}

}  // namespace coppice
