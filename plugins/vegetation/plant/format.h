// The head of a .plant file, shared by pack.cpp and load.cpp. Little-endian. Every byte of the file is
// covered by a checksum: the head by its own, everything else by the checksum of the block it belongs to,
// padding included.
#pragma once
#include <bit>
#include <cstdint>

namespace coppice {

static_assert(std::endian::native == std::endian::little, "packed plants are used in place");

inline constexpr char k_plant_magic[4] = {'C', 'P', 'L', 'T'};
inline constexpr uint32_t k_plant_version = 4;
inline constexpr uint64_t k_plant_block_alignment = 64;

enum PlantBlock : uint32_t {
    k_block_parts,
    k_block_triangle_vertices,
    k_block_points,
    k_block_point_owners,
    k_block_line_vertices,
    k_block_cells,
    k_block_crowns,
    k_block_leaves,
    k_block_count
};

struct PlantBlockPlace {
    uint64_t offset_bytes;  // multiple of 64; blocks follow each other in the order above without gaps
    uint64_t item_count;
    uint64_t checksum;  // XXH3-64 of the items and the zeros behind them up to the next multiple of 64
};

struct PlantFileHead {
    char magic[4];
    uint32_t version;
    uint64_t file_bytes;
    uint64_t head_checksum;  // XXH3-64 of the head with this field zero: names the content of the whole file
    char name[64];           // UTF-8, zero-terminated
    float bounds_min[3], bounds_max[3];
    uint32_t dropped_triangles, dropped_vertices;
    uint32_t reserved[6];
    PlantBlockPlace blocks[k_block_count];
    uint64_t reserved_end[6];
};
static_assert(sizeof(PlantFileHead) == 6 * 64);

inline constexpr uint64_t padded_to_block(uint64_t bytes) {
    return (bytes + k_plant_block_alignment - 1) / k_plant_block_alignment * k_plant_block_alignment;
}

}  // namespace coppice
