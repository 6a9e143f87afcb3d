#include "plugins/vegetation/eco/tile_tree.h"

#include <algorithm>
#include "plugins/vegetation/eco/group_places.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

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
    std::vector<dvec3> origins;
    std::vector<Box> bounds;
    for (const TileNode& child : children) {
        origins.push_back(child.origin_world);
        bounds.push_back(child.bounds_tile);
    }
    const JoinedSpace space = join_spaces(origins, bounds);
    node.origin_world = space.origin;
    node.bounds_tile = space.bounds;

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
    std::vector<dvec3> origins;
    std::vector<uint32_t> tiles;
    for (uint32_t t = 0; t < scene.tiles.size(); ++t) {
        if (scene.tiles[t].plant_count == 0) continue;
        origins.push_back(scene.tiles[t].tile.origin_world);
        tiles.push_back(t);
    }
    const Groups groups = group_places(origins);
    std::vector<TileNode> nodes(groups.nodes.size());
    for (size_t n = 0; n < nodes.size(); ++n) {
        nodes[n].first_child = groups.nodes[n].first_child;
        nodes[n].child_count = groups.nodes[n].child_count;
        if (nodes[n].child_count == 0) nodes[n].tile = tiles[groups.nodes[n].place];
    }
    for (size_t level = groups.level_begin.size() - 1; level-- > 0;)
        parallel_for(
            groups.level_begin[level + 1] - groups.level_begin[level], 1, [&](size_t first, size_t last) {
                for (size_t i = first; i < last; ++i) {
                    TileNode& node = nodes[groups.level_begin[level] + i];
                    if (node.child_count == 0)
                        fill_leaf(scene, plants, node);
                    else
                        fill_parent(std::span(nodes).subspan(node.first_child, node.child_count), node);
                }
            });
    return nodes;
}

}  // namespace coppice
