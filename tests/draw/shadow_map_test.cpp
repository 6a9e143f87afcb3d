// Primitives drawn into a shadow map, and what the picture makes of it.
#include <algorithm>
#include <cmath>
#include "plugins/vegetation/plant/surface.h"
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

constexpr uint32_t k_map_side = 256;
constexpr float k_half_m = 16.0f;  // the map shows so much around its middle, in which the viewer is

class ShadowMapTest : public RasterTest {
  protected:
    // Across the sun, 8 texels a metre; warp: how much w grows a metre along the map's rows.
    void look_from(vec3 to_sun, float warp = 0.0f) {
        light_.direction_to_sun = to_sun_ = normalize_or(to_sun, vec3(0, 1, 0));
        across_ = perpendicular_to(to_sun_);
        along_ = glm::cross(to_sun_, across_);
        const float texels = float(k_map_side) / (2.0f * k_half_m), middle = 0.5f * float(k_map_side);
        ShadowView& view = view_;
        view.row_w = vec4(along_ * warp, 1.0f);
        view.row_x = vec4(across_ * texels, 0.0f) + view.row_w * middle;
        view.row_y = vec4(along_ * texels, 0.0f) + view.row_w * middle;
        view.row_z = vec4(to_sun_ * (0.5f / (2.0f * k_half_m)), 0.0f) + view.row_w * 0.5f;
        view.least_w = 0.1f;
        shadow_.side_texels = k_map_side;
        drawn_ = {{0, view_, vec4(0, 0, -1, 1)}};
        shadow_.drawn = drawn_;
        shadow_.seen = {&view_, 1};
    }
    PackedVertex place(float across_m, float along_m, float sunwards_m, uint32_t surface = 1u) const {
        const vec3 p = across_ * across_m + along_ * along_m + to_sun_ * sunwards_m;
        return {p.x, p.y, p.z, surface};
    }
    void cast(const std::vector<PackedVertex>& vertices, const PartChoice& choice,
              const WorkInstance& instance = {}) {
        work_.begin(1, k_one_part);
        // A caster's sizes are told in the picture's pixels, here a hundredth of a metre.
        work_.part(1).add({}, choice, work_.part(1).add_instance(instance), 0.0f, 0, 100.0f);
        ASSERT_TRUE(rasteriser_->set_geometry({vertices, {}}));
        draw_work();
        read_map();
    }
    void read_map() {
        map_.resize(size_t(k_map_side) * k_map_side);
        ASSERT_TRUE(
            gpu::read_now(*device_, rasteriser_->shadow_maps(), 0, std::as_writable_bytes(std::span(map_))));
    }
    float depth_at(uint32_t column, uint32_t row) const { return map_[size_t(row) * k_map_side + column]; }
    double covered_texels() const {
        return double(std::count_if(map_.begin(), map_.end(), [](float depth) { return depth > 0.0f; }));
    }

    static constexpr size_t k_one_part[] = {1};
    vec3 to_sun_, across_, along_;
    ShadowView view_{};
    std::vector<ShadowMapDraw> drawn_;
    std::vector<float> map_;
};

TEST_F(ShadowMapTest, ATriangleCoversItsAreaAtItsDepth) {
    look_from(vec3(0.4f, 0.8f, -0.3f));
    PartChoice choice;
    choice.triangles = 1;
    cast({place(-10, -10, 3), place(10, -10, 3), place(-10, 10, 7)}, choice);
    EXPECT_NEAR(covered_texels(), 0.5 * 160.0 * 160.0, 200.0);
    for (uint32_t row = 50; row < 100; row += 7)
        for (uint32_t column = 50; column < 100; column += 7) {
            const float along_m = (float(row) + 0.5f) / 8.0f - k_half_m;
            const float sunwards_m = 3.0f + 4.0f * (along_m + 10.0f) / 20.0f;
            EXPECT_NEAR(depth_at(column, row), 0.5f + sunwards_m / (4.0f * k_half_m), 1e-5f);
        }
    // Turned away from the sun it hides as much.
    cast({place(-10, -10, 3), place(-10, 10, 7), place(10, -10, 3)}, choice);
    EXPECT_NEAR(covered_texels(), 0.5 * 160.0 * 160.0, 200.0);
}

