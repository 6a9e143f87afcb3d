#include "plugins/vegetation/eco/tile_pack.h"

#include <cassert>
#include <cstring>
#include <zstd.h>
#include "plugins/vegetation/eco/tile_format.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr int k_compression_level = 9;
constexpr const char* k_remedy =
    "such a scene cannot be packed: look for plants that are far out or very large";

using Bytes = std::vector<std::byte>;

template <class T>
void append(Bytes& bytes, std::span<const T> items) {
    const auto more = std::as_bytes(items);
    bytes.insert(bytes.end(), more.begin(), more.end());
}

// One frame with its size in it, and zeros up to the alignment.
Bytes compress(const Bytes& items, TileBlockPlace& place) {
    Bytes stored(ZSTD_compressBound(items.size()));
    const size_t size =
        ZSTD_compress(stored.data(), stored.size(), items.data(), items.size(), k_compression_level);
    assert(!ZSTD_isError(size) && "the bound is enough");
    place.stored_bytes = uint32_t(size);
    stored.resize(size);
    stored.resize(padded_to_tile_block(size));
    place.checksum = hash_bytes(stored.data(), stored.size());
    return stored;
}

struct Source {
    const Scene& scene;
    std::span<const TileNode> nodes;
    std::span<const uint64_t> triangles_of_model;
};

struct NodeBlocks {
    Bytes cloud, plants;
    const char* fault = nullptr;
    TileBlockKind faulty = TileBlockKind::cloud;
};

void pack_cloud(const TileCloud& cloud, PackedTileNode& packed, NodeBlocks& blocks) {
    if (cloud.points.empty()) return;
    packed.cloud.item_count = uint32_t(cloud.points.size());
    packed.cloud_part = cloud.part;
    packed.finest_density = cloud.finest_density();
    if (const char* fault = fault_of_contents(cloud)) {
        blocks.fault = fault;
        return;
    }
    Bytes items;
    append<PackedVertex>(items, cloud.points);
    append<float>(items, cloud.densities);
    append<float>(items, cloud.exhausted_area_m2);
    append(items, std::span(&cloud.exhausted_density, 1));
    blocks.cloud = compress(items, packed.cloud);
}

void pack_plants(const Source& source, uint32_t tile_index, PackedTileNode& packed, NodeBlocks& blocks) {
    const SceneTile& tile = source.scene.tiles[tile_index];
    auto rows = [&tile](const auto& column) {
        return std::span(column).subspan(tile.first_plant, tile.plant_count);
    };
    const auto positions = rows(source.scene.positions);
    const auto turns = rows(source.scene.turns);
    const auto models = rows(source.scene.plant_models);
    packed.plants.item_count = tile.plant_count;
    if (const char* fault = fault_of_plants(positions, turns, models, source.scene.models.size())) {
        blocks.fault = fault;
        blocks.faulty = TileBlockKind::plants;
        return;
    }
    Bytes items;
    append(items, positions);
    append(items, turns);
    append(items, models);
    blocks.plants = compress(items, packed.plants);
    for (const PlantModel& model : models) packed.triangle_count += source.triangles_of_model[model.model];
}

NodeBlocks pack_node(const Source& source, const TileNode& node, PackedTileNode& packed) {
    packed = {};
    for (int axis = 0; axis < 3; ++axis) {
        packed.origin_world[axis] = node.origin_world[axis];
        packed.bounds_min[axis] = node.bounds_tile.min[axis];
        packed.bounds_max[axis] = node.bounds_tile.max[axis];
    }
    packed.child_count = node.child_count;
    packed.first_child = node.child_count ? node.first_child : 0;
    packed.plant_count = node.plant_count;
    NodeBlocks blocks;
    pack_cloud(node.cloud, packed, blocks);
    if (node.child_count == 0 && !blocks.fault) pack_plants(source, node.tile, packed, blocks);
    return blocks;
}

