// A mosaic's file with all files below it, each known once, however often and by whatever names it stands.
#pragma once
#include <string>
#include <vector>
#include "plugins/vegetation/eco/mosaic.h"

namespace coppice {

struct MosaicNode {
    std::string path;
    // Where it is populated, inside the root's: its name, and a hash of where it lies seen from the root; of the root "".
    std::string folder;
    MosaicFile file;               // without places: a scene with plants of its own, which is not read here
    std::vector<uint32_t> scenes;  // nodes, one a place
    uint64_t scene_count = 1;      // with plants of their own that stand in it, all copies counted
    double reach_m = 0.0;          // no origin of a scene in it lies farther from its own
    uint32_t depth = 0;            // the longest chain of mosaics below
};

struct MosaicTree {
    std::vector<MosaicNode> nodes;  // those below before those who name them; the root is the last
    const MosaicNode& root() const { return nodes.back(); }
};

// Camera keys above the ground are read as if it were the plane y = 0. Errors: read_mosaic_file's, of a file that cannot be
// read with the place that names it; value_out_of_range for a file that comes to stand in itself (the fault is the way
// round) and for places out of reach; limit_exceeded for chains of more than k_reference_depth_limit, and where scenes
// cannot be counted any more.
Result<MosaicTree> read_mosaic_tree(const std::string& path);

// sum += a * b; false where that is more than 64 bits hold.
bool add_product(uint64_t& sum, uint64_t a, uint64_t b);

}  // namespace coppice
