#include <algorithm>
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

constexpr uint32_t k_width_one = std::bit_cast<uint32_t>(1.0f);  // of a line: its width over the part's mean

TEST_F(RasterTest, APointOfOnePixelCoversThePixelItLiesIn) {
    PartChoice choice;
    choice.points = 3;
    choice.splat_px = 1.0f;
    draw({at(10.5f, 20.5f, 50.0f), at(100.25f, 7.75f, 9.0f), at(-5.0f, 9.0f, 9.0f)}, choice);
    EXPECT_EQ(covered(), 2u);
    EXPECT_NE(word(10, 20), 0u);
    EXPECT_NE(word(100, 7), 0u);
    EXPECT_NEAR(depth(10, 20), 0.1f / 50.0f, 1e-7f);
}

// The mean number of pixels is the square of the side, below and above a pixel and by group or by lane.
TEST_F(RasterTest, SplatsCoverTheirAreaInTheMean) {
    for (float side : {0.3f, 0.8f, 1.0f, 1.3f, 2.0f, 2.7f, 5.5f})
        for (uint32_t run : {400u, 16u}) {
            Random random(uint64_t(side * 10.0f));
            std::vector<PackedVertex> points;
            double expected = 0.0;
            // Far enough apart that no two overlap.
            for (float y = 8.0f; y < 248.0f; y += 12.0f)
                for (float x = 8.0f; x < 248.0f; x += 12.0f) {
                    points.push_back(
                        at(x + random.next_unit(), y + random.next_unit(), random.next_in(1.0f, 300.0f)));
                    expected += side * side;
                }
            ASSERT_EQ(points.size(), 400u);
            ASSERT_TRUE(rasteriser_->set_geometry({points, {}}));
            work_.begin(1);
            uint32_t instance = work_.part(0).add_instance({});
            for (uint32_t first = 0; first < points.size(); first += run) {
                PartChoice choice;
                choice.points = run;
                choice.splat_px = side;
                work_.part(0).add({0, first, 0, 0}, choice, instance);
            }
            draw_work();
            double spread = 3.0 * std::sqrt(double(points.size())) * std::max(side, 0.5f);
            EXPECT_NEAR(double(covered()), expected, spread) << side << " " << run;
        }
}

TEST_F(RasterTest, BlendedPointsLeaveOutThoseOfDrawnTriangles) {
    std::vector<PackedVertex> points;
    std::vector<uint32_t> owners;
    for (uint32_t i = 0; i < 100; ++i) {
        points.push_back(at(float(i) + 20.5f, 30.5f, 10.0f));
        owners.push_back((i * 37) % 50);
    }
    PartChoice choice;
    choice.points = 100;
    choice.point_owner_min = 20;
    choice.splat_px = 1.0f;
    draw(points, choice, owners);
    for (uint32_t i = 0; i < 100; ++i) EXPECT_EQ(word(i + 20, 30) != 0, owners[i] >= 20) << i;
}

TEST_F(RasterTest, LinesCoverLengthTimesWidthInTheMean) {
    for (float width : {0.4f, 1.0f, 1.7f, 4.0f})
        for (float length : {2.5f, 9.0f}) {
            Random random(11);
            std::vector<PackedVertex> ends;
            for (float y = 10.0f; y < 240.0f; y += 18.0f)
                for (float x = 10.0f; x < 240.0f; x += 18.0f) {
                    float angle = random.next_in(0.0f, 6.283f), cx = x + random.next_unit(),
                          cy = y + random.next_unit();
                    float dx = 0.5f * length * portable_cos(angle), dy = 0.5f * length * portable_sin(angle);
                    ends.push_back(at(cx - dx, cy - dy, 20.0f));
                    ends.push_back(at(cx + dx, cy + dy, 20.0f, k_width_one));
                }
            PartChoice choice;
            choice.lines = uint32_t(ends.size() / 2);
            choice.line_width_px = width;
            draw(ends, choice);
            double expected = double(choice.lines) * length * width;
            EXPECT_NEAR(double(covered()) / expected, 1.0, 0.08) << width << " " << length;
        }
}

TEST_F(RasterTest, LinesAreCutAtTheNearPlane) {
    PackedVertex behind{0.0f, -1.0f, 5.0f, 1u}, ahead{0.0f, -1.0f, -50.0f, k_width_one};
    PartChoice choice;
    choice.lines = 1;
    choice.line_width_px = 1.0f;
    draw({behind, ahead}, choice);
    // From (0, -1, -50), 2.56 px under the centre, straight down to the picture's border.
    EXPECT_NEAR(double(covered()), 128.0 - 2.56, 2.0);
    EXPECT_NE(word(128, 250) | word(127, 250), 0u);
}

