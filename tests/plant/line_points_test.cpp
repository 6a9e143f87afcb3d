#include "plugins/vegetation/plant/line_points.h"

#include <bit>
#include <gtest/gtest.h>
#include "plugins/vegetation/plant/surface.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

float area_share_of(float density) {
    return portable_exp2((float(std::bit_cast<uint32_t>(density) & 0xffu) - 128.0f) / 16.0f);
}

// Lines of a metre, one above the other, each of its own width and colour.
struct Stem {
    PackedPart part{};
    std::vector<PackedVertex> line_vertices;

    explicit Stem(uint32_t line_count) {
        part.kind = PackedPartKind::lines;
        part.line_count = line_count;
        for (uint32_t i = 0; i < line_count; ++i) {
            line_vertices.push_back({2.0f, float(i), 0.0f, i});
            line_vertices.push_back({2.0f, float(i) + 1.0f, 0.0f, std::bit_cast<uint32_t>(0.5f + float(i))});
        }
    }
};

TEST(LinePoints, LieInTheMiddleOfEachLineFirst) {
    const Stem stem(100);
    ASSERT_EQ(line_point_count(stem.part), 100u);
    for (uint32_t i = 0; i < 100; ++i) {
        const LinePoint point = line_point(stem.part, stem.line_vertices, i);
        EXPECT_EQ(point.vertex.x_plant, 2.0f);
        EXPECT_EQ(point.vertex.y_plant, float(i) + 0.5f);
        EXPECT_EQ(point.vertex.surface, i);
        EXPECT_EQ(point.width_share, 0.5f + float(i));
    }
}

TEST(LinePoints, OfFewLinesComeInRoundsAndSpreadEvenly) {
    for (uint32_t lines : {1u, 3u, 63u}) {
        const Stem stem(lines);
        const uint32_t count = line_point_count(stem.part);
        EXPECT_GE(count, 64u);
        EXPECT_EQ(count % lines, 0u);
        for (uint32_t rounds = 1; rounds * lines <= count; rounds = 2 * rounds + 1) {
            // 2^j - 1 points of a line stand at its 2^j-ths.
            std::vector<bool> met(size_t(lines) * (rounds + 1), false);
            for (uint32_t i = 0; i < rounds * lines; ++i) {
                const float y = line_point(stem.part, stem.line_vertices, i).vertex.y_plant;
                met[size_t(y * float(rounds + 1))] = true;
                ASSERT_EQ(std::floor(y), float(i % lines));
            }
            for (uint32_t place = 0; place < met.size(); ++place)
                EXPECT_EQ(met[place], place % (rounds + 1) != 0) << place;
        }
    }
    EXPECT_EQ(line_point_count(PackedPart{}), 0u);
}

TEST(LinePoints, OfAStemFaceAllSides) {
    Stem stem(1);
    for (bool leaf : {false, true}) {
        const Surface own{vec3(1, 0, 0), vec3(0.25f), 0.5f, leaf};
        stem.line_vertices[0].surface = encode_surface(own, 0);
        dvec3 sum(0.0);
        for (uint32_t i = 0; i < 8; ++i) {
            const uint32_t bits = line_point(stem.part, stem.line_vertices, i).vertex.surface;
            EXPECT_EQ(bits >> 12, stem.line_vertices[0].surface >> 12) << "colour, openness and kind stay";
            const vec3 normal = decode_surface(bits).normal;
            EXPECT_NEAR(normal.y, 0.0f, 0.05f);
            sum += dvec3(normal) / 8.0;
        }
        EXPECT_NEAR(glm::length(sum), leaf ? 1.0 : 0.0, 0.25);
    }
}

TEST(PackDensity, SaysHowLargeAPointIs) {
    Random random(81);
    for (int round = 0; round < 10000; ++round) {
        const double density = double(portable_exp2(random.next_around(0.0f, 90.0f)));
        const float share = portable_exp2(random.next_around(0.0f, 7.0f));
        const float packed = pack_density(density, share);
        ASSERT_NEAR(double(packed), density, 0x1p-16 * density);
        ASSERT_NEAR(area_share_of(packed) / share, 1.0f, 0.023f);
        ASSERT_LE(packed, pack_density(density * 1.001, share));
    }
    for (double density : {0.0, 1e-45, 1e30})
        for (float share : {0.0f, 1.0f, INFINITY}) {
            EXPECT_TRUE(std::isfinite(pack_density(density, share)));
            EXPECT_GE(pack_density(density, share), 0.0f);
        }
}

}  // namespace
}  // namespace coppice
