// The hierarchy over a scene's tiles, each node with a cloud that stands for all the plants below it.
#pragma once
#include "plugins/vegetation/eco/make_cloud.h"
#include "plugins/vegetation/eco/scene.h"

namespace coppice {

struct TileNode {
    dvec3 origin_world;
    Box bounds_tile;                            // relative to the origin, of all plants below at full size
    uint32_t first_child = 0, child_count = 0;  // nodes; none: a leaf
    uint32_t tile = UINT32_MAX;                 // of a leaf: index into Scene::tiles
    uint32_t plant_count = 0;                   // of all below
    TileCloud cloud;
};

// After finish_tiles; plants[i] is the packed plant of scene.models[i]. The root is node 0 (none where there is no plant);
// a node's 2 to 8 children lie beside each other on the ground and follow each other here. Same nodes on any number of
// threads.
std::vector<TileNode> build_tile_tree(const Scene& scene, std::span<const Plant> plants);

}  // namespace coppice
