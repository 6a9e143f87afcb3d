#include <gtest/gtest.h>
#include <cstring>
#include <filesystem>
#include <unistd.h>
#include <fstream>
#include "plugins/vegetation/plant/format.h"
#include "plugins/vegetation/plant/pack.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

PlantBlocks small_plant() {
    PlantBlocks blocks;
    blocks.name = "small";
    blocks.bounds_plant.include(vec3(0));
    blocks.bounds_plant.include(vec3(1, 2, 3));
    blocks.dropped_triangles = 5;
    blocks.dropped_vertices = 7;
    for (uint32_t i = 0; i < 6; ++i) blocks.triangle_vertices.push_back({float(i), 1, 2, i});
    for (uint32_t i = 0; i < 3; ++i) {
        blocks.points.push_back({0, float(i), 2, i});
        blocks.point_owners.push_back(i % 2);
    }
    for (uint32_t i = 0; i < 4; ++i) blocks.line_vertices.push_back({0, 1, float(i), i});
    PackedPart part{};
    copy_name("leaf", part.name, sizeof part.name);
    part.importance = 1.5f;
    part.coverage_gain.fill(1.0f);
    part.flags = 2;
    part.triangle_count = 2;
    part.point_count = 3;
    part.area_m2 = 2.0f;
    blocks.parts.push_back(part);
    part.kind = PackedPartKind::lines;
    part.triangle_count = part.point_count = 0;
    part.first_triangle = 2;
    part.first_point = 3;
    part.line_count = 2;
    blocks.parts.push_back(part);
    return blocks;
}

Result<Plant> load(const std::vector<std::byte>& bytes) {
    return load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(bytes), "test.plant");
}

// Packs what the change leaves, with all checksums right, so that only the check of the value can refuse it.
Result<Plant> load_changed(void (*change)(PlantBlocks&)) {
    PlantBlocks blocks = small_plant();
    change(blocks);
    return load(pack_plant(blocks));
}

// Of the leaf part's two triangles each has a cell, the second one with two points of its own.
PlantBlocks small_plant_in_cells() {
    PlantBlocks blocks = small_plant();
    for (uint32_t c = 0; c < 2; ++c) {
        PackedPart cell = blocks.parts[0];
        cell.first_triangle = c;
        cell.triangle_count = 1;
        cell.first_point = uint32_t(blocks.points.size());
        cell.point_count = 1 + c;
        cell.first_line = 2;
        blocks.cells.push_back(cell);
        for (uint32_t i = 0; i <= c; ++i) {
            blocks.points.push_back({0, 1, float(i), 5});
            blocks.point_owners.push_back(0);
        }
    }
    return blocks;
}

// Four leaves and the two collapses that leave two: in one band, the first four of its six are removed.
PlantBlocks small_plant_with_leaves() {
    PlantBlocks blocks = small_plant_in_cells();
    blocks.crowns.push_back({0, 0, 4, 2});
    for (uint32_t birth : {0u, 0u, 0u, 1u, 0u, 2u}) blocks.leaves.push_back({{}, 5, birth});
    return blocks;
}

TEST(LoadPlant, GivesBackWhatWasPacked) {
    PlantBlocks blocks = small_plant();
    auto plant = load(pack_plant(blocks));
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_EQ(plant->name, "small");
    EXPECT_EQ(plant->bounds_plant.max, vec3(1, 2, 3));
    EXPECT_EQ(plant->dropped_triangles, 5u);
    EXPECT_EQ(plant->dropped_vertices, 7u);
    auto same = [](const auto& loaded, const auto& packed) {
        return loaded.size() == packed.size() &&
               std::memcmp(loaded.data(), packed.data(), loaded.size_bytes()) == 0;
    };
    EXPECT_TRUE(same(plant->parts, blocks.parts));
    EXPECT_TRUE(same(plant->triangle_vertices, blocks.triangle_vertices));
    EXPECT_TRUE(same(plant->points, blocks.points));
    EXPECT_TRUE(same(plant->point_owners, blocks.point_owners));
    EXPECT_TRUE(same(plant->line_vertices, blocks.line_vertices));
}

TEST(LoadPlant, UsesTheBytesInPlace) {
    auto bytes = std::make_shared<const std::vector<std::byte>>(pack_plant(small_plant()));
    auto plant = load_plant_from_memory(bytes, "test.plant");
    ASSERT_TRUE(plant);
    auto* first = reinterpret_cast<const std::byte*>(plant->points.data());
    EXPECT_GE(first, bytes->data());
    EXPECT_LT(first, bytes->data() + bytes->size());
    EXPECT_EQ((first - bytes->data()) % 64, 0);
}

TEST(LoadPlant, ContentHashFollowsEveryBlock) {
    PlantBlocks blocks = small_plant();
    uint64_t before = load(pack_plant(blocks))->content_hash;
    EXPECT_EQ(before, load(pack_plant(small_plant()))->content_hash);
    blocks.line_vertices[3].surface ^= 1;
    EXPECT_NE(before, load(pack_plant(blocks))->content_hash);
}

