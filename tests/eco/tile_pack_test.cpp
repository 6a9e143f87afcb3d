#include "plugins/vegetation/eco/tile_pack.h"

#include <gtest/gtest.h>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <sys/resource.h>
#include "plugins/vegetation/eco/tile_format.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/eco/made_tiles.h"

namespace coppice {
namespace {

template <class T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

std::string bytes_of(const std::string& path) {
    auto text = read_text_file(path);
    EXPECT_TRUE(text);
    return text ? *text : "";
}

// The pack and all its blocks, or the first error.
Status read_all(const std::string& path) {
    COPPICE_TRY(const TilePack pack, open_tile_pack(path));
    return check_blocks(pack);
}

// A pack as bytes, with its checksums made right again after a change, so that only the check of the value can refuse it.
class SignedPack {
  public:
    explicit SignedPack(const MadeTiles& made) : folder_("signed_pack_") {
        write_and_open(made, path());
        bytes_ = bytes_of(path());
        models_room_ = padded_to_tile_block(head().models_bytes);
        node_count_ = head().node_count;
    }
    std::string path() const { return folder_.path_of("a.tiles"); }
    TilesHead& head() { return *reinterpret_cast<TilesHead*>(bytes_.data()); }
    PackedTileNode& node(size_t n) { return nodes()[n]; }
    char* models() { return bytes_.data() + sizeof(TilesHead); }
    char* block(const TileBlockPlace& place) { return bytes_.data() + place.offset_bytes; }
    std::string& bytes() { return bytes_; }

    Status read() {
        TilesHead& head = this->head();
        head.models_checksum = hash_bytes(models(), models_room_);
        head.nodes_checksum = hash_bytes(nodes(), node_count_ * sizeof(PackedTileNode));
        head.head_checksum = 0;
        head.head_checksum = hash_bytes(&head, sizeof head);
        EXPECT_TRUE(write_text_file(path(), bytes_));
        return read_all(path());
    }

