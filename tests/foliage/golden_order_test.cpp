// Leaves go in an order that thins the whole crown at once.
#include "plugins/vegetation/cook/golden_order.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <numeric>
#include "plugins/vegetation/cook/progressive_order.h"
#include "plugins/vegetation/cook/space_curve.h"
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

constexpr uint32_t k_count = 6000;

// In an upright cylinder, as the places that the order asks for.
std::vector<vec3> made_places(uint32_t count) {
    std::vector<vec3> places;
    Random random(21);
    for (uint32_t i = 0; i < count; ++i) {
        const float around = random.next_in(0, 2 * k_pi), out_m = 3.0f * std::sqrt(random.next_unit());
        places.push_back({out_m * portable_cos(around), random.next_in(2, 10), out_m * portable_sin(around)});
    }
    return places;
}

// Of which of 3 x 3 x 4 boxes the dropped are more than their share: the variance of the counts over what chance would give.
double clumping(const std::vector<vec3>& places, std::span<const uint32_t> dropped) {
    std::array<double, 36> all{}, gone{};
    auto box_of = [](vec3 p) {
        auto cell = [](float x, float low, float high, int count) {
            return std::clamp(int(float(count) * (x - low) / (high - low)), 0, count - 1);
        };
        return size_t(cell(p.x, -3, 3, 3) + 3 * cell(p.z, -3, 3, 3) + 9 * cell(p.y, 2, 10, 4));
    };
    for (vec3 p : places) all[box_of(p)] += 1.0;
    for (uint32_t i : dropped) gone[box_of(places[i])] += 1.0;
    const double share = double(dropped.size()) / double(places.size());
    double sum = 0.0;
    for (size_t b = 0; b < all.size(); ++b) {
        const double expected = share * all[b];
        if (expected > 0.0) sum += (gone[b] - expected) * (gone[b] - expected) / (expected * (1.0 - share));
    }
    return sum / double(all.size());
}

TEST(GoldenOrder, EveryLeafGoesOnce) {
    const std::vector<vec3> places = made_places(k_count);
    for (const GoldenOrderSettings& settings :
         {GoldenOrderSettings{}, {.height = DropHeight::sine}, {.places = DropPlaces::cylinder}}) {
        std::vector<uint32_t> order = golden_drop_order(places, settings);
        EXPECT_EQ(order, golden_drop_order(places, settings));
        std::sort(order.begin(), order.end());
        for (uint32_t i = 0; i < k_count; ++i) ASSERT_EQ(order[i], i);
    }
}

std::vector<uint32_t> shuffled(uint32_t count) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    Random random(5);
    for (uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.next_below(i)]);
    return order;
}

TEST(GoldenOrder, ThinsMoreEvenlyThanChance) {
    const std::vector<vec3> places = made_places(k_count);
    const std::vector<uint32_t> golden = golden_drop_order(places, {}), chance = shuffled(k_count);
    for (uint32_t dropped : {k_count / 16, k_count / 8, k_count / 4})
        EXPECT_LT(clumping(places, std::span(golden).first(dropped)),
                  0.7 * clumping(places, std::span(chance).first(dropped)))
            << dropped << " dropped";
}

// As printed it asks for as many leaves of every place, however many are there: what stays in the end is where leaves were
// dense. Order along a curve takes from each place its share.
TEST(GoldenOrder, AProgressiveOrderKeepsWhereLeavesAreDense) {
    const std::vector<vec3> places = made_places(k_count);
    const std::vector<uint32_t> golden = golden_drop_order(places, {.places = DropPlaces::cylinder});
    const std::vector<uint32_t> curve = order_along_curve(places);
    std::vector<uint32_t> progressive = make_prefix_order(k_count, PrefixOrder::progressive, 1);
    for (uint32_t& place : progressive) place = curve[place];
    for (uint32_t dropped : {k_count / 2, 3 * k_count / 4}) {
        EXPECT_GT(clumping(places, std::span(golden).first(dropped)), 1.0) << dropped << " dropped";
        EXPECT_LT(clumping(places, std::span(progressive).first(dropped)), 0.7) << dropped << " dropped";
    }
}

// The printed places fill a cylinder: of a ball they take the outside, and what is left is its core.
TEST(GoldenOrder, ARoundCrownStaysRound) {
    std::vector<vec3> ball;
    Random random(8);
    while (ball.size() < k_count) {
        const vec3 p(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1));
        if (glm::length(p) < 1.0f) ball.push_back(p);
    }
    auto mean_radius_of_rest = [&](DropPlaces places) {
        const std::vector<uint32_t> order = golden_drop_order(ball, {.places = places});
        double sum = 0.0;
        for (uint32_t leaf : std::span(order).last(k_count / 10)) sum += double(glm::length(ball[leaf]));
        return sum / (k_count / 10);
    };
    // Of a ball of radius 1 the mean is 3 / 4.
    EXPECT_NEAR(mean_radius_of_rest(DropPlaces::crown), 0.75, 0.05);
    EXPECT_LT(mean_radius_of_rest(DropPlaces::cylinder), 0.65);
}

TEST(GoldenOrder, LeavesThatGoOneAfterTheOtherAreNotNear) {
    const std::vector<vec3> places = made_places(k_count);
    const std::vector<uint32_t> order = golden_drop_order(places, {});
    int near = 0;
    for (size_t i = 1; i < k_count / 4; ++i)
        near += glm::length(places[order[i]] - places[order[i - 1]]) < 0.5f;
    EXPECT_LT(near, int(k_count / 4 / 50));
}

TEST(GoldenOrder, HostilePlacesGetAnOrder) {
    EXPECT_TRUE(golden_drop_order({}, {}).empty());
    EXPECT_EQ(golden_drop_order(std::vector<vec3>{vec3(1, 2, 3)}, {}), std::vector<uint32_t>{0});
    const std::vector<vec3> same(100, vec3(1e5f));
    EXPECT_EQ(golden_drop_order(same, {DropPlaces::crown, DropHeight::sine, 0, 0}).size(), 100u);
}

}  // namespace
}  // namespace coppice
