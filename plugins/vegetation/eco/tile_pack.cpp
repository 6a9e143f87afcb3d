#include "plugins/vegetation/eco/tile_pack.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <zstd.h>
#include "plugins/vegetation/eco/tile_format.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr const char* k_remedy = "packed tiles are a cache: populate the scene again";

Result<TilesHead> read_head(const OpenFile& file) {
    TilesHead head{};
    const size_t present = size_t(std::min<uint64_t>(file.size_bytes(), sizeof head));
    COPPICE_CHECK(file.read(0, std::as_writable_bytes(std::span(&head, 1)).first(present)));
    if (present < sizeof head.magic || std::memcmp(head.magic, k_tiles_magic, sizeof head.magic) != 0)
        return fail(ErrorId::format_unknown, file.path(), "byte 0", "not packed tiles", "name a .tiles file");
    if (present < sizeof head)
        return fail(ErrorId::file_truncated, file.path(), "head", "it ends inside its head", k_remedy);
    if (head.version != k_tiles_version)
        return fail(
            ErrorId::format_unknown, file.path(), "byte 4", "version " + std::to_string(head.version),
            "this program reads version " + std::to_string(k_tiles_version) + "; populate the scene again");
    TilesHead without_checksum = head;
    without_checksum.head_checksum = 0;
    if (hash_bytes(&without_checksum, sizeof head) != head.head_checksum)
        return fail(ErrorId::file_corrupt, file.path(), "head", "its checksum is wrong", k_remedy);
    if (head.file_bytes != file.size_bytes())
        return fail(file.size_bytes() < head.file_bytes ? ErrorId::file_truncated : ErrorId::file_corrupt,
                    file.path(), "head",
                    "it has " + std::to_string(file.size_bytes()) + " bytes and announces " +
                        std::to_string(head.file_bytes),
                    k_remedy);
    if (head.node_count > k_tiles_node_limit || head.model_count > k_tiles_model_limit ||
        head.models_bytes > k_tiles_models_bytes_limit)
        return fail(
            ErrorId::limit_exceeded, file.path(), "head",
            std::to_string(head.node_count) + " tiles of " + std::to_string(head.model_count) + " models",
            "more than this program reads");
    return head;
}

// Null where `bytes` is one model behind the other and zeros behind the last.
const char* parse_models(std::span<const std::byte> bytes, const TilesHead& head,
                         std::vector<TileModel>& models) {
    auto padding = bytes.subspan(head.models_bytes);
    if (std::any_of(padding.begin(), padding.end(), [](std::byte b) { return b != std::byte(0); }))
        return "bytes behind the last model";
    bytes = bytes.first(head.models_bytes);
    auto take_text = [&bytes](uint32_t count) {
        std::string text(reinterpret_cast<const char*>(bytes.data()), count);
        bytes = bytes.subspan(count);
        return text;
    };
    for (uint32_t m = 0; m < head.model_count; ++m) {
        TilesModelHead model;
        if (bytes.size() < sizeof model) return "models that do not fit";
        std::memcpy(&model, bytes.data(), sizeof model);
        bytes = bytes.subspan(sizeof model);
        if (uint64_t(model.name_bytes) + model.path_bytes > bytes.size()) return "names that do not fit";
        if (!(model.importance > 0.0f) || !std::isfinite(model.importance))
            return "an importance that is not positive";
        if (model.reserved != 0) return "bytes of no meaning";
        TileModel& taken = models.emplace_back();
        taken.name = take_text(model.name_bytes);
        taken.source_path = take_text(model.path_bytes);
        taken.content_hash = model.content_hash;
        taken.importance = model.importance;
        if (taken.name.find('\0') != std::string::npos || taken.source_path.find('\0') != std::string::npos)
            return "a zero in a name";
    }
    return bytes.empty() ? nullptr : "bytes behind the last model";
}

// Blocks follow each other without gaps, so none can lie outside the file or inside another.
Status check_places(const TilePack& pack, uint64_t offset_bytes) {
    for (size_t n = 0; n < pack.nodes.size(); ++n)
        for (TileBlockKind kind : {TileBlockKind::cloud, TileBlockKind::plants}) {
            const TileBlockPlace& place = block_of(pack.nodes[n], kind);
            const uint64_t stored_bytes = padded_to_tile_block(place.stored_bytes);
            if (place.offset_bytes != offset_bytes || stored_bytes > pack.file->size_bytes() - offset_bytes)
                return fail(ErrorId::file_corrupt, pack.path, place_of_block(n, kind),
                            "the block does not follow the one before, or lies outside the file", k_remedy);
            const uint64_t most_bytes =
                place.item_count ? ZSTD_compressBound(bytes_of_block(kind, place.item_count)) : 0;
            if (place.stored_bytes > most_bytes || (place.stored_bytes == 0) != (place.item_count == 0) ||
                (place.stored_bytes == 0 && place.checksum != 0))
                return fail(ErrorId::file_corrupt, pack.path, place_of_block(n, kind),
                            "more or less is stored than its contents take", k_remedy);
            offset_bytes += stored_bytes;
        }
    if (offset_bytes != pack.file->size_bytes())
        return fail(ErrorId::file_corrupt, pack.path, "byte " + std::to_string(offset_bytes),
                    "bytes behind the last block", k_remedy);
    return {};
}