  private:
    PackedTileNode* nodes() { return reinterpret_cast<PackedTileNode*>(models() + models_room_); }
    ScratchFolder folder_;
    std::string bytes_;
    uint64_t models_room_, node_count_;  // before any change
};

// What reading says after a change. The pack: a root, three leaves; the third has no cloud.
Error error_after(const std::function<void(SignedPack&)>& change) {
    SignedPack pack(make_tile_tree(3, 0, 5, 4));
    EXPECT_TRUE(pack.read()) << "before the change";
    change(pack);
    const Status status = pack.read();
    EXPECT_FALSE(status) << "accepted";
    if (status) return {};
    EXPECT_EQ(status.error().file, pack.path());
    EXPECT_FALSE(status.error().place.empty());
    return status.error();
}

TEST(TilePack, GivesBackWhatWasWritten) {
    ScratchFolder folder("tile_pack_");
    const MadeTiles made = make_tile_tree(4, 3, 500, 200);
    const TilePack pack = write_and_open(made, folder.path_of("a.tiles"), 0x123456789abcull);
    EXPECT_EQ(pack.key, 0x123456789abcull);
    ASSERT_EQ(pack.models.size(), 2u);
    EXPECT_EQ(pack.models[0].name, "oak 0");
    EXPECT_EQ(pack.models[1].source_path, "plants/fern.plant");
    EXPECT_EQ(pack.models[1].content_hash, 101u);
    EXPECT_EQ(pack.models[1].importance, 1.5f);
    ASSERT_EQ(pack.nodes.size(), made.nodes.size());
    uint64_t triangles = 0;
    for (uint32_t n = 0; n < pack.nodes.size(); ++n) {
        const PackedTileNode& packed = pack.nodes[n];
        const TileNode& node = made.nodes[n];
        EXPECT_EQ(std::memcmp(packed.origin_world, &node.origin_world, sizeof packed.origin_world), 0);
        EXPECT_EQ(vec3(packed.bounds_max[0], packed.bounds_max[1], packed.bounds_max[2]),
                  node.bounds_tile.max);
        EXPECT_EQ(packed.first_child, node.first_child);
        EXPECT_EQ(packed.child_count, node.child_count);
        EXPECT_EQ(packed.plant_count, node.plant_count);
        EXPECT_EQ(packed.finest_density, node.cloud.finest_density());
        auto cloud = read_cloud(pack, n);
        ASSERT_TRUE(cloud) << to_string(cloud.error());
        EXPECT_TRUE(same_clouds(*cloud, node.cloud));
        EXPECT_EQ(cloud->points.size() * 20 + (cloud->points.empty() ? 0 : 257 * 4),
                  bytes_of_block(packed, TileBlockKind::cloud));
        auto plants = read_plants(pack, n);
        ASSERT_TRUE(plants) << to_string(plants.error());
        if (node.child_count) {
            EXPECT_TRUE(plants->positions.empty());
            continue;
        }
        const SceneTile& tile = made.scene.tiles[node.tile];
        auto rows = [&tile](const auto& column) {
            return std::span(column).subspan(tile.first_plant, tile.plant_count);
        };
        EXPECT_TRUE(same_bytes<PlantPosition>(plants->positions, rows(made.scene.positions)));
        EXPECT_TRUE(same_bytes<PlantTurn>(plants->turns, rows(made.scene.turns)));
        EXPECT_TRUE(same_bytes<PlantModel>(plants->models, rows(made.scene.plant_models)));
        uint64_t own = 0;
        for (const PlantModel& model : plants->models) own += model.model == 0 ? 1000 : 7;
        EXPECT_EQ(packed.triangle_count, own);
        triangles += own;
    }
    EXPECT_EQ(pack.nodes[0].triangle_count, triangles);
}

TEST(TilePack, HoldsNothingWhereThereIsNothing) {
    ScratchFolder folder("tile_pack_empty_");
    MadeTiles made;
    EXPECT_TRUE(write_and_open(made, folder.path_of("a.tiles")).nodes.empty());
    const TilePack one = write_and_open(make_tile_tree(0, 0, 3, 3), folder.path_of("a.tiles"));
    ASSERT_EQ(one.nodes.size(), 1u);
    EXPECT_EQ(one.nodes[0].child_count, 0u);
}

TEST(TilePack, SameBytesOnAnyNumberOfThreads) {
    ScratchFolder folder("tile_pack_threads_");
    const MadeTiles made = make_tile_tree(7, 5, 800, 300);
    std::vector<std::string> files;
    for (unsigned threads : {1u, 2u, 7u}) {
        set_thread_limit(threads);
        write_and_open(made, folder.path_of("a.tiles"));
        files.push_back(bytes_of(folder.path_of("a.tiles")));
    }
    set_thread_limit(0);
    EXPECT_EQ(files[0], files[1]);
    EXPECT_EQ(files[0], files[2]);
    MadeTiles other = make_tile_tree(7, 5, 800, 300);
    const uint64_t before = open_tile_pack(folder.path_of("a.tiles"))->content_hash;
    other.nodes.back().cloud.points.back().surface ^= 1;
    EXPECT_NE(write_and_open(other, folder.path_of("a.tiles")).content_hash, before);
}

TEST(TilePack, EveryCutIsSeen) {
    ScratchFolder folder("tile_pack_cuts_");
    const std::string path = folder.path_of("a.tiles");
    write_and_open(make_tile_tree(3, 0, 4, 3), path);
    const std::string whole = bytes_of(path);
    ASSERT_LT(whole.size(), 8192u);
    ASSERT_TRUE(read_all(path));
    for (size_t length = whole.size(); length-- > 0;) {
        ASSERT_EQ(::truncate(path.c_str(), off_t(length)), 0);
        const Status status = read_all(path);
        ASSERT_FALSE(status) << length << " bytes";
        ASSERT_EQ(status.error().file, path);
        ASSERT_EQ(status.error().id, length < 4 ? ErrorId::format_unknown : ErrorId::file_truncated);
    }
    ASSERT_TRUE(write_text_file(path, whole + '\0'));
    EXPECT_FALSE(read_all(path)) << "a byte too many";
}

TEST(TilePack, EveryFlippedBitIsSeen) {
    ScratchFolder folder("tile_pack_bits_");
    const std::string path = folder.path_of("a.tiles");
    write_and_open(make_tile_tree(2, 0, 4, 3), path);
    const std::string whole = bytes_of(path);
    const int file = ::open(path.c_str(), O_WRONLY);
    ASSERT_GE(file, 0);
    for (size_t bit = 0; bit < whole.size() * 8; ++bit) {
        const char flipped = char(whole[bit / 8] ^ (1 << bit % 8));
        ASSERT_EQ(::pwrite(file, &flipped, 1, off_t(bit / 8)), 1);
        const Status status = read_all(path);
        ASSERT_FALSE(status) << "bit " << bit;
        ASSERT_EQ(status.error().file, path);
        ASSERT_FALSE(status.error().place.empty());
        ASSERT_EQ(::pwrite(file, &whole[bit / 8], 1, off_t(bit / 8)), 1);
    }
    ::close(file);
    EXPECT_TRUE(read_all(path));
}

// A damaged block must not keep the others from being read.
TEST(TilePack, OtherBlocksAreReadBesideADamagedOne) {
    ScratchFolder folder("tile_pack_damaged_");
    const std::string path = folder.path_of("a.tiles");
    const TilePack before = write_and_open(make_tile_tree(3, 0, 40, 30), path);
    std::string bytes = bytes_of(path);
    bytes[before.nodes[2].plants.offset_bytes + 9] ^= 1;
    ASSERT_TRUE(write_text_file(path, bytes));
    auto pack = open_tile_pack(path);
    ASSERT_TRUE(pack);
    for (uint32_t n = 0; n < 4; ++n) {
        EXPECT_TRUE(read_cloud(*pack, n));
        auto plants = read_plants(*pack, n);
        EXPECT_EQ(plants.has_value(), n != 2);
        if (!plants) {
            EXPECT_EQ(plants.error().place, "node 2, plants");
        }
    }
}

TEST(TilePack, IsReadOnlyAsFarAsTheFileIsThere) {
    ScratchFolder folder("tile_pack_shrunk_");
    const std::string path = folder.path_of("a.tiles");
    const TilePack pack = write_and_open(make_tile_tree(3, 0, 40, 30), path);
    ASSERT_EQ(::truncate(path.c_str(), off_t(pack.nodes[1].cloud.offset_bytes + 8)), 0);
    EXPECT_TRUE(read_cloud(pack, 0));
    auto cut = read_cloud(pack, 1);
    ASSERT_FALSE(cut);
    EXPECT_EQ(cut.error().id, ErrorId::file_truncated);
    EXPECT_EQ(cut.error().place, "node 1, cloud");
}

TEST(TilePack, RefusesTreesThatAreNone) {
    auto of = [](const std::function<void(SignedPack&)>& change) { return error_after(change).place; };
    EXPECT_EQ(of([](SignedPack& p) { p.node(0).first_child = 0; }), "node 0") << "its own child";
    EXPECT_EQ(of([](SignedPack& p) { p.node(0).child_count = 4; }), "node 0") << "more than there are";
    EXPECT_EQ(of([](SignedPack& p) { p.node(0).child_count = UINT32_MAX; }), "node 0");
    EXPECT_EQ(of([](SignedPack& p) { p.node(0).first_child = UINT32_MAX, p.node(0).child_count = 3; }),
              "node 0");
    EXPECT_EQ(of([](SignedPack& p) { p.node(0).child_count = 2; }), "node 0") << "sums";
    EXPECT_EQ(of([](SignedPack& p) {
                  p.node(0).child_count = 2;
                  p.node(0).plant_count -= p.node(3).plant_count;
                  p.node(0).triangle_count -= p.node(3).triangle_count;
              }),
              "node 3")
        << "nobody's child";
    EXPECT_EQ(of([](SignedPack& p) { p.node(1).first_child = 3, p.node(1).child_count = 1; }), "node 1")
        << "children and plants";
    EXPECT_EQ(of([](SignedPack& p) { ++p.node(1).plant_count; }), "node 0");
    EXPECT_EQ(of([](SignedPack& p) { ++p.node(1).plant_count, ++p.node(0).plant_count; }), "node 1");
    EXPECT_EQ(of([](SignedPack& p) { p.node(2).first_child = 3; }), "node 2");
}

TEST(TilePack, RefusesNodesThatCannotBe) {
    auto id = [](const std::function<void(SignedPack&)>& change) { return error_after(change).id; };
    constexpr ErrorId k_wrong = ErrorId::value_out_of_range;
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).origin_world[1] = NAN; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).origin_world[2] = -1e300; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).bounds_min[0] = NAN; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).bounds_max[0] = INFINITY; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).bounds_max[2] = -100.0f; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).finest_density = NAN; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).finest_density += 1; }), k_wrong) << "not its cloud's";
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).reserved = 1; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).cloud_part.area_m2 = NAN; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).cloud_part.coverage_gain[3] = 0; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).cloud_part.kind = PackedPartKind::lines; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).cloud_part.triangle_count = 1; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).cloud_part.bounds_min[1] = NAN; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { ++p.node(1).cloud_part.point_count; }), k_wrong);
    EXPECT_EQ(id([](SignedPack& p) { p.node(3).cloud_part.area_m2 = 1; }), k_wrong) << "it has no cloud";
    EXPECT_EQ(id([](SignedPack& p) { p.node(1).cloud.item_count = 0; }), k_wrong);
}