// Two triangles a cell over a grid of random corners: every pixel inside is covered, in all sizes and by both kernels.
TEST_F(RasterTest, MeshesHaveNoHoles) {
    for (int cells : {3, 16, 100}) {
        Random random{uint64_t(cells)};
        float step = 200.0f / float(cells);
        std::vector<vec2> corners;
        for (int y = 0; y <= cells; ++y)
            for (int x = 0; x <= cells; ++x) {
                bool border = x == 0 || y == 0 || x == cells || y == cells;
                float jitter = border ? 0.0f : 0.35f * step;
                corners.push_back(vec2(28.0f + step * float(x) + jitter * random.next_in(-1, 1),
                                       28.0f + step * float(y) + jitter * random.next_in(-1, 1)));
            }
        std::vector<PackedVertex> vertices;
        auto push = [&](int x, int y) {
            vec2 c = corners[size_t(y * (cells + 1) + x)];
            vertices.push_back(at(c.x, c.y, 40.0f));
        };
        for (int y = 0; y < cells; ++y)
            for (int x = 0; x < cells; ++x) {
                push(x, y), push(x + 1, y), push(x, y + 1);
                push(x + 1, y + 1), push(x, y + 1), push(x + 1, y);
            }
        PartChoice choice;
        choice.triangles = uint32_t(vertices.size() / 3);
        draw(vertices, choice);
        for (uint32_t y = 28; y < 228; ++y)
            for (uint32_t x = 28; x < 228; ++x)
                if (word(x, y) == 0 && x > 28 && y > 28 && x < 227 && y < 227)
                    ADD_FAILURE() << "hole at " << x << "," << y << " with " << cells << " cells";
        EXPECT_NEAR(double(covered()), 200.0 * 200.0, 401.0);
    }
}

TEST_F(RasterTest, SmallTrianglesCoverTheirAreaInTheMean) {
    for (float side : {0.7f, 2.0f, 9.0f}) {
        Random random(5);
        std::vector<PackedVertex> vertices;
        double expected = 0.0;
        for (float y = 12.0f; y < 240.0f; y += 12.0f)
            for (float x = 12.0f; x < 240.0f; x += 12.0f) {
                float angle = random.next_in(0.0f, 6.283f), cx = x + random.next_unit(),
                      cy = y + random.next_unit();
                for (int v = 0; v < 3; ++v) {
                    float a = angle + 2.0943951f * float(v);
                    vertices.push_back(at(cx + side * 0.57735f * portable_cos(a),
                                          cy + side * 0.57735f * portable_sin(a), 9.0f));
                }
                expected += 0.4330127 * side * side;
            }
        PartChoice choice;
        choice.triangles = uint32_t(vertices.size() / 3);
        draw(vertices, choice);
        EXPECT_NEAR(double(covered()), expected, 4.0 * std::sqrt(expected)) << side;
    }
}

// A ground plane that runs under the viewer: everything under the horizon is covered, right up to the lower border.
TEST_F(RasterTest, TrianglesAreCutAtTheNearPlane) {
    float y = -1.5f, far = 10000.0f;
    std::vector<PackedVertex> vertices = {{-far, y, far, 1u}, {far, y, far, 1u},   {-far, y, -far, 1u},
                                          {far, y, -far, 1u}, {-far, y, -far, 1u}, {far, y, far, 1u}};
    PartChoice choice;
    choice.triangles = 2;
    draw(vertices, choice);
    for (uint32_t x = 0; x < k_side; ++x) {
        EXPECT_EQ(word(x, 126), 0u);
        for (uint32_t row = 130; row < k_side; ++row) ASSERT_NE(word(x, row), 0u) << x << "," << row;
    }
    EXPECT_NEAR(depth(128, 255) * 1.5f / 0.1f, 127.5f / 128.0f, 1e-3f);  // near / w, w = 1.5 m * 128 / 127.5
}

TEST_F(RasterTest, TheNearestSurfaceWinsInAnyOrder) {
    Random random(9);
    std::vector<PackedVertex> points;
    for (int i = 0; i < 20000; ++i)
        points.push_back(
            at(random.next_in(0, 64), random.next_in(0, 64), random.next_in(1, 100), uint32_t(i)));
    PartChoice choice;
    choice.points = uint32_t(points.size());
    choice.splat_px = 1.3f;
    draw(points, choice);
    std::vector<uint64_t> first = words_;
    std::reverse(points.begin(), points.end());
    draw(points, choice);
    EXPECT_EQ(first, words_);
    EXPECT_GT(covered(), 64u * 60u);
}

TEST_F(RasterTest, EverythingBehindOrBesideLeavesThePictureEmpty) {
    std::vector<PackedVertex> vertices;
    Random random(4);
    for (int i = 0; i < 300; ++i)
        vertices.push_back({random.next_in(-9, 9), random.next_in(-9, 9), random.next_in(0.0f, 9.0f), 1u});
    for (int i = 0; i < 300; ++i)
        vertices.push_back(
            {random.next_in(20, 29), random.next_in(-9, 9), random.next_in(-15.0f, 0.0f), k_width_one});
    PartChoice choice;
    choice.triangles = 200;
    choice.points = 600;
    choice.lines = 300;
    choice.splat_px = choice.line_width_px = 1.0f;
    draw(vertices, choice);
    EXPECT_EQ(covered(), 0u);
}

TEST_F(RasterTest, SizesFromOnePixelToMany) {
    for (auto [width, height] : {std::pair(1u, 1u), std::pair(3u, 2u), std::pair(1500u, 40u)}) {
        ASSERT_TRUE(rasteriser_->resize(width, height));
        PartChoice choice;
        choice.points = 1;
        choice.splat_px = 1.0f;
        draw({{0.001f, 0.001f, -5.0f, 1u}}, choice);
        EXPECT_EQ(covered(), 1u) << width;
    }
    EXPECT_FALSE(rasteriser_->resize(0, 5));
    EXPECT_FALSE(rasteriser_->resize(5, 20000));
}

}  // namespace
}  // namespace coppice
