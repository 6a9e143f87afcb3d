// A scene's file with all files it refers to, directly or not, each read once, and each model named once.
#pragma once
#include <vector>
#include "plugins/vegetation/eco/file_chain.h"
#include "plugins/vegetation/eco/scene_file.h"

namespace coppice {

struct SceneNode {
    SceneFile file;                                   // references that bring no plant are left out
    std::vector<uint32_t> children;                   // nodes, one a reference
    std::vector<uint32_t> models;                     // of the file -> of the tree
    uint64_t plant_count = 0;                         // the file's own, and all copies of its references
    uint32_t depth = 0;                               // the longest chain of references below
    double reach_m = 0.0;                             // no plant stands farther from the file's origin
    double scale_least = INFINITY, scale_most = 0.0;  // of its plants, all scales multiplied
};

struct SceneTree {
    std::vector<SceneNode> nodes;    // children before those who refer to them; the root is the last
    std::vector<SceneModel> models;  // the root's first, as they are
    const SceneNode& root() const { return nodes.back(); }
};

// After it, the number of plants is at most k_plant_limit, and every place and scale is in range. Files are known by where
// they lie, whatever name leads there. Errors: read_scene_file's, of a file that cannot be read with the place that names
// it; value_out_of_range for a file that comes to stand in itself (the fault is the way round) and for places and scales
// out of range; limit_exceeded for too many plants or models, and for chains of more than k_reference_depth_limit.
Result<SceneTree> read_scene_tree(const std::string& path, const SceneLoadSettings& settings);

}  // namespace coppice