TEST(TilePack, RefusesPlacesOutsideTheFile) {
    auto id = [](const std::function<void(SignedPack&)>& change) { return error_after(change).id; };
    constexpr ErrorId k_corrupt = ErrorId::file_corrupt;
    for (uint64_t offset : {uint64_t(0), uint64_t(1) << 32, UINT64_MAX, UINT64_MAX - 63})
        EXPECT_EQ(id([&](SignedPack& p) { p.node(1).cloud.offset_bytes = offset; }), k_corrupt) << offset;
    for (uint32_t size : {0u, 1u << 20, UINT32_MAX, UINT32_MAX - 63})
        EXPECT_EQ(id([&](SignedPack& p) { p.node(1).cloud.stored_bytes = size; }), k_corrupt) << size;
    EXPECT_EQ(id([](SignedPack& p) { p.node(3).cloud.checksum = 1; }), k_corrupt) << "of nothing";
    EXPECT_EQ(id([](SignedPack& p) {
                  p.node(0).cloud.offset_bytes = p.node(1).cloud.offset_bytes;
                  p.node(0).cloud.stored_bytes = p.node(1).cloud.stored_bytes;
              }),
              k_corrupt)
        << "two in one place";
    EXPECT_EQ(id([](SignedPack& p) { p.bytes().append(64, '\0'), p.head().file_bytes += 64; }), k_corrupt);
}

