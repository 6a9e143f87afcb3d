// FLIP against the paper's formulas written out as they stand (whole two-dimensional kernels, doubles), and against
// what it must say of pictures that need no formula.
#include "tools/accuracy/flip.h"
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

using Color = std::array<double, 3>;
using Image = std::vector<double>;                         // one channel
using Weight = std::function<double(double x, double y)>;  // of a kernel, in pixels

FloatPicture flat(uint32_t width, uint32_t height, Color color) {
    FloatPicture picture{width, height, {}};
    for (size_t i = 0; i < size_t(width) * height; ++i)
        for (double value : color) picture.rgb.push_back(float(value));
    return picture;
}

FloatPicture noise(uint32_t width, uint32_t height, uint64_t seed) {
    FloatPicture picture = flat(width, height, {});
    Random random(seed);
    for (float& value : picture.rgb) value = random.next_unit();
    return picture;
}

// A white line of one pixel on black.
FloatPicture line_at(uint32_t width, uint32_t height, uint32_t x) {
    FloatPicture picture = flat(width, height, {});
    for (uint32_t y = 0; y < height; ++y) std::fill_n(&picture.rgb[(size_t(y) * width + x) * 3], 3, 1.0f);
    return picture;
}

FloatPicture checkerboard(uint32_t side) {
    FloatPicture picture = flat(side, side, {});
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = y % 2; x < side; x += 2)
            std::fill_n(&picture.rgb[(size_t(y) * side + x) * 3], 3, 1.0f);
    return picture;
}

std::vector<float> map_of(const FloatPicture& a, const FloatPicture& b,
                          float pixels_per_degree = k_flip_pixels_per_degree) {
    auto map = flip_map(a, b, pixels_per_degree);
    EXPECT_TRUE(map) << to_string(map.error());
    return map ? *map : std::vector<float>(size_t(a.width) * a.height, NAN);
}

double mean_of(const std::vector<float>& map) {
    return std::accumulate(map.begin(), map.end(), 0.0) / double(map.size());
}

// The paper, stage by stage; a stage may be left out.
struct Paper {
    double pixels_per_degree;
    bool sensitivity = true, hunt = true, features = true;