// A triangle so large that a group's lanes share it, and one of many that do not, with a warped map: texels of a row lie on a line.
TEST_F(ShadowMapTest, LargeAndSmallTrianglesAgreeOnDepths) {
    look_from(vec3(0.4f, 0.8f, -0.3f), 0.02f);
    const auto corner = [&](float u, float v) { return place(-12 + 24 * u, -12 + 24 * v, -6 + 9 * u + 5 * v); };
    PartChoice choice;
    choice.triangles = 2;
    cast({corner(0, 0), corner(1, 0), corner(0, 1), corner(0, 1), corner(1, 0), corner(1, 1)}, choice);
    const std::vector<float> large = map_;
    constexpr int k_cells = 24;
    std::vector<PackedVertex> pieces;
    for (int j = 0; j < k_cells; ++j)
        for (int i = 0; i < k_cells; ++i) {
            const float u0 = float(i) / k_cells, v0 = float(j) / k_cells;
            const float u1 = float(i + 1) / k_cells, v1 = float(j + 1) / k_cells;
            for (const PackedVertex& v : {corner(u0, v0), corner(u1, v0), corner(u0, v1), corner(u0, v1),
                                          corner(u1, v0), corner(u1, v1)})
                pieces.push_back(v);
        }
    choice.triangles = 2 * k_cells * k_cells;
    cast(pieces, choice);
    size_t both = 0, differ = 0;
    for (size_t i = 0; i < map_.size(); ++i) {
        differ += (map_[i] > 0.0f) != (large[i] > 0.0f);
        if (map_[i] == 0.0f || large[i] == 0.0f) continue;
        ++both;
        ASSERT_NEAR(map_[i], large[i], 2e-4f) << i;
    }
    EXPECT_GT(both, 20000u);
    EXPECT_LT(differ, 10u);
}

// A point is a square of leaf: it hides its area times the cosine between its normal and the sun, in a map that is warped too.
TEST_F(ShadowMapTest, PointsCoverWhatTheyShowTheSun) {
    for (const float warp : {0.0f, 0.02f})
        for (const float side_m : {0.05f, 0.2f, 0.6f})
            for (const bool by_facing : {false, true}) {
                look_from(vec3(0.3f, 0.7f, 0.5f), warp);
                Random random(11);
                std::vector<PackedVertex> points;
                double expected = 0.0;
                for (float y = -12.0f; y < 12.0f; y += 1.0f)
                    for (float x = -11.0f; x < 11.0f; x += 1.0f) {
                        const vec3 normal = normalize_or(
                            vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)), to_sun_);
                        const float along_m = y + random.next_in(0.0f, 0.3f);
                        points.push_back(place(x + random.next_in(0.0f, 0.3f), along_m, random.next_in(-9, 9),
                                               encode_surface({normal, vec3(0.5f), 1.0f, true}, 0)));
                        const double w = 1.0 + warp * along_m;
                        // Rows shrink as 1 / w twice: once for the place, once for how it moves.
                        const double texels = 64.0 / (w * w * w);
                        const double facing = std::fabs(glm::dot(
                            decode_surface(points.back().surface).normal, to_sun_));
                        expected += side_m * side_m * texels * (by_facing ? facing : 1.0);
                    }
                PartChoice choice;
                choice.points = uint32_t(points.size());
                choice.splat_px = side_m * 100.0f;
                choice.mean_facing = by_facing ? 0.5f : 0.0f;
                cast(points, choice);
                const double spread = 3.0 * std::sqrt(double(points.size())) * std::max(1.0, side_m * 8.0);
                EXPECT_NEAR(covered_texels(), expected, spread) << warp << ' ' << side_m << ' ' << by_facing;
                EXPECT_GT(covered_texels(), 0.5 * expected);
            }
}