TEST(TilePack, RefusesCountsOf32Bits) {
    auto id = [](const std::function<void(SignedPack&)>& change) { return error_after(change).id; };
    EXPECT_EQ(id([](SignedPack& p) { p.head().node_count = UINT32_MAX; }), ErrorId::limit_exceeded);
    EXPECT_EQ(id([](SignedPack& p) { p.head().model_count = UINT32_MAX; }), ErrorId::limit_exceeded);
    EXPECT_EQ(id([](SignedPack& p) { p.head().models_bytes = UINT64_MAX; }), ErrorId::limit_exceeded);
    EXPECT_EQ(id([](SignedPack& p) { p.head().models_bytes = 1 << 20; }), ErrorId::file_corrupt);
    EXPECT_EQ(id([](SignedPack& p) { p.head().node_count = k_tiles_node_limit; }), ErrorId::file_corrupt);
    EXPECT_EQ(id([](SignedPack& p) { p.head().model_count = k_tiles_model_limit; }),
              ErrorId::value_out_of_range);
    EXPECT_EQ(
        id([](SignedPack& p) { p.node(1).cloud.item_count = p.node(1).cloud_part.point_count = UINT32_MAX; }),
        ErrorId::value_out_of_range);
    EXPECT_EQ(id([](SignedPack& p) {
                  p.node(0).plant_count += UINT32_MAX - p.node(1).plant_count;
                  p.node(1).plants.item_count = UINT32_MAX, p.node(1).plant_count = UINT32_MAX;
              }),
              ErrorId::value_out_of_range);
}

TEST(TilePack, RefusesModelsThatCannotBe) {
    auto of = [](const std::function<void(TilesModelHead&)>& change) {
        return error_after([&](SignedPack& p) { change(*reinterpret_cast<TilesModelHead*>(p.models())); });
    };
    EXPECT_EQ(of([](TilesModelHead& m) { m.name_bytes = UINT32_MAX; }).place, "models");
    EXPECT_EQ(of([](TilesModelHead& m) { m.path_bytes = UINT32_MAX; }).place, "models");
    EXPECT_EQ(of([](TilesModelHead& m) { m.importance = NAN; }).place, "models");
    EXPECT_EQ(of([](TilesModelHead& m) { m.importance = 0; }).place, "models");
    EXPECT_EQ(of([](TilesModelHead& m) { m.reserved = 1; }).place, "models");
    EXPECT_EQ(of([](TilesModelHead& m) { *reinterpret_cast<char*>(&m + 1) = 0; }).place, "models");
    EXPECT_EQ(error_after([](SignedPack& p) { --p.head().models_bytes; }).place, "models");
    EXPECT_EQ(error_after([](SignedPack& p) { --p.head().model_count; }).place, "models");
}

