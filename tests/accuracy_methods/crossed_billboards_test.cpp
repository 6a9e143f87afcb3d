#include "tools/accuracy/crossed_billboards.h"

#include <cmath>
#include <numeric>
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/cook/coverage_raster.h"
#include "plugins/vegetation/lod/choose_part.h"
#include "tests/accuracy_methods/packed_shapes.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

using shapes::place_of;

constexpr uint32_t k_side_px = 2048;

// A stem and a crown, wider than deep: its pictures differ from each side.
Plant small_tree() {
    PlantDescription tree;
    tree.name = "tree";
    tree.parts = {shapes::leaf_cloud(900, 1.5f, 0.25f, 3, vec3(0.3f, 3.0f, 0)),
                  shapes::leaf_cloud(300, 0.7f, 0.25f, 4, vec3(-1.5f, 2.0f, 0.2f))};
    tree.parts.emplace_back();
    shapes::add_tube(tree.parts.back(), shapes::straight_path(vec3(0), vec3(0, 3, 0), 9),
                     std::vector<float>(9, 0.1f));
    auto bytes = cook_plant(tree, {});
    EXPECT_TRUE(bytes);
    auto plant =
        load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)), "tree");
    EXPECT_TRUE(plant);
    return std::move(*plant);
}

SubstituteLadder ladder_of(const Plant& plant) {
    auto ladder = make_crossed_billboards_ladder(plant);
    EXPECT_TRUE(ladder) << to_string(ladder.error());
    return std::move(*ladder);
}

// A place of the plant on a picture that looks along `axis`.
vec3 on_picture(const Plant& plant, const PackedVertex& v, int axis, float pixels_per_meter) {
    const vec3 p = (place_of(v) - plant.bounds_plant.center()) * pixels_per_meter;
    return {p[(axis + 1) % 3] + 0.5f * float(k_side_px), p[(axis + 2) % 3] + 0.5f * float(k_side_px),
            p[axis]};
}

float largest_extent_m(const Plant& plant) {
    const vec3 size = plant.bounds_plant.size();
    return std::max({size.x, size.y, size.z});
}

double projected_area_m2(const Plant& plant, int axis) {
    CoverageRaster raster(k_side_px);
    const float pixels_per_meter = 0.98f * float(k_side_px) / largest_extent_m(plant);
    raster.begin();
    for (size_t i = 0; i + 2 < plant.triangle_vertices.size(); i += 3)
        raster.triangle(on_picture(plant, plant.triangle_vertices[i], axis, pixels_per_meter),
                        on_picture(plant, plant.triangle_vertices[i + 1], axis, pixels_per_meter),
                        on_picture(plant, plant.triangle_vertices[i + 2], axis, pixels_per_meter));
    return double(raster.covered()) / double(pixels_per_meter) / double(pixels_per_meter);
}

std::vector<PackedVertex> plane_across(const Plant& billboards, int axis) {
    std::vector<PackedVertex> points;
    for (const PackedVertex& v : billboards.points)
        if (place_of(v)[axis] == billboards.bounds_plant.center()[axis]) points.push_back(v);
    return points;
}

TEST(CrossedBillboards, AreDownToASmallTextureFromEverySide) {
    const Plant tree = small_tree();
    const SubstituteLadder ladder = ladder_of(tree), again = ladder_of(tree);
    ASSERT_EQ(ladder.size(), 2u + k_billboard_octaves * k_billboard_steps);
    EXPECT_EQ(ladder[0].grain_m, 0.0f);
    EXPECT_EQ(ladder[0].plant.triangle_vertices.size(), tree.triangle_vertices.size());
    EXPECT_FLOAT_EQ(ladder[1].grain_m, largest_extent_m(tree) / 128.0f);
    EXPECT_FLOAT_EQ(ladder.back().grain_m, largest_extent_m(tree) / 4.0f);
    for (size_t i = 1; i < ladder.size(); ++i) {
        EXPECT_GT(ladder[i].grain_m, ladder[i - 1].grain_m);
        EXPECT_EQ(ladder[i].plant.bounds_plant.min, tree.bounds_plant.min);
        EXPECT_EQ(ladder[i].plant.content_hash, again[i].plant.content_hash);
        size_t points = 0;
        for (int axis = 0; axis < 3; ++axis) points += plane_across(ladder[i].plant, axis).size();
        EXPECT_GE(points, ladder[i].plant.points.size());
    }
}

// The texels that are opaque cover what the plant covers, from each of the three sides, at every resolution at which
// one texel more or less does not matter.
TEST(CrossedBillboards, TexelsCoverWhatThePlantCovers) {
    const Plant tree = small_tree();
    const SubstituteLadder ladder = ladder_of(tree);
    int checked = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double wanted_m2 = projected_area_m2(tree, axis);
        for (size_t i = 1; i < ladder.size(); ++i) {
            const double texel_m2 = double(ladder[i].grain_m) * double(ladder[i].grain_m);
            const double texels_m2 = double(plane_across(ladder[i].plant, axis).size()) * texel_m2;
            if (texel_m2 > 0.02 * wanted_m2) continue;
            EXPECT_NEAR(texels_m2 / wanted_m2, 1.0, 0.03) << "axis " << axis << ", level " << i;
            ++checked;
        }
    }
    EXPECT_GT(checked, 60);
}