TEST(LoadPlant, RefusesEveryTruncation) {
    std::vector<std::byte> bytes = pack_plant(small_plant_with_leaves());
    for (size_t length = 0; length < bytes.size(); ++length) {
        auto plant = load(std::vector<std::byte>(bytes.begin(), bytes.begin() + long(length)));
        ASSERT_FALSE(plant) << length;
        EXPECT_EQ(plant.error().file, "test.plant");
    }
    bytes.push_back(std::byte(0));
    EXPECT_FALSE(load(bytes)) << "a byte too many";
}

TEST(LoadPlant, RefusesEveryFlippedBit) {
    std::vector<std::byte> bytes = pack_plant(small_plant_with_leaves());
    for (size_t bit = 0; bit < bytes.size() * 8; ++bit) {
        bytes[bit / 8] ^= std::byte(1 << bit % 8);
        ASSERT_FALSE(load(bytes)) << "bit " << bit;
        bytes[bit / 8] ^= std::byte(1 << bit % 8);
    }
    EXPECT_TRUE(load(bytes));
}

TEST(LoadPlant, RefusesBlocksWhoseSizeWraps) {
    std::vector<std::byte> bytes = pack_plant(small_plant_with_leaves());
    for (uint64_t count : {UINT64_MAX, UINT64_MAX / 16, UINT64_MAX / 256 + 1, uint64_t(1) << 60}) {
        for (size_t b = 0; b < k_block_count; ++b) {
            std::vector<std::byte> changed = bytes;
            PlantFileHead head;
            std::memcpy(&head, changed.data(), sizeof head);
            head.blocks[b].item_count = count;
            head.head_checksum = 0;
            head.head_checksum = hash_bytes(&head, sizeof head);
            std::memcpy(changed.data(), &head, sizeof head);
            auto plant = load(changed);
            ASSERT_FALSE(plant);
            EXPECT_EQ(plant.error().id, ErrorId::file_corrupt);
        }
    }
}

TEST(LoadPlant, GivesBackCells) {
    const PlantBlocks blocks = small_plant_in_cells();
    auto plant = load(pack_plant(blocks));
    ASSERT_TRUE(plant) << to_string(plant.error());
    ASSERT_EQ(plant->cells.size(), 2u);
    EXPECT_EQ(plant->parts.size(), 2u);
    EXPECT_EQ(std::memcmp(plant->cells.data(), blocks.cells.data(), plant->cells.size_bytes()), 0);
    EXPECT_EQ(plant->points.size(), 6u);
}

TEST(LoadPlant, RefusesCellsThatDoNotShareTheirPartOut) {
    auto place_of = [](void (*change)(PlantBlocks&)) {
        PlantBlocks blocks = small_plant_in_cells();
        change(blocks);
        auto plant = load(pack_plant(blocks));
        return plant ? std::string("taken") : plant.error().place;
    };
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[1].part = 2; }), "cells[0]") << "half of its part";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[0].part = UINT32_MAX; }), "cells[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[0].part = 1; }), "cells[0]") << "of another kind";
    EXPECT_EQ(place_of([](PlantBlocks& b) { std::swap(b.cells[0], b.cells[1]); }), "cells[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[0].triangle_count = 0; }), "cells[0]") << "its owners";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[1].first_triangle = 0; }), "cells[1]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[1].triangle_count = 2; }), "cells[1]") << "past the part";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[1].first_point = 0; }), "cells[1]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[1].point_count = UINT32_MAX; }), "cells[1]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[1].bounds_max[0] = INFINITY; }), "cells[1]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells[0].importance = NAN; }), "cells[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.cells.pop_back(); }), "cells[0]") << "half of the part";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.points.push_back({}), b.point_owners.push_back(0); }), "parts");
}

TEST(LoadPlant, GivesBackLeaves) {
    const PlantBlocks blocks = small_plant_with_leaves();
    auto plant = load(pack_plant(blocks));
    ASSERT_TRUE(plant) << to_string(plant.error());
    ASSERT_EQ(plant->crowns.size(), 1u);
    EXPECT_EQ(plant->crowns[0].full_count, 4u);
    ASSERT_EQ(plant->leaves.size(), 6u);
    EXPECT_EQ(std::memcmp(plant->leaves.data(), blocks.leaves.data(), plant->leaves.size_bytes()), 0);
}

TEST(LoadPlant, RefusesLeavesThatAreNoLevels) {
    auto place_of = [](void (*change)(PlantBlocks&)) {
        PlantBlocks blocks = small_plant_with_leaves();
        change(blocks);
        auto plant = load(pack_plant(blocks));
        return plant ? std::string("taken") : plant.error().place;
    };
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].part = 2; }), "crowns[0]") << "of no part";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].part = 1; }), "crowns[0]") << "of lines";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].first_leaf = 1; }), "crowns[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].full_count = 5; }), "crowns[0]") << "past the file";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].full_count = UINT32_MAX; }), "crowns[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].full_count = 1; }), "crowns[0]") << "below the least";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns[0].least_count = 0; }), "crowns[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns.push_back(b.crowns[0]); }), "crowns[1]") << "a second one";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.leaves[1].birth_level = 1; }), "crowns[0]") << "removed as it is born";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.leaves[4].birth_level = 2; }), "crowns[0]") << "two of one birth";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.leaves[5].birth_level = 0; }), "crowns[0]") << "none born at level 2";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.leaves[5].birth_level = UINT32_MAX; }), "crowns[0]");
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.leaves.push_back({}); }), "crowns[1]") << "of no crown";
    EXPECT_EQ(place_of([](PlantBlocks& b) { b.crowns.clear(); }), "crowns[0]");
}