    static Color to_xyz(Color c) {
        return {0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2], 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2],
                0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2]};
    }
    static Color to_rgb(Color c) {
        return {3.2406255 * c[0] - 1.5372080 * c[1] - 0.4986286 * c[2],
                -0.9689307 * c[0] + 1.8757561 * c[1] + 0.0415175 * c[2],
                0.0557101 * c[0] - 0.2040211 * c[1] + 1.0569959 * c[2]};
    }
    static Color white() { return to_xyz({1, 1, 1}); }

    Color lab(Color rgb) const {
        Color xyz = to_xyz(rgb), f{};
        for (size_t c = 0; c < 3; ++c) {
            double t = xyz[c] / white()[c];
            f[c] = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
        }
        double l = 116 * f[1] - 16, weak = hunt ? 0.01 * l : 1.0;
        return {l, weak * 500 * (f[0] - f[1]), weak * 200 * (f[1] - f[2])};
    }
    static double distance(Color a, Color b) {
        return std::pow(std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]), 0.7);
    }

    static Image filter(const Image& in, int width, int height, int radius, const Weight& weight) {
        Image out(in.size());
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int v = -radius; v <= radius; ++v)
                    for (int u = -radius; u <= radius; ++u)
                        out[size_t(y * width + x)] +=
                            weight(u, v) * in[size_t(std::clamp(y + v, 0, height - 1) * width +
                                                     std::clamp(x + u, 0, width - 1))];
        return out;
    }
    // Positive weights to 1 and negative ones to -1.
    static Weight normalized(int radius, const Weight& weight) {
        double positive = 0, negative = 0;
        for (int v = -radius; v <= radius; ++v)
            for (int u = -radius; u <= radius; ++u) {
                double w = weight(u, v);
                (w > 0 ? positive : negative) += std::abs(w);
            }
        return [=](double x, double y) {
            double w = weight(x, y);
            return w > 0 ? w / positive : w < 0 ? w / negative : 0;
        };
    }

    struct Seen {
        std::vector<Color> lab;
        Image edge, point;
    };
    Seen see(const FloatPicture& picture) const {
        const int width = int(picture.width), height = int(picture.height);
        const size_t count = picture.rgb.size() / 3;
        std::array<Image, 3> opponent{Image(count), Image(count), Image(count)};
        for (size_t i = 0; i < count; ++i) {
            Color n = to_xyz({picture.rgb[i * 3], picture.rgb[i * 3 + 1], picture.rgb[i * 3 + 2]});
            for (size_t c = 0; c < 3; ++c) n[c] /= white()[c];
            opponent[0][i] = 116 * n[1] - 16;
            opponent[1][i] = 500 * (n[0] - n[1]);
            opponent[2][i] = 200 * (n[1] - n[2]);
        }
        Seen seen;
        Image gray(count);
        for (size_t i = 0; i < count; ++i) gray[i] = (opponent[0][i] + 16) / 116;
        const double sigma = 0.5 * 0.082 * pixels_per_degree;
        auto gaussian = [=](double x, double y) { return std::exp(-(x * x + y * y) / (2 * sigma * sigma)); };
        auto magnitude = [&](const Weight& along_x) {
            const int radius = int(std::ceil(3 * sigma));
            Weight weight = normalized(radius, along_x);
            Image x = filter(gray, width, height, radius, weight);
            Image y = filter(gray, width, height, radius, [&](double u, double v) { return weight(v, u); });
            for (size_t i = 0; i < count; ++i) x[i] = std::hypot(x[i], y[i]);
            return x;
        };
        seen.edge = magnitude([=](double x, double y) { return -x * gaussian(x, y); });
        seen.point =
            magnitude([=](double x, double y) { return (x * x / (sigma * sigma) - 1) * gaussian(x, y); });
        constexpr double k_parameters[3][4] = {
            {1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};
        const int radius = int(std::ceil(3 * std::sqrt(0.04 / (2 * M_PI * M_PI)) * pixels_per_degree));
        for (size_t c = 0; c < 3 && sensitivity; ++c)
            opponent[c] =
                filter(opponent[c], width, height, radius, normalized(radius, [&](double x, double y) {
                           const double* p = k_parameters[c];
                           double square = (x * x + y * y) / (pixels_per_degree * pixels_per_degree);
                           return p[0] * std::sqrt(M_PI / p[1]) * std::exp(-M_PI * M_PI * square / p[1]) +
                                  p[2] * std::sqrt(M_PI / p[3]) * std::exp(-M_PI * M_PI * square / p[3]);
                       }));
        for (size_t i = 0; i < count; ++i) {
            double y = (opponent[0][i] + 16) / 116;
            Color rgb = to_rgb({(y + opponent[1][i] / 500) * white()[0], y * white()[1],
                                (y - opponent[2][i] / 200) * white()[2]});
            for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
            seen.lab.push_back(lab(rgb));
        }
        return seen;
    }

    std::vector<double> map(const FloatPicture& a, const FloatPicture& b) const {
        const Seen one = see(a), other = see(b);
        const double largest = distance(lab({0, 1, 0}), lab({0, 0, 1})), knee = 0.4 * largest;
        std::vector<double> map;
        for (size_t i = 0; i < one.lab.size(); ++i) {
            double d = distance(one.lab[i], other.lab[i]);
            double color = d < knee ? 0.95 / knee * d : 0.95 + (d - knee) / (largest - knee) * 0.05;
            double feature =
                std::max(std::abs(one.edge[i] - other.edge[i]), std::abs(one.point[i] - other.point[i]));
            map.push_back(std::pow(color, 1 - (features ? std::sqrt(feature / std::sqrt(2.0)) : 0.0)));
        }
        return map;
    }
};

double largest_gap(const std::vector<float>& map, const std::vector<double>& expected) {
    double gap = 0;
    for (size_t i = 0; i < map.size(); ++i) gap = std::max(gap, std::abs(double(map[i]) - expected[i]));
    return gap;
}

// Borders, noise, a line and dark saturated colours in one small picture.
std::pair<FloatPicture, FloatPicture> busy_pair() {
    FloatPicture a = noise(37, 26, 1), b = noise(37, 26, 2);
    for (size_t i = 0; i < b.rgb.size(); ++i) {
        b.rgb[i] = 0.7f * a.rgb[i] + 0.3f * b.rgb[i];
        if ((i / 3) % 37 < 12) a.rgb[i] = i % 3 == 0 ? 0.03f : 0.0f, b.rgb[i] = i % 3 == 2 ? 0.05f : 0.0f;
    }
    for (size_t y = 0; y < 26; ++y) a.rgb[(y * 37 + 25) * 3 + 1] = 1.0f;
    return {a, b};
}

