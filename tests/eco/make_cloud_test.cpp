#include "plugins/vegetation/eco/make_cloud.h"

#include <algorithm>
#include <map>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/part_chance.h"
#include "plugins/vegetation/plant/point_run.h"
#include "plugins/vegetation/eco/point_demand.h"
#include "plugins/vegetation/lod/choose_part.h"
#include "plugins/vegetation/plant/direction_form.h"
#include "runtime/core/hash.h"
#include "tests/eco/cloud_plants.h"

namespace coppice {
namespace {

// Plants that stand 100 m apart along x, so that a cloud's point tells whose it is.
struct Stand {
    std::vector<PlantPosition> positions;
    std::vector<PlantTurn> turns;
    std::vector<PlantModel> models;

    void add(float x, uint32_t model, float scale, PlantTurn turn = {0, 0, 0, 32767}, uint32_t seed = 0) {
        positions.push_back({x, 0.0f, 0.0f, scale});
        turns.push_back(turn);
        models.push_back({model, seed});
    }
    size_t size() const { return positions.size(); }
    TileCloud gather(std::span<const Plant> plants) const {
        return gather_cloud(positions, turns, models, plants);
    }
};

constexpr float k_apart_m = 100.0f;

Stand random_stand(uint32_t count, uint32_t model_count, uint64_t seed) {
    Random random(seed);
    Stand stand;
    for (uint32_t i = 0; i < count; ++i) {
        // One after the other: compilers differ in which argument they draw first.
        const uint32_t model = random.next_below(model_count);
        const float scale = random.next_in(0.3f, 3.0f);
        float q[4];
        for (float& v : q) v = random.next_around(0, 1);
        stand.add(k_apart_m * float(i), model, scale, pack_turn(q[0], q[1], q[2], q[3]),
                  uint32_t(random.next_bits()));
    }
    return stand;
}

// Three models of one to three parts of points; `points`: of the largest part.
std::vector<HandPlant> random_plants(uint32_t points, uint64_t seed) {
    Random random(seed);
    std::vector<HandPlant> plants(3);
    for (uint32_t m = 0; m < 3; ++m)
        for (uint32_t p = 0; p <= m; ++p) {
            // Parts that have run out by then must not end the test too soon: points in proportion to area.
            const float share = random.next_in(0.2f, 1.0f);
            PackedPart& part =
                plants[m].add_points(uint32_t(share * float(points)), share * 2.0f, p * 100000);
            roughen_gains(part, random);
            part.importance = random.next_in(0.7f, 3.0f);
            for (float& channel : part.mean_color_linear) channel = random.next_unit();
        }
    return plants;
}

std::vector<Plant> views_of(const std::vector<HandPlant>& plants) {
    std::vector<Plant> views;
    for (const HandPlant& plant : plants) views.push_back(plant.view());
    return views;
}

size_t prefix_of(const TileCloud& cloud, float density) {
    return size_t(std::upper_bound(cloud.densities.begin(), cloud.densities.end(), density) -
                  cloud.densities.begin());
}

void expect_sound(const TileCloud& cloud) {
    EXPECT_EQ(cloud.points.size(), cloud.densities.size());
    EXPECT_EQ(cloud.part.point_count, cloud.points.size());
    EXPECT_LE(cloud.points.size(), k_cloud_points);
    EXPECT_EQ(cloud.part.triangle_count, 0u);
    EXPECT_TRUE(std::is_sorted(cloud.densities.begin(), cloud.densities.end()));
    for (float density : cloud.densities) ASSERT_TRUE(std::isfinite(density) && density >= 0.0f);
    for (const PackedVertex& p : cloud.points) ASSERT_TRUE(is_finite(vec3(p.x_plant, p.y_plant, p.z_plant)));
    const PackedPart& part = cloud.part;
    EXPECT_TRUE(std::isfinite(part.area_m2) && std::isfinite(part.point_radius_m));
    EXPECT_TRUE(std::isfinite(cloud.finest_density()));
    for (float m : part.projected_area_m2.m) EXPECT_TRUE(std::isfinite(m));
    for (float gain : part.coverage_gain) EXPECT_TRUE(std::isfinite(gain) && gain > 0.0f);
    for (int c = 0; c < 3; ++c)
        EXPECT_TRUE(std::isfinite(part.mean_color_linear[c]) && std::isfinite(part.bounds_min[c]) &&
                    std::isfinite(part.bounds_max[c]));
}

uint64_t hash_of(const TileCloud& cloud) {
    uint64_t hash = hash_bytes(cloud.points.data(), cloud.points.size() * sizeof(PackedVertex));
    hash = hash_span(std::span<const float>(cloud.densities), hash);
    hash = hash_span(std::span<const float>(cloud.exhausted_area_m2), hash);
    return hash_span(std::span<const float>(cloud.part.projected_area_m2.m), hash);
}

// The sense of it all: at each density the cloud's prefix is what the plants' own levels of detail draw there.
TEST(GatherCloud, PrefixesAreWhatThePlantsDraw) {
    const std::vector<HandPlant> hand = random_plants(1500, 11);
    const std::vector<Plant> plants = views_of(hand);
    const Stand stand = random_stand(30, 3, 12);
    const TileCloud cloud = stand.gather(plants);
    expect_sound(cloud);
    ASSERT_EQ(cloud.points.size(), k_cloud_points);
    ASSERT_GT(cloud.finest_density(), 0.0f);

    size_t compared = 0, exact = 0;
    for (float density = cloud.densities.front() * 0.9f; density <= cloud.finest_density();
         density *= 1.21f) {
        std::map<std::pair<size_t, uint32_t>, std::vector<uint32_t>> shown;  // plant, part: numbers of points
        for (size_t i = 0; i < prefix_of(cloud, density); ++i) {
            const uint32_t item = item_of(cloud.points[i]);
            const size_t plant = size_t(std::floor(cloud.points[i].x_plant / k_apart_m + 0.5f));
            shown[{plant, item / 100000}].push_back(item % 100000);
        }
        for (size_t i = 0; i < stand.size(); ++i)
            for (uint32_t p = 0; p < plants[stand.models[i].model].parts.size(); ++p) {
                auto drawn = [&](float at_density) {
                    const PlantView view{vec3(0, 0, -1), std::sqrt(at_density) * stand.positions[i].scale};
                    return choose_part(plants[stand.models[i].model].parts[p], view, {},
                                       part_chance(stand.models[i], p))
                        .points;
                };
                const std::vector<uint32_t>& numbers = shown[{i, p}];
                const uint32_t first_point = first_point_of(
                    stand.models[i].seed, p,
                    point_turn_mask(PointDemand(plants[stand.models[i].model].parts[p]).stored_count()));
                for (size_t k = 0; k < numbers.size(); ++k)
                    ASSERT_EQ(numbers[k], point_of_run(first_point, uint32_t(k)))
                        << "the plant's run of points";
                // Numbers of points come from floats, so one may come or go a trifle sooner.
                const uint32_t low = drawn(density * 0.9999f), high = drawn(density * 1.0001f);
                ASSERT_GE(numbers.size(), low) << "plant " << i << " part " << p << " at " << density;
                ASSERT_LE(numbers.size(), high) << "plant " << i << " part " << p << " at " << density;
                ++compared;
                exact += low == high;
            }
    }
    EXPECT_GT(compared, 1000u);
    EXPECT_GT(double(exact), 0.98 * double(compared));
}

TEST(GatherCloud, IsDrawnWithAsManyPointsAsThePlants) {
    const std::vector<HandPlant> hand = random_plants(1500, 21);
    const std::vector<Plant> plants = views_of(hand);
    const Stand stand = random_stand(60, 3, 22);
    const TileCloud cloud = stand.gather(plants);
    for (float density = cloud.finest_density() * 1e-3f; density <= cloud.finest_density(); density *= 1.3f) {
        double asked = 0.0;
        for (size_t i = 0; i < stand.size(); ++i)
            for (const PackedPart& part : plants[stand.models[i].model].parts)
                asked += PointDemand(part).count(double(density) * double(stand.positions[i].scale) *
                                                 double(stand.positions[i].scale));
        const double count = double(prefix_of(cloud, density));
        EXPECT_NEAR(asked, count, 0.012 * count + 10.0) << density;
    }
}

float area_share_of(float density) {
    return portable_exp2((float(std::bit_cast<uint32_t>(density) & 0xffu) - 128.0f) / 16.0f);
}

// More points, each as much smaller: what they cover stays.
TEST(GatherCloud, ImportanceAddsSmallerPointsNotArea) {
    std::vector<HandPlant> hand(2);
    for (HandPlant& plant : hand) plant.add_points(2000, 1.0f);
    hand[1].parts()[0].importance = 1.5f;
    const std::vector<Plant> plants = views_of(hand);
    Stand stand;
    stand.add(0.0f, 0, 1.0f);
    stand.add(k_apart_m, 1, 1.0f);
    const SceneModel models[] = {{}, {"important", "", 0, 2.0f}};
    const TileCloud cloud = gather_cloud(stand.positions, stand.turns, stand.models, plants, models);
    double count[2] = {}, area_px2[2] = {};
    for (size_t i = 0; i < prefix_of(cloud, 400.0f); ++i) {
        const int plant = cloud.points[i].x_plant > 0.5f * k_apart_m;
        ++count[plant];
        area_px2[plant] += double(area_share_of(cloud.densities[i]));
    }
    EXPECT_NEAR(count[0], 400.0, 1.0);
    EXPECT_NEAR(count[1], 1200.0, 1.0) << "the part's importance times the scene's";
    EXPECT_NEAR(area_px2[0], 400.0, 1.0);
    EXPECT_NEAR(area_px2[1], 400.0, 0.025 * 400.0);
}

TEST(GatherCloud, KeepsAreaColourAndFacing) {
    std::vector<HandPlant> hand(2);
    hand[0].add_points(500, 2.0f).mean_color_linear[1] = 0.5f;
    PackedPart& card = hand[1].add_points(500, 1.0f);
    card.projected_area_m2.m = {1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f};  // faces x
    card.area_m2 = 2.0f;
    card.flags = k_part_closed;
    card.mean_color_linear[0] = 0.25f;
    Stand stand;
    stand.add(0.0f, 1, 3.0f, pack_turn_about_y(0.5f * k_pi));  // and now z
    const TileCloud cards = stand.gather(views_of(hand));
    EXPECT_NEAR(cards.part.projected_area_m2.evaluate(vec3(0, 0, 1)), 9.0f, 0.1f);
    EXPECT_NEAR(cards.part.projected_area_m2.evaluate(vec3(0.6f, 0.0f, 0.8f)), 9.0f * 0.8f, 0.1f);
    EXPECT_NEAR(cards.part.projected_area_m2.evaluate(vec3(1, 0, 0)), 0.0f, 0.5f);
    EXPECT_FLOAT_EQ(cards.part.area_m2, 9 * 2.0f * 0.5f) << "half of what is closed can be seen";

    stand.add(100.0f, 0, 2.0f);
    const TileCloud cloud = stand.gather(views_of(hand));
    const double card_m2 = 9 * mean_over_directions(card.projected_area_m2), leaf_m2 = 4 * 2.0;
    EXPECT_NEAR(mean_over_directions(cloud.part.projected_area_m2), card_m2 + leaf_m2,
                0.01 * (card_m2 + leaf_m2));
    EXPECT_FLOAT_EQ(cloud.part.area_m2, 9.0f + 4 * 4.0f);
    EXPECT_NEAR(cloud.part.mean_color_linear[0], 0.25 * card_m2 / (card_m2 + leaf_m2), 0.002);
    EXPECT_NEAR(cloud.part.mean_color_linear[1], 0.5 * leaf_m2 / (card_m2 + leaf_m2), 0.002);
}

TEST(GatherCloud, TurnsPointsAndNormals) {
    std::vector<HandPlant> hand(1);
    hand[0].add_points(50, 1.0f);
    const Plant plant = hand[0].view();
    std::vector<PackedVertex> points(plant.points.begin(), plant.points.end());
    Random random(3);
    for (uint32_t i = 0; i < points.size(); ++i) {
        const vec3 normal(random.next_around(0, 1), random.next_around(0, 1), random.next_around(0, 1));
        const uint32_t bits = encode_surface({normalize_or(normal, vec3(0, 1, 0)), vec3(0), 0.0f, false}, 0);
        points[i].surface = (points[i].surface & ~0xfffu) | (bits & 0xfffu);
    }
    Plant turned_plant = plant;
    turned_plant.points = points;
    const PlantTurn turn = pack_turn(0.3f, -0.5f, 0.2f, 0.7f);
    Stand stand;
    stand.add(7.0f, 0, 2.5f, turn);
    const TileCloud cloud = stand.gather({&turned_plant, 1});
    ASSERT_EQ(cloud.points.size(), 50u);
    const uint32_t first_point = first_point_of(stand.models[0].seed, 0, point_turn_mask(50));
    for (uint32_t i = 0; i < 50; ++i) {
        const PackedVertex &from = points[point_of_run(first_point, i)], &to = cloud.points[i];
        const vec3 expected =
            vec3(7, 0, 0) + rotation_matrix(turn) * vec3(from.x_plant, from.y_plant, from.z_plant) * 2.5f;
        EXPECT_LT(glm::length(expected - vec3(to.x_plant, to.y_plant, to.z_plant)), 1e-4f);
        EXPECT_GT(glm::dot(rotation_matrix(turn) * decode_surface(from.surface).normal,
                           decode_surface(to.surface).normal),
                  0.998f);
        EXPECT_EQ(item_of(from), item_of(to)) << "colour, openness and leaf bit stay";
        for (int axis = 0; axis < 3; ++axis) {
            const float at[3] = {to.x_plant, to.y_plant, to.z_plant};
            EXPECT_TRUE(at[axis] >= cloud.part.bounds_min[axis] && at[axis] <= cloud.part.bounds_max[axis]);
        }
    }
}

TEST(GatherCloud, IsCutWhereItIsFull) {
    const std::vector<HandPlant> hand = random_plants(30000, 31);
    const std::vector<Plant> plants = views_of(hand);
    const Stand stand = random_stand(200, 3, 32);
    const TileCloud cloud = stand.gather(plants);
    ASSERT_EQ(cloud.points.size(), k_cloud_points);
    EXPECT_EQ(cloud.finest_density(), cloud.densities.back());
    double asked = 0.0;
    for (size_t i = 0; i < stand.size(); ++i)
        for (const PackedPart& part : plants[stand.models[i].model].parts)
            asked +=
                PointDemand(part).count(double(cloud.densities.back()) * double(stand.positions[i].scale) *
                                        double(stand.positions[i].scale));
    EXPECT_NEAR(asked, double(k_cloud_points), 0.01 * k_cloud_points);
}

TEST(GatherCloud, LinesGiveThePointsThatStandForThem) {
    std::vector<HandPlant> hand(1);
    const std::vector<float> widths{2.5f, 0.25f, 0.25f, 1.0f};
    hand[0].add_lines(widths, 0.2f);
    const Plant plant = hand[0].view();
    Stand stand;
    stand.add(0.0f, 0, 1.0f);
    const TileCloud cloud = stand.gather({&plant, 1});
    ASSERT_EQ(cloud.points.size(), line_point_count(plant.parts[0]));
    const float chance = part_chance(stand.models[0], 0);
    const uint32_t first_point =
        first_point_of(stand.models[0].seed, 0, point_turn_mask(line_point_count(plant.parts[0])));
    for (uint32_t i = 0; i < cloud.points.size(); ++i) {
        const uint32_t number = point_of_run(first_point, i);
        const LinePoint point = line_point(plant.parts[0], plant.line_vertices, number);
        EXPECT_EQ(item_of(cloud.points[i]), number % 4);
        EXPECT_EQ(cloud.points[i].y_plant, point.vertex.y_plant);
        EXPECT_NEAR(area_share_of(cloud.densities[i]), widths[number % 4], 0.03f * widths[number % 4]);
        const double asked = double(i) + 1.0 - double(chance);
        EXPECT_NEAR(PointDemand(plant.parts[0]).count(double(cloud.densities[i])), asked, 2e-5 * asked);
    }
}

TEST(GatherCloud, EndsWherePartsHaveRunOut) {
    auto finest = [](float few_area_m2, uint32_t few) {
        std::vector<HandPlant> hand(1);
        hand[0].add_points(2000, 1.0f);
        hand[0].add_points(few, few_area_m2);
        Stand stand;
        stand.add(0.0f, 0, 1.0f);
        return stand.gather(views_of(hand)).finest_density();
    };
    // Four points of a tenth of the area have run out at T = 40, those of the rest at T = 2000.
    EXPECT_LE(finest(0.1f, 4), 40.0f);
    EXPECT_GT(finest(0.1f, 4), 0.75f * 40.0f);
    EXPECT_GT(finest(0.015f, 1), 0.75f * 2000.0f) << "a hundredth does no harm";
    EXPECT_EQ(finest(0.1f, 0), 0.0f) << "triangles only";
    EXPECT_GT(finest(0.015f, 0), 0.75f * 2000.0f);
}

TEST(GatherCloud, GivesTheSameBytesWithEveryCompiler) {
    const std::vector<HandPlant> hand = random_plants(700, 71);
    const TileCloud one = random_stand(20, 3, 72).gather(views_of(hand)),
                    other = random_stand(20, 3, 73).gather(views_of(hand));
    EXPECT_EQ(hash_to_hex(hash_of(one)), "adc8972f4c13ea97");
    const TileCloud* children[] = {&one, &other};
    const vec3 offsets[] = {vec3(0), vec3(0.5f, -2000.0f, 3.0f)};
    EXPECT_EQ(hash_to_hex(hash_of(merge_clouds(children, offsets))), "db122c7e533078c7");
}

TEST(GatherCloud, OfNothingIsEmpty) {
    const std::vector<HandPlant> hand = random_plants(100, 41);
    std::vector<Plant> plants = views_of(hand);
    plants.emplace_back();
    for (const TileCloud& cloud :
         {gather_cloud({}, {}, {}, {}), random_stand(0, 3, 1).gather(plants), merge_clouds({}, {})}) {
        expect_sound(cloud);
        EXPECT_TRUE(cloud.points.empty());
        EXPECT_EQ(cloud.finest_density(), 0.0f);
    }
    Stand stand;
    stand.add(0.0f, 0, 0.0f);
    stand.add(0.0f, 1, -1.0f);
    stand.add(0.0f, 1, NAN);
    stand.add(NAN, 2, 1.0f);
    stand.add(INFINITY, 2, 1.0f);
    stand.add(0.0f, 2, INFINITY);
    stand.add(0.0f, 3, 1.0f);  // a plant without parts
    const TileCloud nothing = stand.gather(plants);
    expect_sound(nothing);
    EXPECT_TRUE(nothing.points.empty());
    stand.add(0.0f, 0, 1.0f);
    EXPECT_EQ(stand.gather(plants).points.size(), plants[0].parts[0].point_count) << "one among them counts";
}

TEST(GatherCloud, StaysFiniteForAnyNumbers) {
    Random random(51);
    auto wild = [&random] { return portable_exp2(random.next_around(0.0f, 120.0f)); };
    for (int round = 0; round < 60; ++round) {
        std::vector<HandPlant> hand(2);
        for (HandPlant& plant : hand)
            for (int p = 0; p < 4; ++p) {
                PackedPart& part =
                    p % 2 ? plant.add_points(200, 1.0f) : plant.add_lines({0.5f, 90.0f, 1e-20f}, 1.0f);
                part.area_m2 = wild();
                for (float& m : part.projected_area_m2.m) m = wild() * (random.next_below(4) ? 1.0f : -1.0f);
                for (float& m : part.projected_length_m.m) m = wild();
                for (float& gain : part.coverage_gain) gain = wild();
                for (float& channel : part.mean_color_linear) channel = wild();
            }
        Stand stand;
        for (int i = 0; i < 20; ++i)
            stand.add(wild(), random.next_below(2), wild(), {0, 0, 0, 0}, uint32_t(random.next_bits()));
        const std::vector<Plant> plants = views_of(hand);
        const TileCloud cloud = stand.gather(plants);
        expect_sound(cloud);
        const TileCloud* twice[] = {&cloud, &cloud};
        const vec3 offsets[] = {vec3(0), vec3(1e30f)};
        expect_sound(merge_clouds(twice, offsets));
    }
}

void expect_merged_is_gathered(const std::vector<HandPlant>& hand, uint32_t plants_a_tile, uint64_t seed) {
    const std::vector<Plant> plants = views_of(hand);
    const Stand all = random_stand(5 * plants_a_tile, uint32_t(plants.size()), seed);
    std::vector<TileCloud> clouds;
    std::vector<vec3> offsets;
    for (uint32_t tile = 0; tile < 5; ++tile) {
        Stand stand;
        offsets.push_back(vec3(float(tile) * float(plants_a_tile) * k_apart_m, 0.0f, 0.0f));
        for (size_t i = tile * plants_a_tile; i < (tile + 1) * plants_a_tile; ++i)
            stand.add(all.positions[i].x_tile - offsets[tile].x, all.models[i].model, all.positions[i].scale,
                      all.turns[i], all.models[i].seed);
        clouds.push_back(stand.gather(plants));
    }
    std::vector<const TileCloud*> children;
    for (const TileCloud& cloud : clouds) children.push_back(&cloud);
    const TileCloud merged = merge_clouds(children, offsets), gathered = all.gather(plants);
    expect_sound(merged);
    EXPECT_EQ(merged.densities, gathered.densities);
    ASSERT_EQ(merged.points.size(), gathered.points.size());
    for (size_t i = 0; i < merged.points.size(); ++i) {
        const PackedVertex &a = merged.points[i], &b = gathered.points[i];
        ASSERT_EQ(a.surface, b.surface) << i;
        ASSERT_LT(glm::length(vec3(a.x_plant - b.x_plant, a.y_plant - b.y_plant, a.z_plant - b.z_plant)),
                  0.01f)
            << i;
    }
    EXPECT_EQ(merged.finest_density(), gathered.finest_density());
    const PackedPart &a = merged.part, &b = gathered.part;
    EXPECT_NEAR(a.area_m2, b.area_m2, 1e-4f * b.area_m2);
    for (vec3 d : projection_directions())
        EXPECT_NEAR(a.projected_area_m2.evaluate(d), b.projected_area_m2.evaluate(d),
                    0.01f * b.projected_area_m2.evaluate(d));
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a.mean_color_linear[c], b.mean_color_linear[c], 0.01f * b.mean_color_linear[c]);
}

TEST(MergeClouds, GivesWhatGatheringAllTheirPlantsGives) {
    expect_merged_is_gathered(random_plants(5000, 61), 20, 62);
}

TEST(MergeClouds, AlsoWhereAllPointsFit) { expect_merged_is_gathered(random_plants(60, 63), 5, 64); }

TEST(MergeClouds, AlsoWhereSomePlantsHaveRunOut) {
    std::vector<HandPlant> hand = random_plants(5000, 65);
    hand.emplace_back();
    hand.back().add_points(2, 0.02f);
    hand.emplace_back();
    hand.back().add_points(0, 0.05f);
    expect_merged_is_gathered(hand, 30, 66);
    expect_merged_is_gathered(hand, 1, 67);
}

TEST(MergeClouds, AChildOfTrianglesEndsOnlyItsOwnCloud) {
    std::vector<HandPlant> hand(2);
    hand[0].add_points(0, 0.01f);
    hand[1].add_points(500, 1.0f);
    Stand rock, tree;
    rock.add(0.0f, 0, 1.0f);
    tree.add(0.0f, 1, 1.0f);
    const TileCloud rocks = rock.gather(views_of(hand)), trees = tree.gather(views_of(hand));
    EXPECT_EQ(rocks.finest_density(), 0.0f);
    const TileCloud* children[] = {&rocks, &trees};
    const vec3 offsets[] = {vec3(0), vec3(10, 0, 0)};
    const TileCloud both = merge_clouds(children, offsets);
    EXPECT_EQ(both.finest_density(), trees.finest_density());
    EXPECT_NEAR(mean_over_directions(both.part.projected_area_m2), 1.01, 0.01)
        << "its area is there all the same";
}

}  // namespace
}  // namespace coppice
