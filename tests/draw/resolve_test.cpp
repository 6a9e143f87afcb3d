// From the visibility buffer to the picture: the filter over neighbours, the mean of frames, and the view that shows
// plants alone.
#include <algorithm>
#include "plugins/vegetation/plant/surface.h"
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

class ResolveTest : public RasterTest {
  protected:
    void SetUp() override {
        RasterTest::SetUp();
        picture_.view = RepresentationView::coverage;
    }

    // A point in the middle of each pixel of the list.
    void draw_pixels(const std::vector<std::pair<uint32_t, uint32_t>>& pixels) {
        const float half_width = 0.5f * float(rasteriser_->width()),
                    half_height = 0.5f * float(rasteriser_->height()), z = 10.0f;
        std::vector<PackedVertex> points;
        for (auto [x, y] : pixels)
            points.push_back({(float(x) + 0.5f - half_width) * z / half_height,
                              (half_height - float(y) - 0.5f) * z / half_height, -z, 1u});
        PartChoice choice;
        choice.points = uint32_t(points.size());
        choice.splat_px = 1.0f;
        draw(points, choice);
        ASSERT_EQ(covered(), pixels.size());
    }
    // Whether each pixel shows something, 0 or 1.
    std::vector<float> samples() const {
        std::vector<float> values;
        for (uint64_t w : words_) values.push_back(w != 0 ? 1.0f : 0.0f);
        return values;
    }
    // Of the picture's coverage, linear.
    std::vector<float> shares() const {
        std::vector<float> values;
        for (uint32_t rgba : colors()) values.push_back(srgb_to_linear(float(rgba & 255u) / 255.0f));
        return values;
    }
    // Gray and opaque everywhere, and within rounding what is wanted.
    void expect_coverage(const std::vector<float>& wanted) const {
        const std::vector<uint32_t> rgba = colors();
        ASSERT_EQ(rgba.size(), wanted.size());
        for (size_t i = 0; i < rgba.size(); ++i) {
            const uint32_t gray = rgba[i] & 255u;
            ASSERT_EQ(rgba[i], 0xff000000u | gray * 0x010101u) << "pixel " << i;
            ASSERT_NEAR(float(gray), 255.0f * linear_to_srgb(wanted[i]), 0.6f) << "pixel " << i;
        }
    }

    // A quad across the picture at depth z from column x0 to x1, row y0 to y1.
    static void push_quad(std::vector<PackedVertex>& vertices, float x0, float y0, float x1, float y1,
                          float z, uint32_t surface = 1u) {
        for (vec2 c : {vec2(x0, y0), vec2(x0, y1), vec2(x1, y1), vec2(x0, y0), vec2(x1, y1), vec2(x1, y0)})
            vertices.push_back(at(c.x, c.y, z, surface));
    }
};

// What a tent does to samples, its border clamped: side is a neighbour's weight over the pixel's own.
std::vector<float> filtered(const std::vector<float>& samples, int width, int height, float side) {
    std::vector<float> out(samples.size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            float sum = 0.0f;
            for (int v = -1; v <= 1; ++v)
                for (int u = -1; u <= 1; ++u) {
                    const int column = std::clamp(x + u, 0, width - 1),
                              row = std::clamp(y + v, 0, height - 1);
                    sum += samples[size_t(row * width + column)] * (u ? side : 1.0f) * (v ? side : 1.0f);
                }
            out[size_t(y * width + x)] = sum / ((1.0f + 2.0f * side) * (1.0f + 2.0f * side));
        }
    return out;
}

TEST_F(ResolveTest, ASampleIsSpreadByTheTent) {
    picture_.filter_radius_px = 2.0f;
    draw_pixels({{100, 90}});
    constexpr float k_weights[3] = {1.0f, 2.0f, 1.0f};
    std::vector<float> wanted(words_.size(), 0.0f);
    for (uint32_t v = 0; v < 3; ++v)
        for (uint32_t u = 0; u < 3; ++u)
            wanted[(89 + v) * k_side + 99 + u] = k_weights[u] * k_weights[v] / 16.0f;
    expect_coverage(wanted);
    float sum = 0.0f;
    for (float share : shares()) sum += share;
    EXPECT_NEAR(sum, 1.0f, 0.02f);

    picture_.filter_radius_px = 1.0f;
    draw_pixels({{100, 90}});
    expect_coverage(samples());
}

