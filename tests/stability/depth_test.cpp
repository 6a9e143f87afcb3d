// How far apart two leaves have to be for the nearer one to be drawn.
#include <algorithm>
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

// Of the distance: 5 um at 10 m, 5 mm at 10 km.
constexpr float k_resolved_share = 5e-7f;

// The surface word of a triangle says which it is. The nearer one comes first and last, so that neither order wins.
TEST_F(RasterTest, DepthTellsLeavesApartFromTenMetersToTenKilometers) {
    for (float distance_m : {10.0f, 100.0f, 1000.0f, 10000.0f})
        for (bool nearer_first : {true, false}) {
            const float behind_m = distance_m * (1.0f + k_resolved_share);
            ASSERT_GT(behind_m, distance_m);
            std::vector<PackedVertex> vertices;
            for (int turn = 0; turn < 2; ++turn) {
                const bool nearer = (turn == 0) == nearer_first;
                const float z = nearer ? distance_m : behind_m;
                const uint32_t surface = nearer ? 1u : 2u;
                for (auto [x, y] :
                     {std::pair(20.0f, 20.0f), std::pair(230.0f, 24.0f), std::pair(60.0f, 220.0f)})
                    vertices.push_back(at(x, y, z, surface));
            }
            // Alone, what either leaf leaves in the picture; then both.
            auto draw_range = [&](uint32_t first, uint32_t count) {
                PartChoice choice;
                choice.triangles = count;
                std::vector<PackedVertex> some(vertices.begin() + first * 3,
                                               vertices.begin() + (first + count) * 3);
                draw(some, choice);
                return words_;
            };
            const std::vector<uint64_t> nearer = draw_range(nearer_first ? 0 : 1, 1);
            const std::vector<uint64_t> behind = draw_range(nearer_first ? 1 : 0, 1);
            const std::vector<uint64_t> both = draw_range(0, 2);
            size_t covered_twice = 0, wrong = 0, told_apart = 0;
            for (size_t i = 0; i < both.size(); ++i) {
                if (!nearer[i] || !behind[i]) continue;
                ++covered_twice;
                told_apart += (nearer[i] >> 32) > (behind[i] >> 32);
                wrong += (both[i] >> 32) != (nearer[i] >> 32);
            }
            EXPECT_GT(covered_twice, 10'000u) << distance_m;
            EXPECT_EQ(told_apart, covered_twice) << distance_m;
            EXPECT_EQ(wrong, 0u) << distance_m;
        }
}

}  // namespace
}  // namespace coppice
