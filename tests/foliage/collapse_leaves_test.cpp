// A crown with fewer leaves keeps what is seen of it.
#include "plugins/vegetation/cook/collapse_leaves.h"

#include <gtest/gtest.h>
#include <cstring>
#include <functional>
#include "plugins/vegetation/cook/coverage_raster.h"
#include "plugins/vegetation/lod/leaf_lifetimes.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "tests/foliage/made_crown.h"

namespace coppice {
namespace {

void expect_sound(const std::vector<Leaf>& crown, const std::vector<LeafCollapse>& collapses) {
    const Status status = check_collapses(uint32_t(crown.size()), collapses, "made");
    ASSERT_TRUE(status) << to_string(status.error());
    float error_m = 0.0f;
    for (const LeafCollapse& c : collapses) {
        EXPECT_GE(c.error_m, error_m);
        error_m = c.error_m;
        EXPECT_NEAR(glm::length(c.normal_plant), 1.0f, 1e-4f);
        for (vec3 corner : collapsed_leaf(crown, c).corners_plant) EXPECT_TRUE(is_finite(corner));
    }
}

// Sums over the leaves at every level, from the full crown on.
template <class Sum>
std::vector<Sum> by_level(const std::vector<Leaf>& crown, const std::vector<LeafCollapse>& collapses,
                          const std::function<Sum(const Leaf&)>& term) {
    std::vector<Sum> terms;
    Sum sum(0);
    for (const Leaf& leaf : crown) terms.push_back(term(leaf)), sum += terms.back();
    std::vector<Sum> sums{sum};
    for (const LeafCollapse& c : collapses) {
        terms.push_back(term(collapsed_leaf(crown, c)));
        sum += terms.back() - terms[c.removed[0]] - terms[c.removed[1]];
        sums.push_back(sum);
    }
    return sums;
}

TEST(CollapseLeaves, EveryLevelHasTheCrownsAreaAndColor) {
    const std::vector<Leaf> crown = made_crown(3000, 1);
    const std::vector<LeafCollapse> collapses = collapse_leaves(crown, {.least_area = 1.0f});
    ASSERT_EQ(collapses.size(), crown.size() - 1);
    expect_sound(crown, collapses);
    const auto areas = by_level<double>(crown, collapses, leaf_area_m2);
    const auto colors = by_level<dvec3>(
        crown, collapses, [](const Leaf& leaf) { return dvec3(leaf.color_linear) * leaf_area_m2(leaf); });
    for (size_t level = 0; level < areas.size(); ++level) {
        ASSERT_NEAR(areas[level] / areas[0], 1.0, 1e-3) << "level " << level;
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(colors[level][c] / colors[0][c], 1.0, 1e-3) << "level " << level;
    }
}

// Pixels covered from `count` directions, by the rules of the kernels.
std::vector<double> covered_pixels(const std::vector<Leaf>& leaves, const Box& box, int count) {
    constexpr float k_side_px = 700.0f;
    const float scale = 0.8f * k_side_px / glm::length(box.size());
    std::vector<double> covered;
    Random random(77);
    CoverageRaster raster{uint32_t(k_side_px)};
    for (int i = 0; i < count; ++i) {
        const vec3 d = any_direction(random), x = perpendicular_to(d), y = glm::cross(d, x);
        raster.begin();
        for (const Leaf& leaf : leaves) {
            vec3 p[4];
            for (size_t k = 0; k < 4; ++k) {
                const vec3 away = (leaf.corners_plant[k] - box.center()) * scale;
                p[k] = vec3(glm::dot(away, x), glm::dot(away, y), 0.0f) + 0.5f * k_side_px;
            }
            raster.triangle(p[0], p[1], p[2]);
            raster.triangle(p[0], p[2], p[3]);
        }
        covered.push_back(double(raster.covered()));
    }
    return covered;
}

// How brightly the crown is lit from a side, by the normals its leaves store; in the mean over its area.
double mean_facing(const std::vector<Leaf>& leaves, vec3 to_light) {
    double sum = 0.0, area_m2 = 0.0;
    for (const Leaf& leaf : leaves) {
        sum += leaf_area_m2(leaf) * double(std::fabs(glm::dot(leaf.normal_plant, to_light)));
        area_m2 += leaf_area_m2(leaf);
    }
    return sum / area_m2;
}

double area_m2(const std::vector<Leaf>& leaves) {
    double sum = 0.0;
    for (const Leaf& leaf : leaves) sum += leaf_area_m2(leaf);
    return sum;
}

// The crown at levels down to a twentieth of its leaves, each beside the full crown's coverage from 16 sides.
void expect_kept(const std::vector<Leaf>& crown, double coverage_tolerance,
                 const std::function<void(const std::vector<Leaf>&)>& expect_more) {
    const std::vector<LeafCollapse> collapses = collapse_leaves(crown, {});
    const LeafLifetimes lifetimes = order_by_removal(uint32_t(crown.size()), collapses);
    Box box;
    for (const Leaf& leaf : crown)
        for (vec3 corner : leaf.corners_plant) box.include(corner);
    const std::vector<double> full = covered_pixels(crown, box, 16);
    for (double share = 0.93; share >= 0.05; share *= 0.93) {
        const uint32_t level = uint32_t((1.0 - share) * double(crown.size()));
        std::vector<Leaf> leaves;
        for (uint32_t leaf : lifetimes.candidates(level))
            if (lifetimes.is_born(leaf, level))
                leaves.push_back(leaf < crown.size() ? crown[leaf]
                                                     : collapsed_leaf(crown, collapses[leaf - crown.size()]));
        ASSERT_EQ(leaves.size(), crown.size() - level);
        expect_more(leaves);
        const std::vector<double> now = covered_pixels(leaves, box, 16);
        for (size_t i = 0; i < full.size(); ++i)
            EXPECT_NEAR(now[i] / full[i], 1.0, coverage_tolerance)
                << leaves.size() << " leaves, direction " << i;
    }
}

TEST(CollapseLeaves, CoverageAreaAndLightAreTheCrownsDownToATwentieth) {
    const std::vector<Leaf> crown = made_crown(40'000, 3);
    expect_kept(crown, 0.02, [&](const std::vector<Leaf>& leaves) {
        EXPECT_NEAR(area_m2(leaves) / area_m2(crown), 1.0, 0.01);
        for (vec3 to_light : {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)})
            EXPECT_NEAR(mean_facing(leaves, to_light), mean_facing(crown, to_light), 0.01)
                << leaves.size() << " leaves";
    });
}

// Where a hundred leaves on a twig hide each other, no few quads have their area and cover as little.
TEST(CollapseLeaves, WhereBothCannotBeCoverageIsKeptAndAreaGivesWay) {
    const std::vector<Leaf> crown = made_crown(40'000, 3, 8.0f, 120);
    double least = 1.0;
    expect_kept(crown, 0.05, [&](const std::vector<Leaf>& leaves) {
        least = std::min(least, area_m2(leaves) / area_m2(crown));
    });
    EXPECT_LT(least, 0.9) << "the crown is no such case";
}

TEST(CollapseLeaves, SameBytesOnAnyNumberOfThreads) {
    const std::vector<Leaf> crown = made_crown(2000, 2);
    const unsigned limit = thread_limit();
    set_thread_limit(1);
    const std::vector<LeafCollapse> alone = collapse_leaves(crown, {});
    set_thread_limit(7);
    const std::vector<LeafCollapse> together = collapse_leaves(crown, {});
    set_thread_limit(limit);
    ASSERT_EQ(alone.size(), together.size());
    EXPECT_EQ(std::memcmp(alone.data(), together.data(), alone.size() * sizeof(LeafCollapse)), 0);
    // The same from every compiler.
    EXPECT_EQ(hash_to_hex(hash_bytes(alone.data(), alone.size() * sizeof(LeafCollapse))), "08e7f9b8714bb184");
}

TEST(CollapseLeaves, NeighborsAreJoinedFirst) {
    // Two leaves side by side in one plane, a third behind them, a fourth upright, a fifth far away.
    auto square = [](vec3 corner, vec3 u, vec3 v) {
        return Leaf{{corner, corner + u, corner + u + v, corner + v},
                    normalize_or(glm::cross(u, v), vec3(0)),
                    vec3(0.2f)};
    };
    const vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    const std::vector<Leaf> crown{square(vec3(0), x, y), square(vec3(50, 0, 0), x, y),
                                  square(vec3(0, 0, 0.5f), x, y), square(vec3(0), z, y),
                                  square(vec3(1, 0, 0), x, y)};
    const std::vector<LeafCollapse> collapses = collapse_leaves(crown, {});
    ASSERT_EQ(collapses.size(), 4u);
    EXPECT_EQ(collapses[0].removed, (std::array<uint32_t, 2>{0, 4}));
    // They are one rectangle afterwards, and nothing else.
    const Leaf joined = collapsed_leaf(crown, collapses[0]);
    for (vec3 corner : {vec3(0), vec3(2, 0, 0), vec3(2, 1, 0), vec3(0, 1, 0)})
        EXPECT_EQ(std::count(joined.corners_plant.begin(), joined.corners_plant.end(), corner), 1);
    EXPECT_EQ(collapses[3].removed[0], 1u) << "what is far away comes last";
}

TEST(CollapseLeaves, StopsWhereItIsTold) {
    const std::vector<Leaf> crown = made_crown(500, 4);
    EXPECT_EQ(collapse_leaves(crown, {.target_count = 120}).size(), 380u);
    EXPECT_EQ(collapse_leaves(crown, {.target_count = 0}).size(), 499u);
    EXPECT_TRUE(collapse_leaves(crown, {.target_count = 1000}).empty());
    const std::vector<LeafCollapse> all = collapse_leaves(crown, {});
    const float bound_m = all[200].error_m;
    const std::vector<LeafCollapse> some = collapse_leaves(crown, {.max_error_m = bound_m});
    EXPECT_GE(some.size(), 201u);
    EXPECT_LT(some.size(), all.size());
    EXPECT_LE(some.back().error_m, bound_m);
}

TEST(CollapseLeaves, HostileCrownsGetAnAnswer) {
    EXPECT_TRUE(collapse_leaves({}, {}).empty());
    EXPECT_TRUE(collapse_leaves(made_crown(1, 1), {}).empty());

    const Leaf leaf = made_crown(1, 1)[0];
    const std::vector<Leaf> copies(200, leaf);
    const std::vector<LeafCollapse> of_copies = collapse_leaves(copies, {});
    ASSERT_EQ(of_copies.size(), 199u);
    expect_sound(copies, of_copies);
    EXPECT_NEAR(of_copies[0].error_m, 0.0f, 1e-6f);

    std::vector<Leaf> points(100);
    for (size_t i = 0; i < points.size(); ++i)
        points[i] = {
            {vec3(float(i)), vec3(float(i)), vec3(float(i)), vec3(float(i))}, vec3(0, 1, 0), vec3(0.1f)};
    const std::vector<LeafCollapse> of_points = collapse_leaves(points, {});
    ASSERT_EQ(of_points.size(), 99u);
    expect_sound(points, of_points);

    std::vector<Leaf> flat = made_crown(300, 5);
    for (Leaf& l : flat) {
        for (vec3& corner : l.corners_plant) corner.y = 0.0f;
        l.normal_plant = vec3(0, 1, 0);
    }
    const std::vector<LeafCollapse> of_flat = collapse_leaves(flat, {});
    ASSERT_EQ(of_flat.size(), 299u);
    expect_sound(flat, of_flat);
    for (const LeafCollapse& c : of_flat) EXPECT_NEAR(std::fabs(c.normal_plant.y), 1.0f, 1e-5f);

    // As far from the origin as a plant may reach, and one leaf as large as the rest is small.
    std::vector<Leaf> far = made_crown(100, 6);
    for (Leaf& l : far)
        for (vec3& corner : l.corners_plant) corner += vec3(1e5f, 0, -1e5f);
    far.push_back({{vec3(-1e5f), vec3(1e5f, -1e5f, -1e5f), vec3(1e5f), vec3(-1e5f, 1e5f, 1e5f)},
                   vec3(0, 1, 0),
                   vec3(0.1f)});
    const std::vector<LeafCollapse> of_far = collapse_leaves(far, {});
    ASSERT_EQ(of_far.size(), 100u);
    expect_sound(far, of_far);
}

}  // namespace
}  // namespace coppice