// Against a filter in plain loops: all borders, corners and seams between blocks, for pictures of awkward sizes.
TEST_F(ResolveTest, EveryPixelOfEverySizeIsFiltered) {
    for (auto [width, height] :
         {std::pair(1u, 1u), std::pair(2u, 1u), std::pair(1u, 2u), std::pair(3u, 3u), std::pair(30u, 64u),
          std::pair(31u, 17u), std::pair(65u, 66u), std::pair(61u, 129u), std::pair(400u, 5u)}) {
        ASSERT_TRUE(rasteriser_->resize(width, height));
        for (float radius : {1.0f, 1.5f, 2.0f})
            for (uint64_t seed : {1u, 2u}) {
                SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height) + " radius " +
                             std::to_string(radius));
                Random random(seed);
                std::vector<std::pair<uint32_t, uint32_t>> pixels;
                for (uint32_t y = 0; y < height; ++y)
                    for (uint32_t x = 0; x < width; ++x)
                        if ((x == 0 && y == 0) == (seed == 1) || random.next_unit() < 0.4f)
                            pixels.emplace_back(x, y);
                picture_.filter_radius_px = radius;
                draw_pixels(pixels);
                expect_coverage(filtered(samples(), int(width), int(height), 1.0f - 1.0f / radius));
            }
    }
}

TEST_F(ResolveTest, ARadiusOutOfRangeIsClamped) {
    for (auto [asked, taken] : {std::pair(0.0f, 1.0f), std::pair(9.0f, 2.0f)}) {
        picture_.filter_radius_px = asked;
        draw_pixels({{7, 200}});
        expect_coverage(filtered(samples(), k_side, k_side, 1.0f - 1.0f / taken));
    }
}

// The filter takes the mean of light, not of what the screen shows of it.
TEST_F(ResolveTest, LightIsFilteredBeforeTheToneCurve) {
    picture_.view = RepresentationView::lit;
    picture_.filter_radius_px = 2.0f;
    light_ = {vec3(0.0f), vec3(0.0f), vec3(0.2f), vec3(0.2f), vec3(0.0f), vec3(0.0f), 0.0f, 1.0f};
    draw({}, {});
    const uint32_t sky = colors()[0] & 255u;
    // The sky of 4/3 the radiance, where black covers a quarter of what a pixel sees, looks the same.
    light_.sky_zenith_color = light_.sky_horizon_color = vec3(0.2f * 4.0f / 3.0f);
    const uint32_t black = encode_surface({vec3(0, 0, 1), vec3(0.0f), 1.0f, false}, 0);
    std::vector<PackedVertex> vertices;
    push_quad(vertices, 0.0f, 0.0f, 100.0f, 256.0f, 10.0f, black);
    PartChoice choice;
    choice.triangles = 2;
    draw(vertices, choice);
    const std::vector<uint32_t> rgba = colors();
    EXPECT_EQ(rgba[50 * k_side + 98] & 255u, 0u);
    EXPECT_NEAR(float(rgba[50 * k_side + 100] & 255u), float(sky), 1.0f);
    EXPECT_GT(rgba[50 * k_side + 101] & 255u, sky + 10u);
}

TEST_F(ResolveTest, FramesAreAveragedByTheirShares) {
    ASSERT_TRUE(rasteriser_->keep_radiance());
    // What an earlier rest has left, to be forgotten.
    picture_.new_share = 1.0f;
    draw_pixels({{3, 3}, {10, 10}});
    std::vector<float> sum(words_.size(), 0.0f);
    for (uint32_t frame = 0; frame < 5; ++frame) {
        picture_.new_share = 1.0f / float(frame + 1);
        std::vector<std::pair<uint32_t, uint32_t>> pixels;
        for (uint32_t x = 0; x < k_side; ++x)
            for (uint32_t y = 0; y < k_side; y += 15)
                if ((x * 7 + y) % (frame + 2) == 0) pixels.emplace_back(x, y);
        draw_pixels(pixels);
        const std::vector<float> now = samples();
        for (size_t i = 0; i < sum.size(); ++i) sum[i] += now[i];
        std::vector<float> mean = sum;
        for (float& value : mean) value /= float(frame + 1);
        expect_coverage(mean);
    }
    // The mean is kept as it was taken, and only what is shown of it is filtered.
    picture_.new_share = 0.5f;
    picture_.filter_radius_px = 2.0f;
    draw_pixels({{3, 3}});
    for (float& value : sum) value *= 0.5f / 5.0f;
    sum[3 * k_side + 3] += 0.5f;
    expect_coverage(filtered(sum, k_side, k_side, 0.5f));
    picture_.new_share = 0.5f;
    picture_.filter_radius_px = 1.0f;
    draw_pixels({{3, 3}});
    for (float& value : sum) value *= 0.5f;
    sum[3 * k_side + 3] += 0.5f;
    expect_coverage(sum);
    // A frame that stands alone shows nothing of them.
    picture_.new_share = 0.0f;
    draw_pixels({{9, 9}});
    expect_coverage(samples());
}

