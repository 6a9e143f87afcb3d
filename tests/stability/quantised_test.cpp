// What is kept in fewer bits than it came in is off by half a step at most, against the same in double precision: turns,
// normals, places in tiles, and the borders between these.
#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/plant/surface.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

double random_unit(Random& random) { return double(random.next_in(-1.0f, 1.0f)); }

TEST(Quantised, TurnsAreWithinHalfAStep) {
    Random random(1);
    double worst_steps = 0.0, worst_turn = 0.0;
    for (int i = 0; i < 200000; ++i) {
        // Also those that have next to nothing of some axes.
        double q[4];
        double length = 0.0;
        for (double& part : q) {
            part = random_unit(random) * (random.next_below(4) == 0 ? 1e-5 : 1.0);
            length += part * part;
        }
        length = std::sqrt(length);
        if (length < 1e-7) continue;
        const float given[] = {float(q[0]), float(q[1]), float(q[2]), float(q[3])};
        const PlantTurn turn = pack_turn(given[0], given[1], given[2], given[3]);
        const int16_t packed[] = {turn.x, turn.y, turn.z, turn.w};
        for (int k = 0; k < 4; ++k)
            worst_steps = std::max(worst_steps, std::fabs(double(packed[k]) - q[k] / length * 32767.0));
        const glm::dquat exact(q[3] / length, q[0] / length, q[1] / length, q[2] / length);
        const glm::dmat3 there = glm::mat3_cast(exact);
        const mat3 here = rotation_matrix(turn);
        for (int c = 0; c < 3; ++c) worst_turn = std::max(worst_turn, glm::length(dvec3(here[c]) - there[c]));
    }
    // Of floats that are divided by their length beside the half: 32767 times some of their last places.
    EXPECT_LT(worst_steps, 0.5 + 32767.0 * 4 * 6e-8);
    EXPECT_GT(worst_steps, 0.45);
    // Four parts off by half a step each: a 16 m tree's top is off by 2 mm at most.
    EXPECT_LT(worst_turn, 4.0 * 0.5 * double(k_turn_step) * 2.0);
}

TEST(Quantised, NormalsAreWithinHalfAStep) {
    Random random(2);
    double worst_steps = 0.0, least_cosine = 1.0;
    auto check = [&](vec3 normal) {
        const uint32_t bits = encode_surface({normal, vec3(0.5f), 0.5f, false}, 0);
        const dvec3 n = glm::normalize(dvec3(normal));
        least_cosine =
            std::min(least_cosine, glm::dot(glm::normalize(dvec3(decode_surface(bits).normal)), n));
        // Onto the octahedron, its lower half folded outwards.
        const dvec3 on = n / (std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z));
        double u = on.x, v = on.z;
        if (on.y < 0.0) {
            u = (1.0 - std::fabs(on.z)) * (on.x < 0.0 ? -1.0 : 1.0);
            v = (1.0 - std::fabs(on.x)) * (on.z < 0.0 ? -1.0 : 1.0);
        }
        const double step = 1.0 / 31.5;
        worst_steps = std::max({worst_steps, std::fabs((double(bits & 63u) - 31.5) * step - u) / step,
                                std::fabs((double(bits >> 6 & 63u) - 31.5) * step - v) / step});
    };
    for (int i = 0; i < 200000; ++i) {
        const float x = random.next_in(-1.0f, 1.0f), y = random.next_in(-1.0f, 1.0f),
                    z = random.next_in(-1.0f, 1.0f);
        if (x * x + y * y + z * z > 1e-3f) check(vec3(x, y, z));
    }
    for (float x : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f})
        for (float y : {-1.0f, -1e-7f, 0.0f, 1e-7f, 1.0f})
            for (float z : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f})
                if (x != 0.0f || y != 0.0f || z != 0.0f) check(vec3(x, y, z));
    EXPECT_LT(worst_steps, 0.5 + 1e-4);
    EXPECT_GT(worst_steps, 0.45);
    // In the middle of a face half a step along both axes is sqrt(6) / 63 of a vector that is 1 / sqrt(3) long.
    const double worst_deg = std::acos(least_cosine) * 180.0 / double(k_pi);
    EXPECT_LT(worst_deg, 3.9) << "as plant/surface.h says";
    EXPECT_GT(worst_deg, 3.8);
}

// A plant's place is kept in floats from its tile's origin: half of a float's step there, however far away the tile is.
TEST(Quantised, PlacesInTilesAreWithinHalfAStep) {
    for (double away_m : {0.0, 1e5, 1e7}) {
        SCOPED_TRACE(away_m);
        Random random(3);
        std::vector<Placement> placements;
        for (uint32_t i = 0; i < 20000; ++i) {
            const double x = random_unit(random), z = random_unit(random), y = random_unit(random);
            placements.push_back(
                {dvec3(away_m + 900.0 * x, 30.0 * y, -away_m + 900.0 * z), 1.0f, {0, 0, 0, 32767}, {0, i}});
        }
        Scene scene;
        scene.models.resize(1);
        make_tiles(placements, scene);
        ASSERT_GT(scene.tiles.size(), 20u);
        for (const SceneTile& tile : scene.tiles)
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
                const PlantPosition& p = scene.positions[row];
                const dvec3 exact =
                    placements[scene.plant_models[row].seed].position_world - tile.tile.origin_world;
                const float kept[] = {p.x_tile, p.y_tile, p.z_tile};
                for (int axis = 0; axis < 3; ++axis) {
                    const double step = double(std::nextafter(std::fabs(kept[axis]), INFINITY)) -
                                        double(std::fabs(kept[axis]));
                    ASSERT_LE(std::fabs(double(kept[axis]) - exact[axis]), 0.5 * step);
                }
            }
    }
}

// Plants on the corners and edges of tiles: each lies in one tile and is back where it was put, to the bit.
TEST(Quantised, BordersOfTilesLoseNothing) {
    for (double away_m : {0.0, 1048576.0, 1e7}) {
        SCOPED_TRACE(away_m);
        constexpr uint32_t k_a_side = 257;  // 128 m: of corners of tiles of any power of two
        std::vector<Placement> placements;
        for (uint32_t i = 0; i < k_a_side * k_a_side; ++i)
            placements.push_back(
                {dvec3(away_m + 0.5 * double(i % k_a_side), 0.25, away_m - 0.5 * double(i / k_a_side)),
                 1.0f,
                 {0, 0, 0, 32767},
                 {0, i}});
        Scene scene;
        scene.models.resize(1);
        make_tiles(placements, scene);
        ASSERT_GT(scene.tiles.size(), 64u);
        std::vector<int> seen(placements.size(), 0);
        for (const SceneTile& tile : scene.tiles) {
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row) {
                const uint32_t plant = scene.plant_models[row].seed;
                ++seen[plant];
                const PlantPosition& p = scene.positions[row];
                const dvec3 local(double(p.x_tile), double(p.y_tile), double(p.z_tile));
                ASSERT_EQ(tile.tile.origin_world + local, placements[plant].position_world);
            }
        }
        for (int n : seen) ASSERT_EQ(n, 1);
    }
}

}  // namespace
}  // namespace coppice