// As the level of detail draws it, a plane's squares laid over the plant seen along its axis.
TEST(CrossedBillboards, DrawnCoverageIsThePlants) {
    const Plant tree = small_tree();
    const SubstituteLadder ladder = ladder_of(tree);
    FrameSettings settings;
    settings.weigh_by_facing = false;
    CoverageRaster raster(k_side_px);
    double error_sum = 0.0;
    int count = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double wanted_m2 = projected_area_m2(tree, axis);
        for (size_t i = 1; i + 1 < ladder.size(); i += 5)
            // From just before the level is left for the next coarser one to just as it is taken.
            for (float fineness : {0.92f, 0.94f, 0.96f, 0.98f, 0.9999f}) {
                const Plant& billboards = ladder[i].plant;
                // As large as the picture holds, so that whole pixels do not decide.
                const float pixels_per_meter = 0.95f * float(k_side_px) / largest_extent_m(tree);
                settings.sample_distance_px = ladder[i].grain_m * pixels_per_meter / fineness;
                const PartChoice choice = choose_part(
                    billboards.parts[0], {vec3(0.6f, 0, -0.8f), pixels_per_meter}, settings, 0.999f);
                EXPECT_EQ(choice.triangles, 0u);
                EXPECT_LE(choice.points, billboards.points.size());
                EXPECT_GE(float(choice.points) + 1.0f, 0.99f * float(billboards.points.size()));
                raster.begin();
                for (uint32_t p = 0; p < choice.points; ++p)
                    if (place_of(billboards.points[p])[axis] == tree.bounds_plant.center()[axis])
                        raster.square(on_picture(tree, billboards.points[p], axis, pixels_per_meter),
                                      choice.splat_px);
                const double drawn_m2 =
                    double(raster.covered()) / double(pixels_per_meter) / double(pixels_per_meter);
                const double error = drawn_m2 / wanted_m2 - 1.0;
                EXPECT_LT(std::fabs(error), 0.15) << "axis " << axis << ", level " << i;
                error_sum += error;
                ++count;
            }
    }
    EXPECT_NEAR(error_sum / count, 0.0, 0.015);
}

// Beyond the coarsest texture points are thinned out, and their squares add up to the same area.
TEST(CrossedBillboards, TheCoarsestKeepsItsAreaFromAnyDistance) {
    const SubstituteLevel coarsest = ladder_of(small_tree()).back();
    const PackedPart& part = coarsest.plant.parts[0];
    FrameSettings settings;
    settings.weigh_by_facing = false;
    for (float texel_px : {1.0f, 0.7f, 0.5f, 0.2f}) {
        const float pixels_per_meter = texel_px / coarsest.grain_m;
        double area_px2 = 0.0;
        for (int i = 0; i < 64; ++i) {
            const PartChoice choice =
                choose_part(part, {vec3(0, 0, -1), pixels_per_meter}, settings, (float(i) + 0.5f) / 64.0f);
            area_px2 += double(choice.points) * double(choice.splat_px) * double(choice.splat_px) / 64.0;
        }
        EXPECT_NEAR(area_px2, double(part.point_count) * double(texel_px) * double(texel_px),
                    0.02 * area_px2);
    }
}

// The mean colour of the points is that of what the picture shows.
TEST(CrossedBillboards, KeepTheColourOfWhatIsSeen) {
    PlantDescription two;
    two.name = "two";
    two.parts.resize(2);
    // Red before green, seen from +z; from -z the picture is the same.
    shapes::add_quad(two.parts[0], vec3(-1, 0, 1), vec3(2, 0, 0), vec3(0, 2, 0), vec3(0.8f, 0.1f, 0.1f));
    shapes::add_quad(two.parts[1], vec3(-1, 0, -1), vec3(2, 0, 0), vec3(0, 4, 0), vec3(0.1f, 0.6f, 0.1f));
    auto bytes = cook_plant(two, {});
    ASSERT_TRUE(bytes);
    auto plant =
        load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(std::move(*bytes)), "two");
    ASSERT_TRUE(plant);
    const SubstituteLadder ladder = ladder_of(*plant);
    for (size_t level : {size_t(1), size_t(9), size_t(17)}) {
        dvec3 color(0.0);
        const auto points = plane_across(ladder.at(level).plant, 2);
        ASSERT_GT(points.size(), 100u);
        for (const PackedVertex& v : points) color += dvec3(decode_surface(v.surface).color_linear);
        color *= 1.0 / double(points.size());
        EXPECT_NEAR(color.x, 0.45, 0.02) << level;
        EXPECT_NEAR(color.y, 0.35, 0.02) << level;
    }
}

TEST(CrossedBillboards, APlantWithoutExtentOrAreaHasItsTrianglesOnly) {
    const std::vector<PackedVertex> dot(3, shapes::packed_vertex({1, 1, 1}));
    EXPECT_EQ(ladder_of(shapes::packed_plant({dot})).size(), 1u);
    const std::vector<PackedVertex> line{shapes::packed_vertex({0, 0, 0}), shapes::packed_vertex({1, 0, 0}),
                                         shapes::packed_vertex({2, 0, 0})};
    EXPECT_EQ(ladder_of(shapes::packed_plant({line})).size(), 1u);
}

}  // namespace
}  // namespace coppice