TEST(LoadPlant, RefusesValuesNoPlantCanHave) {
    auto id_of = [](Result<Plant> plant) { return plant ? ErrorId::inconclusive : plant.error().id; };
    constexpr ErrorId k_wrong = ErrorId::value_out_of_range;
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.points[1].y_plant = NAN; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.triangle_vertices[5].z_plant = INFINITY; })),
              k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.line_vertices[0].x_plant = -INFINITY; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.points[0].x_plant = 1.001e5f; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.line_vertices[3].z_plant = -2e5f; })), k_wrong);
    EXPECT_TRUE(load_changed([](PlantBlocks& b) { b.triangle_vertices[0].x_plant = -1e5f; }));
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.point_owners[2] = 2; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].importance = 0; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].coverage_gain[3] = 0; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].area_m2 = NAN; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].kind = PackedPartKind(2); })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].first_triangle = 1; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].triangle_count = UINT32_MAX; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[1].first_line = UINT32_MAX; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].projected_area_m2.m[5] = NAN; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].bounds_min[1] = NAN; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.parts[0].bounds_max[2] = 1.001e5f; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) {
                  b.parts[0].bounds_min[0] = 1.0f;
                  b.parts[0].bounds_max[0] = 0.5f;
              })),
              k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.line_vertices.pop_back(); })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { b.bounds_plant = Box{}; })), k_wrong);
    EXPECT_EQ(id_of(load_changed([](PlantBlocks& b) { std::memset(b.parts[0].name, 'x', 32); })), k_wrong);
}

// Ranges that overlap would be checked and drawn once a part: a small file, and any amount of work.
TEST(LoadPlant, RefusesPartsThatDoNotFollowEachOther) {
    auto error_of = [](void (*change)(PlantBlocks&)) {
        auto plant = load_changed(change);
        EXPECT_FALSE(plant);
        return plant ? Error{} : plant.error();
    };
    auto overlap = error_of([](PlantBlocks& b) { b.parts.push_back(b.parts[0]); });
    EXPECT_EQ(overlap.id, ErrorId::value_out_of_range);
    EXPECT_EQ(overlap.place, "parts[2]");
    EXPECT_EQ(error_of([](PlantBlocks& b) { b.parts[1].first_point = 2; }).place, "parts[1]");
    EXPECT_EQ(error_of([](PlantBlocks& b) { b.parts[1].first_line = 1, b.parts[1].line_count = 1; }).place,
              "parts[1]");
    EXPECT_EQ(error_of([](PlantBlocks& b) { b.parts[1].line_count = 1; }).place, "parts")
        << "a line of no part";
    EXPECT_EQ(
        error_of([](PlantBlocks& b) { b.parts[0].triangle_count = 1, b.parts[1].first_triangle = 1; }).id,
        ErrorId::value_out_of_range);
}

TEST(LoadPlant, SaysWhatOtherFilesAre) {
    std::vector<std::byte> text(1000, std::byte('x'));
    EXPECT_EQ(load(text).error().id, ErrorId::format_unknown);
    EXPECT_EQ(load({}).error().id, ErrorId::format_unknown);
    EXPECT_EQ(load_plant("/nonexistent/a.plant").error().id, ErrorId::file_missing);
    std::vector<std::byte> newer = pack_plant(small_plant());
    newer[4] = std::byte(k_plant_version + 1);
    EXPECT_EQ(load(newer).error().id, ErrorId::format_unknown);
}

TEST(LoadPlant, MapsAFile) {
    std::string path = (std::filesystem::temp_directory_path() /
                        ("coppice_load_test_" + std::to_string(::getpid()) + ".plant"))
                           .string();
    ASSERT_TRUE(write_file(path, pack_plant(small_plant())));
    auto plant = load_plant(path);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_EQ(plant->points[2].y_plant, 2.0f);
    EXPECT_TRUE(plant->file);
    std::filesystem::remove(path);
}

TEST(CopyName, CutsBetweenCharacters) {
    char field[8];
    copy_name("abcdef\xc3\xa9", field, sizeof field);  // the last character would need bytes 6 and 7
    EXPECT_STREQ(field, "abcdef");
    copy_name("abcde\xc3\xa9", field, sizeof field);
    EXPECT_STREQ(field, "abcde\xc3\xa9");
    copy_name("", field, sizeof field);
    EXPECT_STREQ(field, "");
}

}  // namespace
}  // namespace coppice