// Rows of other lengths than the runs that a group takes.
TEST_F(ResolveTest, TheMeanReachesEveryPixel) {
    for (auto [width, height] : {std::pair(1u, 1u), std::pair(31u, 17u), std::pair(255u, 3u),
                                 std::pair(257u, 2u), std::pair(700u, 3u)}) {
        SCOPED_TRACE(width);
        ASSERT_TRUE(rasteriser_->resize(width, height));
        ASSERT_TRUE(rasteriser_->keep_radiance());
        std::vector<std::pair<uint32_t, uint32_t>> all;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) all.emplace_back(x, y);
        picture_.new_share = 1.0f;
        draw_pixels(all);
        expect_coverage(std::vector<float>(all.size(), 1.0f));
        picture_.new_share = 0.25f;
        draw_pixels({});
        expect_coverage(std::vector<float>(all.size(), 0.75f));
    }
}

// Four frames shifted by quarters of a pixel are the pixels of a picture twice as fine: of triangles, and of the sky.
TEST_F(ResolveTest, AShiftedFrameSamplesWhereItSays) {
    constexpr uint32_t k_coarse = 48, k_fine = 2 * k_coarse;
    picture_.view = RepresentationView::lit;
    std::vector<PackedVertex> vertices;
    Random random(8);
    for (int i = 0; i < 40; ++i) {
        const vec2 middle(random.next_in(-1, 1), random.next_in(-1, 1));
        const float z = random.next_in(3.0f, 20.0f), size = i < 4 ? 1.5f : 0.15f;
        const uint32_t surface = encode_surface(
            {normalize_or(vec3(random.next_in(-1, 1), random.next_in(-1, 1), 1.0f), vec3(0, 1, 0)),
             vec3(random.next_unit(), random.next_unit(), random.next_unit()), 1.0f, false},
            0);
        for (int v = 0; v < 3; ++v)
            vertices.push_back({(middle.x + size * random.next_in(-1, 1)) * z,
                                (middle.y + size * random.next_in(-1, 1)) * z, -z, surface});
    }
    PartChoice choice;
    choice.triangles = uint32_t(vertices.size() / 3);
    ASSERT_TRUE(rasteriser_->resize(k_fine, k_fine));
    draw(vertices, choice);
    const std::vector<uint32_t> fine = colors();
    ASSERT_TRUE(rasteriser_->resize(k_coarse, k_coarse));
    for (uint32_t v = 0; v < 2; ++v)
        for (uint32_t u = 0; u < 2; ++u) {
            picture_.shift_px = vec2(u ? 0.25f : -0.25f, v ? 0.25f : -0.25f);
            draw(vertices, choice);
            const std::vector<uint32_t> coarse = colors();
            int differing = 0;
            for (uint32_t y = 0; y < k_coarse; ++y)
                for (uint32_t x = 0; x < k_coarse; ++x) {
                    const uint32_t a = coarse[y * k_coarse + x], b = fine[(2 * y + v) * k_fine + 2 * x + u];
                    for (int c = 0; c < 24; c += 8)
                        differing += std::abs(int(a >> c & 255u) - int(b >> c & 255u)) > 1;
                }
            EXPECT_EQ(differing, 0) << u << " " << v;
        }
}

TEST_F(ResolveTest, PointsAndLinesMoveWithTheShift) {
    PartChoice choice;
    choice.points = 1;
    choice.splat_px = 1.0f;
    picture_.shift_px = vec2(0.3f, -0.3f);
    draw({at(100.2f, 50.9f, 20.0f)}, choice);  // at 99.9, 51.2 of the shifted picture
    EXPECT_NE(word(99, 51), 0u);
    EXPECT_EQ(covered(), 1u);
    PartChoice line;
    line.lines = 1;
    line.line_width_px = 1.0f;
    draw({at(100.2f, 50.0f, 20.0f), at(100.2f, 60.0f, 20.0f, std::bit_cast<uint32_t>(1.0f))}, line);
    EXPECT_NE(word(99, 55), 0u);
    EXPECT_EQ(word(100, 55), 0u);
}