TEST(Flip, SaysWhatThePapersFormulasSay) {
    const auto [a, b] = busy_pair();
    for (double pixels_per_degree : {67.0, 21.0}) {
        const std::vector<float> map = map_of(a, b, float(pixels_per_degree));
        // XYZ of the standard's four digits here, of eight there.
        EXPECT_LT(largest_gap(map, Paper{pixels_per_degree}.map(a, b)), 0.002) << pixels_per_degree;
    }
}

TEST(Flip, EveryStageCounts) {
    const auto [a, b] = busy_pair();
    const std::vector<float> map = map_of(a, b);
    EXPECT_GT(largest_gap(map, Paper{67.0, false}.map(a, b)), 0.05);
    EXPECT_GT(largest_gap(map, Paper{67.0, true, false}.map(a, b)), 0.05);
    EXPECT_GT(largest_gap(map, Paper{67.0, true, true, false}.map(a, b)), 0.05);
}

TEST(Flip, EqualPicturesDoNotDiffer) {
    const FloatPicture picture = noise(50, 33, 7);
    for (float value : map_of(picture, picture)) EXPECT_EQ(value, 0.0f);
}

TEST(Flip, IsSymmetricAndWithinBounds) {
    const FloatPicture a = noise(65, 41, 3), b = checkerboard(65);
    FloatPicture cut = b;
    cut.height = 41, cut.rgb.resize(a.rgb.size());
    const std::vector<float> map = map_of(a, cut);
    EXPECT_EQ(map, map_of(cut, a));
    for (float value : map) {
        EXPECT_GE(value, 0.0f);
        EXPECT_LE(value, 1.0f);
    }
    EXPECT_GT(mean_of(map), 0.05);
}

TEST(Flip, GreenAgainstBlueIsTheLargest) {
    for (uint32_t side : {1u, 20u})
        for (float value : map_of(flat(side, side, {0, 1, 0}), flat(side, side, {0, 0, 1})))
            EXPECT_NEAR(value, 1.0f, 2e-6f);
}

TEST(Flip, BlackAgainstWhiteFollowsFromTheirLab) {
    // Published L, a, b of the primaries; a and b times L / 100. Black and white are 100 apart.
    const double green[] = {87.735, -86.183 * 0.87735, 83.180 * 0.87735};
    const double blue[] = {32.297, 79.188 * 0.32297, -107.860 * 0.32297};
    const double largest =
        std::pow(green[0] - blue[0] + std::hypot(green[1] - blue[1], green[2] - blue[2]), 0.7);
    const double expected = 0.95 + 0.05 * (std::pow(100.0, 0.7) - 0.4 * largest) / (0.6 * largest);
    for (float value : map_of(flat(9, 9, {}), flat(9, 9, {1, 1, 1}))) EXPECT_NEAR(value, expected, 1e-4);
}

TEST(Flip, GrowsWithTheContrastOfAFlatDifference) {
    double last = 0.0;
    for (double value : {0.21, 0.25, 0.3, 0.4, 0.6, 0.8, 1.0}) {
        double now = mean_of(map_of(flat(8, 8, {0.2, 0.2, 0.2}), flat(8, 8, {value, value, value})));
        EXPECT_GT(now, last + 0.004) << value;
        last = now;
    }
}

TEST(Flip, FinePatternsVanishFromAfar) {
    const FloatPicture fine = checkerboard(64), gray = flat(64, 64, {0.5, 0.5, 0.5});
    const double near = mean_of(map_of(fine, gray, 10.0f)), far = mean_of(map_of(fine, gray, 150.0f));
    EXPECT_GT(near, 0.5);
    EXPECT_LT(far, 0.1 * near);
    // A flat difference does not.
    const FloatPicture dark = flat(64, 64, {0.2, 0.2, 0.2});
    EXPECT_NEAR(mean_of(map_of(dark, gray, 10.0f)), mean_of(map_of(dark, gray, 150.0f)), 1e-4);
}