// Children stand behind their parents.
void sum_up(std::vector<PackedTileNode>& nodes) {
    for (size_t n = nodes.size(); n-- > 0;) {
        if (nodes[n].child_count == 0) continue;
        nodes[n].plant_count = 0;
        for (uint32_t c = 0; c < nodes[n].child_count; ++c) {
            nodes[n].plant_count += nodes[nodes[n].first_child + c].plant_count;
            nodes[n].triangle_count += nodes[nodes[n].first_child + c].triangle_count;
        }
    }
}

Bytes pack_models(const Scene& scene, std::span<const Plant> plants) {
    Bytes bytes;
    for (size_t m = 0; m < scene.models.size(); ++m) {
        const SceneModel& model = scene.models[m];
        const TilesModelHead head{plants[m].content_hash, model.importance, uint32_t(model.name.size()),
                                  uint32_t(model.source_path.size()), 0};
        append(bytes, std::span(&head, 1));
        append(bytes, std::span(model.name));
        append(bytes, std::span(model.source_path));
    }
    return bytes;
}

}  // namespace

Status write_tile_pack(const std::string& path, std::span<const TileNode> nodes, const Scene& scene,
                       std::span<const Plant> plants, uint64_t key) {
    assert(plants.size() == scene.models.size());
    if (nodes.size() > k_tiles_node_limit || scene.models.size() > k_tiles_model_limit)
        return fail(
            ErrorId::limit_exceeded, path, "",
            std::to_string(nodes.size()) + " tiles of " + std::to_string(scene.models.size()) + " models",
            "at most " + std::to_string(k_tiles_node_limit) + " tiles of " +
                std::to_string(k_tiles_model_limit) + " models in one pack");
    std::vector<uint64_t> triangles_of_model;
    for (const Plant& plant : plants) triangles_of_model.push_back(plant.triangle_vertices.size() / 3);
    const Source source{scene, nodes, triangles_of_model};
    std::vector<PackedTileNode> packed(nodes.size());
    std::vector<NodeBlocks> blocks(nodes.size());
    parallel_for(nodes.size(), 4, [&](size_t first, size_t last) {
        for (size_t n = first; n < last; ++n) blocks[n] = pack_node(source, nodes[n], packed[n]);
    });
    sum_up(packed);

    Bytes models = pack_models(scene, plants);
    if (models.size() > k_tiles_models_bytes_limit)
        return fail(ErrorId::limit_exceeded, path, "models",
                    std::to_string(models.size()) + " bytes of names",
                    "shorter names: at most " + std::to_string(k_tiles_models_bytes_limit) + " bytes");
    TilesHead head{};
    std::memcpy(head.magic, k_tiles_magic, sizeof head.magic);
    head.version = k_tiles_version;
    head.key = key;
    head.model_count = uint32_t(scene.models.size());
    head.node_count = uint32_t(packed.size());
    head.models_bytes = models.size();
    models.resize(padded_to_tile_block(models.size()));
    head.models_checksum = hash_bytes(models.data(), models.size());
    head.file_bytes = sizeof head + models.size() + packed.size() * sizeof(PackedTileNode);
    std::vector<std::span<const std::byte>> pieces{std::as_bytes(std::span(&head, 1)), models,
                                                   std::as_bytes(std::span(packed))};
    for (size_t n = 0; n < packed.size(); ++n) {
        if (blocks[n].fault)
            return fail(ErrorId::value_out_of_range, path, place_of_block(n, blocks[n].faulty),
                        blocks[n].fault, k_remedy);
        packed[n].cloud.offset_bytes = head.file_bytes;
        head.file_bytes += blocks[n].cloud.size();
        packed[n].plants.offset_bytes = head.file_bytes;
        head.file_bytes += blocks[n].plants.size();
        pieces.push_back(blocks[n].cloud);
        pieces.push_back(blocks[n].plants);
    }
    if (const NodeFault wrong = fault_of_nodes(packed); wrong.fault)
        return fail(ErrorId::value_out_of_range, path, "node " + std::to_string(wrong.node), wrong.fault,
                    k_remedy);
    head.nodes_checksum = hash_bytes(packed.data(), packed.size() * sizeof(PackedTileNode));
    head.head_checksum = hash_bytes(&head, sizeof head);
    return write_file_pieces(path, pieces);
}

}  // namespace coppice
