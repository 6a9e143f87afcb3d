#include <cstring>
#include "plugins/vegetation/plant/format.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/hash.h"
#include "tests/hostile/seal.h"

namespace coppice::hostile {
namespace {

constexpr uint64_t k_plant_item_bytes[k_block_count] = {
    sizeof(PackedPart),   sizeof(PackedVertex), sizeof(PackedVertex), sizeof(uint32_t),
    sizeof(PackedVertex), sizeof(PackedPart),   sizeof(PackedCrown),  sizeof(PackedLeaf)};

}  // namespace

void seal_plant(Bytes& bytes) {
    PlantFileHead head;
    if (bytes.size() < sizeof head) return;
    std::memcpy(&head, bytes.data(), sizeof head);
    head.file_bytes = bytes.size();
    for (uint32_t block = 0; block < k_block_count; ++block) {
        PlantBlockPlace& place = head.blocks[block];
        if (place.item_count > bytes.size()) continue;
        place.checksum = hash_range(bytes, place.offset_bytes,
                                    padded_to_block(place.item_count * k_plant_item_bytes[block]));
    }
    head.head_checksum = 0;
    head.head_checksum = hash_bytes(&head, sizeof head);
    std::memcpy(bytes.data(), &head, sizeof head);
}

}  // namespace coppice::hostile