TEST_F(ResolveTest, TheCoverageViewShowsPlantsAlone) {
    const uint32_t black_plant = encode_surface({vec3(0, 0, 1), vec3(0.0f), 0.0f, false}, 0);
    const uint32_t white_ground = encode_surface({vec3(0, 1, 0), vec3(1.0f), 1.0f, false}, 0);
    std::vector<PackedVertex> vertices;
    auto add_tiny = [&](float x0, uint32_t surface) {  // 16 x 16 quads of 2 px
        for (int i = 0; i < 256; ++i) {
            const float x = x0 + 2.0f * float(i % 16), y = 20.0f + 2.0f * float(i / 16);
            push_quad(vertices, x, y, x + 2.0f, y + 2.0f, 10.0f, surface);
        }
    };
    // Under the viewer to the horizon, left of the middle and right of it: triangles across the near plane.
    auto add_floor = [&](float x0, float x1, uint32_t surface) {
        const float y = -1.5f, far = 10000.0f;
        for (vec2 p :
             {vec2(x0, far), vec2(x1, far), vec2(x0, -far), vec2(x1, -far), vec2(x0, -far), vec2(x1, far)})
            vertices.push_back({p.x, y, p.y, surface});
    };
    work_.begin(1);
    WorkPart& work = work_.part(0);
    const uint32_t instance = work.add_instance({});
    auto add_plant = [&](uint32_t first_vertex) {
        PartGeometry geometry{};
        geometry.first_triangle_vertex = first_vertex;
        PartChoice choice;
        choice.triangles = (uint32_t(vertices.size()) - first_vertex) / 3;
        work.add(geometry, choice, instance);
    };
    auto add_ground = [&](uint32_t first_vertex) {
        work.add_ground(first_vertex, (uint32_t(vertices.size()) - first_vertex) / 3, instance);
    };
    auto here = [&] { return uint32_t(vertices.size()); };

    uint32_t first = here();
    add_tiny(20.0f, black_plant);
    add_plant(first);
    first = here();
    add_tiny(60.0f, white_ground);
    add_ground(first);
    first = here();
    push_quad(vertices, 100.0f, 20.0f, 140.0f, 60.0f, 10.0f, black_plant);
    add_plant(first);
    first = here();
    push_quad(vertices, 150.0f, 20.0f, 190.0f, 60.0f, 10.0f, white_ground);
    // And before the large plant, of which it hides the lower half.
    push_quad(vertices, 95.0f, 40.0f, 145.0f, 70.0f, 5.0f, white_ground);
    add_ground(first);
    first = here();
    add_floor(-10000.0f, 0.0f, black_plant);
    add_plant(first);
    first = here();
    add_floor(0.0f, 10000.0f, white_ground);
    add_ground(first);
    first = here();
    vertices.push_back(at(200.5f, 20.5f, 9.0f, black_plant));
    vertices.push_back(at(210.0f, 30.5f, 9.0f, black_plant));
    vertices.push_back(at(220.0f, 30.5f, 9.0f, std::bit_cast<uint32_t>(1.0f)));
    PartGeometry thin{};
    thin.first_point = first;
    thin.first_line_vertex = first + 1;
    PartChoice choice;
    choice.points = choice.lines = 1;
    choice.splat_px = choice.line_width_px = 1.0f;
    work.add(thin, choice, instance);
    ASSERT_TRUE(rasteriser_->set_geometry({vertices, {}}));
    draw_work();

    const std::vector<uint32_t> rgba = colors();
    auto all = [&](uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, uint32_t wanted) {
        for (uint32_t y = y0; y < y1; ++y)
            for (uint32_t x = x0; x < x1; ++x) {
                ASSERT_EQ(rgba[y * k_side + x], wanted) << x << "," << y;
                ASSERT_NE(word(x, y), 0u);
            }
    };
    constexpr uint32_t k_white = 0xffffffffu, k_black = 0xff000000u;
    all(21, 21, 51, 51, k_white);
    all(61, 21, 91, 51, k_black);
    all(101, 21, 139, 39, k_white);
    all(101, 41, 139, 59, k_black);
    all(151, 21, 189, 59, k_black);
    all(1, 131, 127, 255, k_white);
    all(129, 131, 255, 255, k_black);
    all(200, 20, 201, 21, k_white);
    all(211, 30, 219, 31, k_white);
    EXPECT_EQ(rgba[5 * k_side + 5], k_black);  // sky
    EXPECT_EQ(word(5, 5), 0u);
}

}  // namespace
}  // namespace coppice
