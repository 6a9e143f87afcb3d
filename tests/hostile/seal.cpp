#include "tests/hostile/seal.h"

#include <algorithm>
#include <cstring>
#include "plugins/vegetation/eco/tile_format.h"
#include "runtime/core/hash.h"

namespace coppice::hostile {

uint64_t hash_range(const Bytes& bytes, uint64_t offset, uint64_t count) {
    if (offset > bytes.size() || count > bytes.size() - offset) return 0;
    return hash_bytes(bytes.data() + offset, size_t(count));
}
void seal_placed(Bytes& bytes) {
    if (bytes.size() < sizeof(uint64_t)) return;
    const size_t hashed = bytes.size() - sizeof(uint64_t);
    const uint64_t hash = hash_text({reinterpret_cast<const char*>(bytes.data()), hashed});
    std::memcpy(bytes.data() + hashed, &hash, sizeof hash);
}

void seal_tiles(Bytes& bytes) {
    TilesHead head;
    if (bytes.size() < sizeof head) return;
    std::memcpy(&head, bytes.data(), sizeof head);
    head.file_bytes = bytes.size();
    const uint64_t models_bytes = padded_to_tile_block(std::min<uint64_t>(head.models_bytes, bytes.size()));
    head.models_checksum = hash_range(bytes, sizeof head, models_bytes);
    const uint64_t nodes_offset = sizeof head + models_bytes,
                   nodes_bytes = uint64_t(head.node_count) * sizeof(PackedTileNode);
    if (nodes_offset <= bytes.size() && nodes_bytes <= bytes.size() - nodes_offset)
        for (uint64_t n = 0; n < head.node_count; ++n) {
            PackedTileNode node;
            std::byte* place_of_node = bytes.data() + nodes_offset + n * sizeof node;
            std::memcpy(&node, place_of_node, sizeof node);
            for (TileBlockPlace* place : {&node.cloud, &node.plants})
                if (place->item_count > 0)
                    place->checksum =
                        hash_range(bytes, place->offset_bytes, padded_to_tile_block(place->stored_bytes));
            std::memcpy(place_of_node, &node, sizeof node);
        }
    head.nodes_checksum = hash_range(bytes, nodes_offset, nodes_bytes);
    head.head_checksum = 0;
    head.head_checksum = hash_bytes(&head, sizeof head);
    std::memcpy(bytes.data(), &head, sizeof head);
}

// The head's fields: columns at byte 16, rows at 20, the checksum at 8 (ground_file.cpp).
void seal_ground(Bytes& bytes) {
    constexpr size_t k_head_bytes = 64, k_checksum_at = 8;
    if (bytes.size() < k_head_bytes) return;
    uint32_t columns, rows;
    std::memcpy(&columns, bytes.data() + 16, 4);
    std::memcpy(&rows, bytes.data() + 20, 4);
    uint64_t checksum = 0;
    std::memcpy(bytes.data() + k_checksum_at, &checksum, 8);
    const size_t heights_bytes =
        size_t(std::min<uint64_t>(4 * uint64_t(columns) * rows, bytes.size() - k_head_bytes));
    checksum = hash_bytes(bytes.data(), k_head_bytes);
    checksum = hash_bytes(bytes.data() + k_head_bytes, heights_bytes, checksum);
    checksum = hash_bytes(bytes.data() + k_head_bytes + heights_bytes,
                          bytes.size() - k_head_bytes - heights_bytes, checksum);
    std::memcpy(bytes.data() + k_checksum_at, &checksum, 8);
}

}  // namespace coppice::hostile