TEST_F(ShadowMapTest, LinesCoverTheirWidthTimesTheirLengthAcrossTheSun) {
    for (const float warp : {0.0f, 0.02f})
        for (const float width_m : {0.03f, 0.3f}) {
            look_from(vec3(-0.3f, 0.6f, 0.4f), warp);
            Random random(5);
            std::vector<PackedVertex> ends;
            double expected = 0.0;
            for (float y = -12.0f; y < 12.0f; y += 3.0f)
                for (float x = -12.0f; x < 12.0f; x += 3.0f) {
                    const vec2 along(random.next_in(-1, 1), random.next_in(-1, 1));
                    ends.push_back(place(x, y, 2));
                    ends.push_back(place(x + along.x, y + along.y, 2.0f + random.next_in(-1, 1)));
                    ends.back().surface = std::bit_cast<uint32_t>(1.0f);
                    const double w = 1.0 + warp * (y + 0.5 * along.y);
                    expected += width_m * glm::length(along) * 64.0 / (w * w * w);
                }
            PartChoice choice;
            choice.lines = uint32_t(ends.size() / 2);
            choice.line_width_px = width_m * 100.0f;
            cast(ends, choice);
            EXPECT_NEAR(covered_texels(), expected, 0.05 * expected + 3.0 * std::sqrt(expected))
                << warp << ' ' << width_m;
        }
}

// A plant's scale and turn hold in the map as well.
TEST_F(ShadowMapTest, InstancesAreScaledAndTurned) {
    look_from(vec3(0, 1, 0));
    WorkInstance instance;
    instance.x_camera = across_.x * 4.0f;
    instance.z_camera = across_.z * 4.0f;
    instance.scale = 3.0f;
    PartChoice choice;
    choice.points = 1;
    choice.splat_px = 50.0f;
    cast({PackedVertex{0, 0, 0, 1u}}, choice, instance);
    EXPECT_NEAR(covered_texels(), 1.5 * 1.5 * 64.0, 26.0);
    EXPECT_GT(depth_at(uint32_t((k_half_m + 4.0f) * 8.0f), uint32_t(k_half_m * 8.0f)), 0.0f);
}

// A wall that faces viewer and sun, and a square in front of it, beside the view: its shadow falls where geometry says, and no
// speckle of the wall's own lies beside it.
TEST_F(ShadowMapTest, ShadowsFallWhereRaysSay) {
    const vec3 to_sun = normalize_or(vec3(-0.5f, 0.3f, 1.0f), vec3(0.0f));
    const uint32_t grey = encode_surface({vec3(0, 0, 1), vec3(0.5f), 1.0f, false}, 0);
    auto wall_at = [&](float x, float y, float z) { return PackedVertex{x, y, z, grey}; };
    const std::vector<PackedVertex> vertices{
        wall_at(-9, -9, -8), wall_at(9, -9, -8), wall_at(9, 9, -8),  wall_at(-9, -9, -8),
        wall_at(9, 9, -8),   wall_at(-9, 9, -8),  wall_at(-5, -1, -2), wall_at(-3, -1, -2),
        wall_at(-3, 1, -2),  wall_at(-5, -1, -2), wall_at(-3, 1, -2), wall_at(-5, 1, -2)};
    auto picture = [&](bool with_casters) {
        work_.begin(1, k_one_part);
        PartChoice wall, both;
        wall.triangles = 2;
        both.triangles = 4;
        work_.part(0).add({}, wall, work_.part(0).add_instance({}));
        if (with_casters) work_.part(1).add({}, both, work_.part(1).add_instance({}), 0.0f, 0, 100.0f);
        EXPECT_TRUE(rasteriser_->set_geometry({vertices, {}}));
        draw_work();
        return colors();
    };
    for (const float warp : {0.0f, 0.01f}) {
        look_from(to_sun, warp);
        const std::vector<uint32_t> open = picture(false), shadowed = picture(true);
        size_t dark = 0, wrong = 0;
        for (uint32_t row = 1; row + 1 < k_side; ++row)
            for (uint32_t column = 1; column + 1 < k_side; ++column) {
                const vec3 on_wall((float(column) + 0.5f - 128.0f) / 16.0f, (128.0f - float(row) - 0.5f) / 16.0f, -8);
                const vec3 at_square = on_wall + to_sun * (6.0f / to_sun.z);
                const float inside = std::min(1.0f - std::fabs(at_square.x + 4.0f), 1.0f - std::fabs(at_square.y));
                if (std::fabs(inside) < 0.3f) continue;  // a texel is an eighth of a metre
                const bool is_dark = shadowed[row * k_side + column] != open[row * k_side + column];
                wrong += is_dark != (inside > 0.0f);
                dark += is_dark;
            }
        EXPECT_EQ(wrong, 0u) << warp;
        EXPECT_GT(dark, 300u);
    }
}