// Fills `columns` one behind the other.
Status unpack_block(const TilePack& pack, uint32_t node, TileBlockKind kind,
                    std::initializer_list<std::span<std::byte>> columns) {
    const TileBlockPlace& place = block_of(pack.nodes[node], kind);
    if (place.item_count == 0) return {};
    auto corrupt = [&](const char* fault) {
        return fail(ErrorId::file_corrupt, pack.path, place_of_block(node, kind), fault, k_remedy);
    };
    std::vector<std::byte> stored(padded_to_tile_block(place.stored_bytes));
    if (Status read = pack.file->read(place.offset_bytes, stored); !read) {
        read.error().place = place_of_block(node, kind);
        return read;
    }
    if (hash_bytes(stored.data(), stored.size()) != place.checksum) return corrupt("its checksum is wrong");
    const uint64_t size_bytes = bytes_of_block(kind, place.item_count);
    if (ZSTD_getFrameContentSize(stored.data(), place.stored_bytes) != size_bytes)
        return corrupt("its size is not that of its contents");
    std::vector<std::byte> items(size_bytes);
    if (ZSTD_decompress(items.data(), items.size(), stored.data(), place.stored_bytes) != size_bytes)
        return corrupt("it cannot be decompressed");
    const std::byte* from = items.data();
    for (std::span<std::byte> column : columns) {
        std::memcpy(column.data(), from, column.size());
        from += column.size();
    }
    return {};
}

template <class Items>
std::span<std::byte> writable(Items& items) {
    return std::as_writable_bytes(std::span(items));
}

}  // namespace

Result<TilePack> open_tile_pack(const std::string& path) {
    COPPICE_TRY(OpenFile opened, OpenFile::open(path));
    TilePack pack;
    pack.path = path;
    pack.file = std::make_shared<const OpenFile>(std::move(opened));
    const OpenFile& file = *pack.file;
    COPPICE_TRY(const TilesHead head, read_head(file));
    pack.key = head.key;
    pack.content_hash = head.head_checksum;

    uint64_t rest_bytes = file.size_bytes() - sizeof head;
    if (head.models_bytes > rest_bytes || padded_to_tile_block(head.models_bytes) > rest_bytes)
        return fail(ErrorId::file_corrupt, path, "models", "they lie outside the file", k_remedy);
    std::vector<std::byte> models(padded_to_tile_block(head.models_bytes));
    COPPICE_CHECK(file.read(sizeof head, models));
    if (hash_bytes(models.data(), models.size()) != head.models_checksum)
        return fail(ErrorId::file_corrupt, path, "models", "their checksum is wrong", k_remedy);
    if (const char* fault = parse_models(models, head, pack.models))
        return fail(ErrorId::value_out_of_range, path, "models", fault, k_remedy);

    rest_bytes -= models.size();
    const uint64_t nodes_bytes = uint64_t(head.node_count) * sizeof(PackedTileNode);
    if (nodes_bytes > rest_bytes)
        return fail(ErrorId::file_corrupt, path, "nodes", "they lie outside the file", k_remedy);
    pack.nodes.resize(head.node_count);
    COPPICE_CHECK(file.read(sizeof head + models.size(), writable(pack.nodes)));
    if (hash_bytes(pack.nodes.data(), nodes_bytes) != head.nodes_checksum)
        return fail(ErrorId::file_corrupt, path, "nodes", "their checksum is wrong", k_remedy);
    if (const NodeFault wrong = fault_of_nodes(pack.nodes); wrong.fault)
        return fail(ErrorId::value_out_of_range, path, "node " + std::to_string(wrong.node), wrong.fault,
                    k_remedy);
    COPPICE_CHECK(check_places(pack, sizeof head + models.size() + nodes_bytes));
    return pack;
}

Result<TileCloud> read_cloud(const TilePack& pack, uint32_t node) {
    assert(node < pack.nodes.size());
    const PackedTileNode& packed = pack.nodes[node];
    TileCloud cloud;
    cloud.part = packed.cloud_part;
    cloud.points.resize(packed.cloud.item_count);
    cloud.densities.resize(packed.cloud.item_count);
    COPPICE_CHECK(
        unpack_block(pack, node, TileBlockKind::cloud,
                     {writable(cloud.points), writable(cloud.densities), writable(cloud.exhausted_area_m2),
                      std::as_writable_bytes(std::span(&cloud.exhausted_density, 1))}));
    const char* fault = fault_of_contents(cloud);
    if (!fault && cloud.finest_density() != packed.finest_density)
        fault = "densities that are not those of its node";
    if (fault)
        return fail(ErrorId::value_out_of_range, pack.path, place_of_block(node, TileBlockKind::cloud), fault,
                    k_remedy);
    return cloud;
}

Result<TilePlants> read_plants(const TilePack& pack, uint32_t node) {
    assert(node < pack.nodes.size());
    const uint32_t count = pack.nodes[node].plants.item_count;
    TilePlants plants{std::vector<PlantPosition>(count), std::vector<PlantTurn>(count),
                      std::vector<PlantModel>(count)};
    COPPICE_CHECK(
        unpack_block(pack, node, TileBlockKind::plants,
                     {writable(plants.positions), writable(plants.turns), writable(plants.models)}));
    if (const char* fault =
            fault_of_plants(plants.positions, plants.turns, plants.models, pack.models.size()))
        return fail(ErrorId::value_out_of_range, pack.path, place_of_block(node, TileBlockKind::plants),
                    fault, k_remedy);
    return plants;
}

Status check_blocks(const TilePack& pack) {
    std::vector<Status> found(pack.nodes.size());
    parallel_for(pack.nodes.size(), 8, [&](size_t first, size_t last) {
        for (size_t n = first; n < last; ++n) {
            if (auto cloud = read_cloud(pack, uint32_t(n)); !cloud)
                found[n] = fail(std::move(cloud.error()));
            else if (auto plants = read_plants(pack, uint32_t(n)); !plants)
                found[n] = fail(std::move(plants.error()));
        }
    });
    const auto bad = std::find_if(found.begin(), found.end(), [](const Status& s) { return !s; });
    return bad == found.end() ? Status() : std::move(*bad);
}

}  // namespace coppice
