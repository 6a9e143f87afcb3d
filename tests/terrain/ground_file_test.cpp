// A packed ground is the ground it was packed from, and a broken one is refused.
#include "plugins/terrain/ground_file.h"

#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>
#include <gtest/gtest.h>
#include "plugins/terrain/load_terrain.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

class GroundFile : public testing::Test {
  protected:
    ~GroundFile() override { std::filesystem::remove(path_); }

    static std::shared_ptr<Terrain> load(const std::string& json) {
        auto terrain = load_terrain(json, testing::TempDir(), "scene.json");
        EXPECT_TRUE(terrain) << to_string(terrain.error());
        return terrain ? *terrain : nullptr;
    }
    void write(std::span<const std::byte> bytes) { ASSERT_TRUE(write_file(path_, bytes)); }
    std::string packed_json(uint64_t content_hash) const {
        return fmt::format(R"({{"packed": {{"file": "{}", "content": "{}"}}, "center": [100, 0, 50]}})",
                           name_, hash_to_hex(content_hash));
    }
    // What is read of these bytes with a checksum that is right.
    Error error_of(HeightField field, uint32_t more_words = 0) {
        const TerrainMesh mesh = build_patches(field);
        const auto packed = pack_ground(field, std::vector<uint32_t>(mesh.word_count + more_words));
        write(packed.bytes);
        const auto ground = read_ground(path_);
        EXPECT_FALSE(ground);
        return ground ? Error{} : ground.error();
    }
    static HeightField small_field() {
        HeightField field;
        field.columns = 4;
        field.rows = 3;
        field.heights_m = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
        return field;
    }

    const std::string name_ = "ground_file_test_" + std::to_string(::getpid()) + ".ground",
                      path_ = testing::TempDir() + name_;
};

template <class Item>
bool same_bytes(std::span<const Item> a, std::span<const Item> b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

// Hills that repeat, and such whose sides are no multiple of a patch.
TEST_F(GroundFile, GivesTheShadedGroundBack) {
    const std::string uneven = testing::TempDir() + name_ + ".pgm";
    ASSERT_TRUE(write_text_file(
        uneven, "P5 41 36 255\n" + std::string(41 * 18, '\x40') + std::string(41 * 18, '\x52')));
    for (const std::string& kind :
         {std::string(R"("procedural": {"size_m": 256, "cell_m": 2, "amplitude_m": 12, "wavelength_m": 60,
                        "periodic": true})"),
          fmt::format(R"("heights": {{"file": "{}.pgm", "cell_m": 2}})", name_)}) {
        const auto authored = load("{" + kind + R"(, "center": [100, 0, 50]})");
        ASSERT_TRUE(authored);
        authored->shade(20.0f, -10.0f, 9.0f, 0.6f);
        const PackedTerrain packed = authored->pack();
        write(packed.bytes);
        const auto again = load(packed_json(packed.content_hash));
        ASSERT_TRUE(again);
        EXPECT_TRUE(same_bytes(again->vertices(), authored->vertices()));
        EXPECT_TRUE(same_bytes(again->patches(), authored->patches()));
        EXPECT_TRUE(same_bytes(again->levels(), authored->levels()));
        EXPECT_TRUE(same_bytes(again->least_heights(), authored->least_heights()));
        EXPECT_EQ(again->origin_world(), authored->origin_world());
        EXPECT_EQ(again->layout().cell_m, authored->layout().cell_m);
        for (float x : {-300.0f, -20.3f, 0.0f, 7.7f, 190.0f}) {
            EXPECT_EQ(again->height_at(x, 3.1f), authored->height_at(x, 3.1f));
            EXPECT_EQ(again->normal_at(x, 3.1f), authored->normal_at(x, 3.1f));
        }
        const PackedTerrain twice = again->pack();
        EXPECT_EQ(twice.content_hash, packed.content_hash);
        EXPECT_EQ(twice.bytes, packed.bytes);
        // Its light was settled when it was packed.
        again->shade(20.0f, -10.0f, 9.0f, 0.6f);
        EXPECT_TRUE(same_bytes(again->vertices(), authored->vertices()));
    }
    std::filesystem::remove(uneven);
}

TEST_F(GroundFile, OfAnotherGroundIsRefused) {
    const PackedTerrain flat = load(R"({"flat": {"size_m": 64, "height_m": 1}})")->pack(),
                        other = load(R"({"flat": {"size_m": 64, "height_m": 2}})")->pack();
    write(other.bytes);
    auto loaded = load_terrain(packed_json(flat.content_hash), testing::TempDir(), "scene.json");
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().id, ErrorId::file_corrupt);
    EXPECT_EQ(loaded.error().file, path_);
    std::filesystem::remove(path_);
    loaded = load_terrain(packed_json(flat.content_hash), testing::TempDir(), "scene.json");
    ASSERT_FALSE(loaded);
    EXPECT_EQ(loaded.error().id, ErrorId::file_missing);
}

TEST_F(GroundFile, CutAnywhereOrWithAnyBitFlippedIsRefused) {
    const HeightField field = small_field();
    const auto whole =
        pack_ground(field, std::vector<uint32_t>(build_patches(field).word_count, 0x12345678u)).bytes;
    write(whole);
    ASSERT_TRUE(read_ground(path_));
    for (size_t size = 0; size < whole.size(); ++size) {
        write(std::span(whole).first(size));
        const auto ground = read_ground(path_);
        ASSERT_FALSE(ground) << size;
        EXPECT_EQ(ground.error().id, size < 4 ? ErrorId::format_unknown : ErrorId::file_truncated) << size;
        EXPECT_FALSE(ground.error().remedy.empty());
    }
    for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
        auto flipped = whole;
        flipped[bit / 8] ^= std::byte(1u << bit % 8);
        write(flipped);
        const auto ground = read_ground(path_);
        ASSERT_FALSE(ground) << bit;
        EXPECT_EQ(ground.error().file, path_);
    }
    auto longer = whole;
    longer.push_back(std::byte(0));
    write(longer);
    EXPECT_EQ(read_ground(path_).error().id, ErrorId::file_corrupt);
}

// Not damaged, but made to harm.
TEST_F(GroundFile, ThatNoFieldCanHaveIsRefused) {
    HeightField field = small_field();
    for (float height_m : {NAN, INFINITY, -2e5f}) {
        field.heights_m[5] = height_m;
        EXPECT_EQ(error_of(field).place, "heights") << height_m;
    }
    field = small_field();
    for (float cell_m : {0.0f, -1.0f, NAN, INFINITY}) {
        field.cell_m = cell_m;
        EXPECT_EQ(error_of(field).id, ErrorId::value_out_of_range) << cell_m;
    }
    EXPECT_EQ(error_of(small_field(), 1).place, "surface words");

    auto bytes = pack_ground(small_field(), {}).bytes;
    const uint32_t huge[2] = {0xffffffffu, 0xffffffffu};
    std::memcpy(bytes.data() + 16, huge, sizeof huge);  // columns and rows
    write(bytes);
    EXPECT_EQ(read_ground(path_).error().id, ErrorId::limit_exceeded);
    bytes = pack_ground(small_field(), {}).bytes;
    std::memcpy(bytes.data() + 32, huge, 4);  // words
    write(bytes);
    EXPECT_EQ(read_ground(path_).error().id, ErrorId::file_truncated);
    bytes[4] = std::byte(k_ground_version + 1);
    write(bytes);
    EXPECT_EQ(read_ground(path_).error().id, ErrorId::format_unknown);
    EXPECT_NE(read_ground(path_).error().remedy.find("populate"), std::string::npos);
}

}  // namespace
}  // namespace coppice
