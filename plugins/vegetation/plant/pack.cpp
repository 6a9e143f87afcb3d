#include "plugins/vegetation/plant/pack.h"

#include <cassert>
#include <cstring>
#include "plugins/vegetation/plant/format.h"
#include "runtime/core/hash.h"

namespace coppice {

void copy_name(std::string_view text, char* field, size_t field_bytes) {
    text = text.substr(0, text.find('\0'));
    size_t length = text.size();
    if (length > field_bytes - 1) {
        length = field_bytes - 1;
        while (length > 0 && (uint8_t(text[length]) & 0xc0u) == 0x80u) --length;
    }
    std::memset(field, 0, field_bytes);
    std::memcpy(field, text.data(), length);
}

std::vector<std::byte> pack_plant(const PlantBlocks& plant) {
    assert(plant.points.size() == plant.point_owners.size() && "every point has an owner");
    PlantFileHead head{};
    std::memcpy(head.magic, k_plant_magic, sizeof head.magic);
    head.version = k_plant_version;
    copy_name(plant.name, head.name, sizeof head.name);
    for (int axis = 0; axis < 3; ++axis) {
        head.bounds_min[axis] = plant.bounds_plant.min[axis];
        head.bounds_max[axis] = plant.bounds_plant.max[axis];
    }
    head.dropped_triangles = plant.dropped_triangles;
    head.dropped_vertices = plant.dropped_vertices;

    struct Source {
        const void* items;
        uint64_t item_count, item_bytes;
    };
    const Source sources[k_block_count] = {
        {plant.parts.data(), plant.parts.size(), sizeof(PackedPart)},
        {plant.triangle_vertices.data(), plant.triangle_vertices.size(), sizeof(PackedVertex)},
        {plant.points.data(), plant.points.size(), sizeof(PackedVertex)},
        {plant.point_owners.data(), plant.point_owners.size(), sizeof(uint32_t)},
        {plant.line_vertices.data(), plant.line_vertices.size(), sizeof(PackedVertex)},
        {plant.cells.data(), plant.cells.size(), sizeof(PackedPart)},
        {plant.crowns.data(), plant.crowns.size(), sizeof(PackedCrown)},
        {plant.leaves.data(), plant.leaves.size(), sizeof(PackedLeaf)},
    };
    head.file_bytes = sizeof head;
    for (uint32_t b = 0; b < k_block_count; ++b) {
        head.blocks[b].offset_bytes = head.file_bytes;
        head.blocks[b].item_count = sources[b].item_count;
        head.file_bytes += padded_to_block(sources[b].item_count * sources[b].item_bytes);
    }
    std::vector<std::byte> bytes(head.file_bytes);
    for (uint32_t b = 0; b < k_block_count; ++b) {
        std::byte* block = bytes.data() + head.blocks[b].offset_bytes;
        uint64_t item_bytes = sources[b].item_count * sources[b].item_bytes;
        if (item_bytes) std::memcpy(block, sources[b].items, item_bytes);
        head.blocks[b].checksum = hash_bytes(block, padded_to_block(item_bytes));
    }
    head.head_checksum = hash_bytes(&head, sizeof head);
    std::memcpy(bytes.data(), &head, sizeof head);
    return bytes;
}

}  // namespace coppice