TEST(Flip, BlueYellowPatternsVanishBeforeBlackWhiteOnes) {
    FloatPicture bright = flat(60, 60, {}), yellow = flat(60, 60, {0.5, 0.5, 0.5});
    for (size_t i = 0; i < 3600; ++i) {
        const float stripe = (i % 60) / 5 % 2 ? 1.0f : 0.0f;
        std::fill_n(&bright.rgb[i * 3], 3, stripe);
        yellow.rgb[i * 3 + 2] = stripe;
    }
    // Each against its mean: how much of what is seen near is left at arm's length.
    const FloatPicture gray = flat(60, 60, {0.5, 0.5, 0.5});
    auto left = [&](const FloatPicture& stripes) {
        return mean_of(map_of(stripes, gray, 67.0f)) / mean_of(map_of(stripes, gray, 10.0f));
    };
    EXPECT_LT(left(yellow), 0.7 * left(bright));
}

TEST(Flip, ALineThatMovesIsALocalError) {
    const std::vector<float> map = map_of(line_at(81, 20, 40), line_at(81, 20, 41));
    for (size_t y = 0; y < 20; ++y) {
        EXPECT_GT(map[y * 81 + 40], 0.3f);
        EXPECT_GT(map[y * 81 + 41], 0.3f);
        for (size_t x : {0, 20, 29, 52, 61, 80}) EXPECT_LT(map[y * 81 + x], 1e-3f) << x;
    }
}

TEST(Flip, ALineShowsMoreThanTheFlatDifferenceItIsSeenAs) {
    // The colours alone differ by less: what the eye makes of the line is grey and broad.
    const FloatPicture line = line_at(61, 15, 30), black = flat(61, 15, {});
    const std::vector<float> map = map_of(line, black);
    const std::vector<double> colors_only = Paper{67.0, true, true, false}.map(line, black);
    EXPECT_GT(map[7 * 61 + 30], colors_only[7 * 61 + 30] + 0.005);
    EXPECT_GT(map[7 * 61 + 34], colors_only[7 * 61 + 34] + 0.05);
}

TEST(Flip, IsTheSameOnAnyNumberOfThreads) {
    const FloatPicture a = noise(70, 90, 11), b = noise(70, 90, 12);
    set_thread_limit(1);
    const std::vector<float> alone = map_of(a, b);
    set_thread_limit(4);
    const std::vector<float> together = map_of(a, b);
    set_thread_limit(0);
    EXPECT_EQ(alone, together);
}

TEST(Flip, TakesWhatNoScreenShowsForItsNearest) {
    FloatPicture wild = flat(3, 1, {}), tame = wild;
    wild.rgb = {1e30f, INFINITY, 2.0f, -1.0f, -INFINITY, NAN, 0.5f, 0.5f, 0.5f};
    tame.rgb = {1, 1, 1, 0, 0, 0, 0.5f, 0.5f, 0.5f};
    for (float value : map_of(wild, tame)) EXPECT_EQ(value, 0.0f);
}

TEST(Flip, WorksFromAnyDistanceItTakes) {
    const FloatPicture a = noise(24, 9, 5), b = noise(24, 9, 6);
    for (float pixels_per_degree : {1.0f, 3.0f, 1000.0f})
        for (float value : map_of(a, b, pixels_per_degree)) EXPECT_TRUE(value >= 0.0f && value <= 1.0f);
    for (float pixels_per_degree : {0.0f, 0.9f, -67.0f, 1001.0f, NAN, INFINITY}) {
        auto map = flip_map(a, b, pixels_per_degree);
        ASSERT_FALSE(map);
        EXPECT_EQ(map.error().id, ErrorId::value_out_of_range);
    }
}

TEST(Flip, RefusesWhatIsNoPair) {
    FloatPicture short_of_values = flat(6, 4, {});
    short_of_values.rgb.pop_back();
    for (const FloatPicture& other : {flat(4, 6, {}), FloatPicture{}, short_of_values}) {
        auto map = flip_map(flat(6, 4, {}), other);
        ASSERT_FALSE(map);
        EXPECT_EQ(map.error().id, ErrorId::value_out_of_range);
    }
    EXPECT_FALSE(flip_map({}, {}));
}

}  // namespace
}  // namespace coppice