// Of three nested maps two are drawn in one frame, the third in the next: none touches another's texels, and each place is looked up
// in the map for its distance.
TEST_F(ShadowMapTest, NestedMapsAreDrawnApartAndLookedUpByDistance) {
    const vec3 to_sun = normalize_or(vec3(-0.5f, 0.3f, 1.0f), vec3(0.0f));
    look_from(to_sun);
    map_count_ = 3;
    const uint32_t grey = encode_surface({vec3(0, 0, 1), vec3(0.5f), 1.0f, false}, 0);
    auto square = [&](vec3 middle, float half) {
        std::vector<PackedVertex> corners;
        for (auto [x, y] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, -1),
                            std::pair(1, 1), std::pair(-1, 1)})
            corners.push_back({middle.x + float(x) * half, middle.y + float(y) * half, middle.z, grey});
        return corners;
    };
    // Walls at 4, 8 and 16 m side by side, each with a square before it.
    std::vector<PackedVertex> vertices;
    const vec3 walls[] = {vec3(-2.4f, 0, -4), vec3(0, 0, -8), vec3(9.6f, 0, -16)};
    for (int i = 0; i < 3; ++i)
        for (const PackedVertex& corner : square(walls[i], 0.2f * -walls[i].z)) vertices.push_back(corner);
    for (int i = 0; i < 3; ++i)
        for (const PackedVertex& corner : square(walls[i] + to_sun * 1.5f, 0.05f * -walls[i].z))
            vertices.push_back(corner);
    // The same map at three scales.
    ShadowView views[3];
    for (int i = 0; i < 3; ++i) {
        const float texels = 24.0f / float(1 << i);
        views[i].row_x = vec4(across_ * texels, 128.0f);
        views[i].row_y = vec4(along_ * texels, 128.0f);
        views[i].row_z = vec4(to_sun_ / 80.0f, 0.25f);
        views[i].row_w = vec4(0, 0, 0, 1);
        views[i].least_w = 0.5f;
    }
    shadow_.seen = views;
    shadow_.first_reach_m = 6.0f;
    shadow_.first_texel_m = 1.0f / 24.0f;
    ASSERT_TRUE(rasteriser_->set_geometry({vertices, {}}));
    PartChoice three;
    three.triangles = 6;
    // The squares alone: walls would shadow each other.
    PartGeometry squares{};
    squares.first_triangle_vertex = 18;
    auto frame = [&](std::vector<uint32_t> maps) {
        drawn_.clear();
        for (uint32_t map : maps) drawn_.push_back({map, views[map], vec4(0, 0, 0, 1), 1.0f});
        shadow_.drawn = drawn_;
        const std::vector<size_t> parts(maps.size(), 1);
        work_.begin(1, parts);
        work_.part(0).add({}, three, work_.part(0).add_instance({}));
        for (size_t i = 0; i < maps.size(); ++i)
            work_.part(1 + i).add(squares, three, work_.part(1 + i).add_instance({}), 0.0f, 0, 100.0f);
        draw_work();
        return colors();
    };
    auto texels = [&] {
        std::vector<float> all(size_t(3) * k_map_side * k_map_side);
        EXPECT_TRUE(gpu::read_now(*device_, rasteriser_->shadow_maps(), 0,
                                  std::as_writable_bytes(std::span(all))));
        return all;
    };
    auto covered = [](std::span<const float> map) {
        return std::count_if(map.begin(), map.end(), [](float depth) { return depth > 0.0f; });
    };
    const size_t size = size_t(k_map_side) * k_map_side;
    frame({0, 2});
    const std::vector<float> two = texels();
    const std::vector<uint32_t> shadowed = frame({1});
    const std::vector<float> all = texels();
    EXPECT_TRUE(std::equal(two.begin(), two.begin() + size, all.begin()));
    EXPECT_TRUE(std::equal(two.begin() + 2 * size, two.end(), all.begin() + 2 * size));
    EXPECT_NEAR(double(covered(std::span(all).subspan(size, size))),
                4.0 * double(covered(std::span(all).subspan(2 * size))), 600.0);
    EXPECT_GT(covered(std::span(all).first(size)), 1000);
    // Each wall has its square's shadow where rays say.
    shadow_.side_texels = 0;
    shadow_.drawn = {};
    work_.begin(1);
    work_.part(0).add({}, three, work_.part(0).add_instance({}));
    draw_work();
    const std::vector<uint32_t> open = colors();
    size_t dark = 0, wrong = 0;
    for (const vec3& wall : walls)
        for (float v = -0.1f; v < 0.1f; v += 0.004f)
            for (float u = -0.1f; u < 0.1f; u += 0.004f) {
                // The square's shadow lies in the wall's middle.
                const vec3 on_wall = wall + vec3(u, v, 0) * -wall.z;
                const float inside = (0.05f - std::max(std::fabs(u), std::fabs(v))) * -wall.z;
                const float texel_m = on_wall.z > -6.0f ? 1.0f / 24.0f : on_wall.z > -12.0f ? 1.0f / 12.0f : 1.0f / 6.0f;
                if (std::fabs(inside) < 2.5f * texel_m) continue;
                const uint32_t column = uint32_t(128.0f + on_wall.x * 128.0f / -on_wall.z);
                const uint32_t row = uint32_t(128.0f - on_wall.y * 128.0f / -on_wall.z);
                const bool is_dark = shadowed[row * k_side + column] != open[row * k_side + column];
                wrong += is_dark != (inside > 0.0f);
                dark += is_dark;
            }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(dark, 100u);
}

