// What write_tile_pack.cpp and tile_pack.cpp must agree on, and the checks that both make: nothing is written that could
// not be read again.
#pragma once
#include <bit>
#include <string>
#include "plugins/vegetation/eco/tile_pack.h"

namespace coppice {

static_assert(std::endian::native == std::endian::little, "tile packs are little-endian");

inline constexpr char k_tiles_magic[4] = {'C', 'T', 'I', 'L'};
inline constexpr uint64_t k_tiles_alignment = 64;
inline constexpr uint32_t k_tiles_model_limit = 65536;
inline constexpr uint64_t k_tiles_models_bytes_limit = 1u << 26;

struct TilesHead {
    char magic[4];
    uint32_t version;
    uint64_t file_bytes;
    uint64_t head_checksum;  // of the head with this field zero
    uint64_t key;
    uint32_t model_count, node_count;
    uint64_t models_bytes;     // behind the head; without the zeros up to the next multiple of 64
    uint64_t models_checksum;  // with them
    uint64_t nodes_checksum;   // node_count PackedTileNode, behind the models
};
static_assert(sizeof(TilesHead) == 64 && sizeof(PackedTileNode) % k_tiles_alignment == 0);

// Behind each the name, then the path, neither with a zero; the next one follows at once.
struct TilesModelHead {
    uint64_t content_hash;
    float importance;
    uint32_t name_bytes, path_bytes;
    uint32_t reserved;  // 0
};
static_assert(sizeof(TilesModelHead) == 24);

inline constexpr uint64_t padded_to_tile_block(uint64_t bytes) {
    return (bytes + k_tiles_alignment - 1) / k_tiles_alignment * k_tiles_alignment;
}

// Null where the nodes are one tree, with sums and numbers that can be used; else what is wrong, and of which node. Places
// are not looked at.
struct NodeFault {
    size_t node = 0;
    const char* fault = nullptr;
};
NodeFault fault_of_nodes(std::span<const PackedTileNode> nodes);

// Null where they can be used.
const char* fault_of_contents(const TileCloud& cloud);
const char* fault_of_plants(std::span<const PlantPosition> positions, std::span<const PlantTurn> turns,
                            std::span<const PlantModel> models, size_t model_count);

// "node 17, cloud"
std::string place_of_block(size_t node, TileBlockKind kind);

}  // namespace coppice
