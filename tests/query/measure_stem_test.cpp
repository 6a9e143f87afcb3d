// Of plants whose stems are known.
#include <gtest/gtest.h>
#include <cmath>
#include "plugins/vegetation/query/stem.h"

namespace coppice {
namespace {

// A plant's triangles, without the rest of a packed plant.
struct MadePlant {
    std::vector<PackedPart> parts;
    std::vector<PackedVertex> vertices;
    Box bounds;

    void begin_part(bool leaf) {
        PackedPart part{};
        part.flags = leaf ? k_part_leaf : 0;
        part.first_triangle = uint32_t(vertices.size() / 3);
        parts.push_back(part);
    }
    void add(vec3 a, vec3 b, vec3 c) {
        for (vec3 p : {a, b, c}) {
            vertices.push_back({p.x, p.y, p.z, 0});
            bounds.include(p);
        }
        ++parts.back().triangle_count;
    }
    // An upright tube around a line, with a radius of its own at both ends.
    void add_tube(vec3 from, vec3 to, float from_radius_m, float to_radius_m) {
        constexpr int k_sides = 12, k_rows = 20;
        auto at = [&](int row, int side) {
            const float share = float(row) / k_rows, angle = 2.0f * k_pi * float(side) / k_sides;
            const float radius = from_radius_m + (to_radius_m - from_radius_m) * share;
            return from + (to - from) * share + vec3(std::cos(angle), 0.0f, std::sin(angle)) * radius;
        };
        for (int row = 0; row < k_rows; ++row)
            for (int side = 0; side < k_sides; ++side) {
                add(at(row, side), at(row + 1, side), at(row, side + 1));
                add(at(row + 1, side), at(row + 1, side + 1), at(row, side + 1));
            }
    }
    Plant plant() const {
        Plant made;
        made.parts = parts;
        made.triangle_vertices = vertices;
        made.bounds_plant = bounds;
        return made;
    }
};

MadePlant leaning_tree() {
    MadePlant tree;
    tree.begin_part(false);
    tree.add_tube({0, 0, 0}, {1, 8, 0}, 0.22f, 0.18f);
    tree.begin_part(false);  // branches, far from it and wide
    for (int i = 0; i < 6; ++i)
        tree.add_tube({0.6f, 4.5f + 0.3f * float(i), 0}, {i % 2 ? 4.0f : -3.0f, 7.0f, 0}, 0.05f, 0.02f);
    tree.begin_part(true);  // a crown that hangs to the ground
    tree.add_tube({0.5f, 0, 0}, {0.5f, 9, 0}, 3.0f, 3.0f);
    return tree;
}

}  // namespace

TEST(MeasureStem, FollowsTheTrunkWhateverGrowsOnIt) {
    const MadePlant tree = leaning_tree();
    const StemShape stem = measure_stem(tree.plant());
    EXPECT_NEAR(stem.radius_m, 0.2f, 0.03f);
    EXPECT_NEAR(stem.foot_plant.x, 0.0f, 0.1f);
    EXPECT_NEAR(stem.foot_plant.y, 0.0f, 0.3f);
    EXPECT_NEAR(stem.head_plant.x, 1.0f, 0.25f);
    EXPECT_GT(stem.head_plant.y, 7.0f);
    EXPECT_LT(stem.head_plant.y, 8.5f);
    EXPECT_NEAR(stem.head_plant.z, 0.0f, 0.1f);
}

TEST(MeasureStem, WhatHasNoWoodHasNone) {
    MadePlant fern;
    fern.begin_part(true);
    fern.add_tube({0, 0, 0}, {0, 1, 0}, 0.5f, 0.2f);
    EXPECT_EQ(measure_stem(fern.plant()).radius_m, 0.0f);
    EXPECT_EQ(measure_stem(Plant{}).radius_m, 0.0f);
}

// Stalks that lean outwards from one place, as those of ferns do.
TEST(MeasureStem, ABunchOfStalksHasNone) {
    MadePlant fern;
    fern.begin_part(false);
    for (int i = 0; i < 12; ++i) {
        const float angle = 2.0f * k_pi * float(i) / 12.0f;
        const vec3 out(std::cos(angle), 0.0f, std::sin(angle));
        fern.add_tube(out * 0.02f, out * 0.5f + vec3(0, 0.5f, 0), 0.004f, 0.002f);
    }
    EXPECT_EQ(measure_stem(fern.plant()).radius_m, 0.0f);
}

// Where a trunk forks its stem ends: branches are no part of its radius.
TEST(MeasureStem, ForkedTrunksEndAtTheFork) {
    MadePlant oak;
    oak.begin_part(false);
    oak.add_tube({0, 0, 0}, {0, 4, 0}, 0.42f, 0.4f);
    for (int i = 0; i < 7; ++i) {
        const float angle = 2.0f * k_pi * float(i) / 7.0f;
        oak.add_tube({0, 4, 0}, {6 * std::cos(angle), 14, 6 * std::sin(angle)}, 0.2f, 0.02f);
    }
    const StemShape stem = measure_stem(oak.plant());
    EXPECT_NEAR(stem.radius_m, 0.4f, 0.06f);
    EXPECT_GT(stem.head_plant.y, 3.0f);
    EXPECT_LT(stem.head_plant.y, 6.5f);
}

TEST(MeasureStem, StandsAsItsPlantStands) {
    const StemShape shape{{0, 0, 0}, {0, 10, 0}, 0.2f};
    Scene scene;
    scene.tiles.push_back({{dvec3(1000, 5, -1000), {}, 2}, 0, 2});
    scene.positions = {{1, 2, 3, 0.5f}, {4, 0, 0, 1.0f}};
    scene.turns = {pack_turn(0, 0, std::sin(0.25f * k_pi), std::cos(0.25f * k_pi)), pack_turn_about_y(0.0f)};
    scene.plant_models = {{0, 1}, {1, 2}};
    const StemShape none{};
    const std::vector<Stem> stems = stems_of(scene, std::vector<StemShape>{shape, none});
    ASSERT_EQ(stems.size(), 1u);
    EXPECT_EQ(stems[0].plant, 0u);
    EXPECT_NEAR(stems[0].radius_m, 0.1f, 1e-6f);
    EXPECT_NEAR(stems[0].foot_world.x, 1001.0, 1e-3);
    EXPECT_NEAR(stems[0].foot_world.y, 7.0, 1e-3);
    EXPECT_NEAR(stems[0].foot_world.z, -997.0, 1e-3);
    // A quarter turn about z lays it down along -x.
    EXPECT_NEAR(stems[0].head_world.x, 996.0, 1e-2);
    EXPECT_NEAR(stems[0].head_world.y, 7.0, 1e-2);
}

}  // namespace coppice