// Contents that the checksums vouch for are checked all the same: also a pack of other origin must not do harm.
TEST(TilePack, RefusesContentsThatCannotBe) {
    ScratchFolder folder("tile_pack_contents_");
    auto refused = [&](const std::function<void(MadeTiles&)>& change) {
        MadeTiles made = make_tile_tree(2, 0, 5, 4);
        change(made);
        const Status status =
            write_tile_pack(folder.path_of("a.tiles"), made.nodes, made.scene, made.plants, 1);
        return status ? Error{} : status.error();
    };
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.points[3].y_plant = NAN; }).place, "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.points[3].z_plant = 1e9f; }).place,
              "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.densities[0] = -1.0f; }).place, "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.densities[3] = 0.5f; }).place, "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.densities[2] = NAN; }).place, "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.exhausted_area_m2[9] = -1.0f; }).place,
              "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.exhausted_area_m2[9] = INFINITY; }).place,
              "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[1].cloud.exhausted_density = NAN; }).place, "node 1, cloud");
    EXPECT_EQ(refused([](MadeTiles& m) { m.scene.positions[2].x_tile = -INFINITY; }).place, "node 1, plants");
    EXPECT_EQ(refused([](MadeTiles& m) { m.scene.positions[2].scale = 0; }).place, "node 1, plants");
    EXPECT_EQ(refused([](MadeTiles& m) { m.scene.positions[2].scale = NAN; }).place, "node 1, plants");
    EXPECT_EQ(refused([](MadeTiles& m) { m.scene.turns[2] = {0, 0, 0, 0}; }).place, "node 1, plants");
    EXPECT_EQ(refused([](MadeTiles& m) { m.scene.plant_models[2].model = 2; }).place, "node 1, plants");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[2].origin_world.x = NAN; }).place, "node 2");
    EXPECT_EQ(refused([](MadeTiles& m) { m.nodes[2].bounds_tile = {}; }).place, "node 2");
    EXPECT_EQ(folder.file_count(), 0u);
}

TEST(TilePack, RefusesBlocksThatDecompressToSomethingElse) {
    // The cloud of one node in the place of another's, which has more points.
    EXPECT_EQ(error_after([](SignedPack& p) {
                  TileBlockPlace& place = p.node(1).cloud;
                  place.item_count = p.node(1).cloud_part.point_count = place.item_count + 1;
              }).place,
              "node 1, cloud");
    EXPECT_EQ(error_after([](SignedPack& p) {
                  TileBlockPlace& place = p.node(1).cloud;
                  std::memset(p.block(place), 0x5a, place.stored_bytes);
                  place.checksum = hash_bytes(p.block(place), padded_to_tile_block(place.stored_bytes));
              }).place,
              "node 1, cloud");
}

TEST(TilePack, SaysWhatOtherFilesAre) {
    ScratchFolder folder("tile_pack_others_");
    EXPECT_EQ(open_tile_pack("/nonexistent/a.tiles").error().id, ErrorId::file_missing);
    EXPECT_EQ(open_tile_pack(folder.path_of("")).error().id, ErrorId::file_missing) << "a folder";
    ASSERT_TRUE(write_text_file(folder.path_of("text"), std::string(1000, 'x')));
    EXPECT_EQ(open_tile_pack(folder.path_of("text")).error().id, ErrorId::format_unknown);
    write_and_open(make_tile_tree(0, 0, 3, 3), folder.path_of("a"));
    std::string newer = bytes_of(folder.path_of("a"));
    ASSERT_EQ(newer[4], char(k_tiles_version));
    ++newer[4];
    ASSERT_TRUE(write_text_file(folder.path_of("a"), newer));
    EXPECT_EQ(open_tile_pack(folder.path_of("a")).error().id, ErrorId::format_unknown);
}

TEST(TilePack, AFullDiskLeavesTheOldFile) {
    ScratchFolder folder("tile_pack_full_");
    const std::string path = folder.path_of("a.tiles");
    write_and_open(make_tile_tree(2, 0, 5, 4), path);
    const std::string before = bytes_of(path);
    const MadeTiles larger = make_tile_tree(5, 5, 500, 100);

    // The limit counts for all files of the process, so it stands for a moment only.
    rlimit old_limit{};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
    auto* old_handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{16384, old_limit.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const Status status = write_tile_pack(path, larger.nodes, larger.scene, larger.plants, 1);
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old_limit), 0);
    std::signal(SIGXFSZ, old_handler);

    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().id, ErrorId::write_failed);
    EXPECT_EQ(status.error().file, path);
    EXPECT_EQ(bytes_of(path), before);
    EXPECT_EQ(folder.file_count(), 1u) << "nothing is left beside it";
}

}  // namespace
}  // namespace coppice
