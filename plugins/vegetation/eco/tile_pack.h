// A tile tree as a file larger than memory: the tree is read when it is opened, clouds and plants one block at a time.
// Little-endian: a head, the models, the nodes (each with a checksum, XXH3-64), then for every node in order its cloud
// and, in a leaf, its plants, each a zstd frame with a checksum of its own. Everything starts at a multiple of 64
// bytes, and every byte is covered by a checksum. write_tile_pack.cpp writes, tile_pack.cpp reads, tile_format.h has the head.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/eco/tile_tree.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/open_file.h"

namespace coppice {

// Of the format, and of what build_tile_tree makes of a scene: packs of another version are made again.
inline constexpr uint32_t k_tiles_version = 3;
inline constexpr uint32_t k_tiles_node_limit = 1u << 22;  // of a pack
inline constexpr uint32_t k_tiles_item_limit = 1u << 20;  // points of a cloud, plants of a leaf
// Of coordinates from a tile's origin, and of origins; the earth's circumference is 4e7 m.
inline constexpr float k_tile_reach_m = 4e7f;
inline constexpr double k_origin_reach_m = 4e9;

struct TileBlockPlace {
    uint64_t offset_bytes;  // multiple of 64
    uint32_t stored_bytes;  // compressed, without the zeros up to the next multiple of 64
    uint32_t item_count;    // points, or plants; 0: nothing is stored
    uint64_t checksum;      // of what is stored and the zeros behind it
};

// 384 bytes.
struct PackedTileNode {
    double origin_world[3];
    float bounds_min[3], bounds_max[3];  // relative to the origin, of all plants below at full size
    uint32_t first_child, child_count;   // nodes, behind this one; none: a leaf
    uint64_t plant_count;                // of all below
    uint64_t triangle_count;             // of all plants below, at full detail
    float finest_density;                // the cloud suffices up to (pixels a metre / d')^2
    uint32_t reserved;                   // 0
    // Points in the order they are drawn, then their densities, then the areas exhausted and the density up to which few
    // are: all that drawing and merging it takes beside the part.
    TileBlockPlace cloud;
    TileBlockPlace plants;  // positions, then turns, then models; of a leaf
    PackedPart cloud_part;  // all zero where the cloud is empty
};
static_assert(sizeof(PackedTileNode) == 384);

// What the plants' model indices mean.
struct TileModel {
    std::string name;
    std::string
        source_path;  // as in Scene::models when it was written: of a populated scene, relative to its folder
    uint64_t content_hash = 0;  // Plant::content_hash
    float importance = 1.0f;
};

struct TilePack {
    std::string path;
    uint64_t key = 0;           // of what it was made from, as the writer was told
    uint64_t content_hash = 0;  // of the head, which holds the checksums of the rest
    std::vector<TileModel> models;
    std::vector<PackedTileNode> nodes;  // a tree; the root is node 0; none where there is no plant
    std::shared_ptr<const OpenFile> file;
};

struct TilePlants {
    std::vector<PlantPosition> positions;
    std::vector<PlantTurn> turns;
    std::vector<PlantModel> models;
};

enum class TileBlockKind : uint32_t { cloud, plants };

inline const TileBlockPlace& block_of(const PackedTileNode& node, TileBlockKind kind) {
    return kind == TileBlockKind::cloud ? node.cloud : node.plants;
}
// Decompressed; 0 where nothing is stored.
inline constexpr uint64_t bytes_of_block(TileBlockKind kind, uint64_t item_count) {
    if (kind == TileBlockKind::plants)
        return item_count * (sizeof(PlantPosition) + sizeof(PlantTurn) + sizeof(PlantModel));
    return item_count
               ? item_count * (sizeof(PackedVertex) + sizeof(float)) + (k_density_steps + 1) * sizeof(float)
               : 0;
}
inline uint64_t bytes_of_block(const PackedTileNode& node, TileBlockKind kind) {
    return bytes_of_block(kind, block_of(node, kind).item_count);
}

// nodes: of build_tile_tree(scene, plants). Replaces the file completely or leaves the old one as it was. Same input, same
// bytes, on any number of threads. Errors: write_failed; value_out_of_range for what could not be read again;
// limit_exceeded.
Status write_tile_pack(const std::string& path, std::span<const TileNode> nodes, const Scene& scene,
                       std::span<const Plant> plants, uint64_t key);

// All but the blocks is checked: head, places (blocks follow each other without gaps up to the end), that the nodes are one
// tree with sums that are right, finite numbers. Errors: file_*, format_unknown, value_out_of_range, limit_exceeded.
Result<TilePack> open_tile_pack(const std::string& path);

// From any thread. Positions are finite and within k_tile_reach_m; densities finite, not negative and ascending, and
// those the node tells; areas finite and not negative. Nothing is read where nothing is stored, and a cloud without points
// has no part. Errors: file_*, value_out_of_range; the place names node and block.
Result<TileCloud> read_cloud(const TilePack& pack, uint32_t node);
// Scales are in (0, 1e5], turns of about unit length, models known.
Result<TilePlants> read_plants(const TilePack& pack, uint32_t node);
// Reads every block, for who keeps a pack instead of making it again. The first error in the file's order.
Status check_blocks(const TilePack& pack);

}  // namespace coppice