TEST_F(ShadowMapTest, WithoutShadowsThereIsNoMapAndNoPass) {
    PartChoice choice;
    choice.triangles = 1;
    draw({at(10, 10, 5), at(100, 10, 5), at(10, 100, 5)}, choice);
    const uint64_t bytes_before = rasteriser_->gpu_bytes();
    EXPECT_LE(rasteriser_->shadow_maps().size_bytes(), 16u);
    look_from(vec3(0, 1, 0));
    cast({place(-9, -9, 0), place(9, -9, 0), place(-9, 9, 0)}, choice);
    EXPECT_EQ(rasteriser_->shadow_maps().size_bytes(), uint64_t(k_map_side) * k_map_side * 4);
    EXPECT_GT(rasteriser_->gpu_bytes(), bytes_before);
    // Off again, nothing of it is left, not even the number of large triangles of the last frame that had one.
    shadow_ = {};
    for (int frame = 0; frame < 3; ++frame) {
        draw({at(10, 10, 5), at(100, 10, 5), at(10, 100, 5)}, choice);
        EXPECT_EQ(rasteriser_->dropped_triangles(), 0u);
    }
    EXPECT_EQ(rasteriser_->gpu_bytes(), bytes_before);
    EXPECT_FALSE(rasteriser_->make_shadow_maps(20000, 1));
    EXPECT_FALSE(rasteriser_->make_shadow_maps(256, k_most_work_maps + 1));
}

}  // namespace
}  // namespace coppice
