// Pictures over the ground that say how much grows where.
#include "plugins/vegetation/eco/density_map.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/scatter.h"
#include "runtime/core/file_watcher.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

// Four by three, 16 bit, rows from least z.
constexpr uint16_t k_values[3][4] = {{0, 16384, 32768, 65535}, {65535, 0, 0, 8192}, {4096, 65535, 65535, 49152}};

std::string pgm_16() {
    std::string text = "P5\n# a map\n4 3\n65535\n";
    for (const auto& row : k_values)
        for (uint16_t value : row) {
            text += char(value >> 8);
            text += char(value & 255);
        }
    return text;
}

std::string scene_with(const std::string& scatter) {
    return R"({"plants": {"oak": {"source": "oak.json", "height_m": 10}, "fern": {"source": "fern.json"}},
               "terrain": {"flat": {"size_m": 400, "cell_m": 4}}, "placements": [{"scatter": )" +
           scatter + "}]}";
}

Result<Scene> load(const std::string& text, const std::string& map, const std::string& name = "map.pgm") {
    const ScratchFile picture(name, map);
    return load_scene_text(text);
}

std::vector<dvec2> places_of(const Scene& scene, const std::string& name = "") {
    std::vector<dvec2> places;
    for (const SceneTile& tile : scene.tiles)
        for (uint32_t i = tile.first_plant; i < tile.first_plant + tile.plant_count; ++i)
            if (name.empty() || scene.models[scene.plant_models[i].model].name == name)
                places.emplace_back(tile.tile.origin_world.x + double(scene.positions[i].x_tile),
                                    tile.tile.origin_world.z + double(scene.positions[i].z_tile));
    return places;
}

// Mean of the map over a cell of a grid of 8 by 6 over its rectangle, by the map's own bilinear rule written again.
double share_of_cell(int column, int row, double black, double white) {
    double sum = 0.0;
    constexpr int k_steps = 64;
    for (int j = 0; j < k_steps; ++j)
        for (int i = 0; i < k_steps; ++i) {
            const double x = std::clamp((column + (i + 0.5) / k_steps) / 8.0 * 4.0 - 0.5, 0.0, 3.0);
            const double y = std::clamp((row + (j + 0.5) / k_steps) / 6.0 * 3.0 - 0.5, 0.0, 2.0);
            const int x0 = std::min(int(x), 2), y0 = std::min(int(y), 1);
            const double fx = x - x0, fy = y - y0;
            auto v = [](int r, int c) { return k_values[r][c] / 65535.0; };
            sum += (v(y0, x0) * (1 - fx) + v(y0, x0 + 1) * fx) * (1 - fy) +
                   (v(y0 + 1, x0) * (1 - fx) + v(y0 + 1, x0 + 1) * fx) * fy;
        }
    return black + (white - black) * sum / (k_steps * k_steps);
}

// How far counts in 48 cells are from `expected` of each, in units of what chance does. 0: exactly as expected; about 48
// for counts by chance.
double chi_square(const std::vector<dvec2>& places, double black, double white, double density) {
    std::vector<double> counts(48, 0.0);
    for (const dvec2& at : places) {
        EXPECT_TRUE(std::abs(at.x - 100.0) < 200.001 && std::abs(at.y - 30.0) < 150.001) << "a plant outside the map";
        const int column = std::clamp(int(std::floor((at.x + 100.0) / 50.0)), 0, 7);
        const int row = std::clamp(int(std::floor((at.y + 120.0) / 50.0)), 0, 5);
        ++counts[size_t(row * 8 + column)];
    }
    double sum = 0.0;
    for (int cell = 0; cell < 48; ++cell) {
        const double expected = density * 2500.0 * share_of_cell(cell % 8, cell / 8, black, white);
        sum += (counts[size_t(cell)] - expected) * (counts[size_t(cell)] - expected) / std::max(expected, 1.0);
    }
    return sum;
}

// 400 by 300 m about (100, 30): cells of 50 m.
constexpr const char* k_map = R"("density_map": {"picture": "map.pgm", "center": [100, 30], "size_m": [400, 300])";

TEST(DensityMap, PlantsStandAsThePictureSays) {
    const auto scene = load(scene_with(std::string(R"({"plant": "oak", "density_per_m2": 0.5, "seed": 3,
        "region": {"rectangle": {"center": [0, 0], "size_m": [900, 900]}}, )") + k_map + "}}"), pgm_16());
    ASSERT_TRUE(scene) << to_string(scene.error());
    const auto places = places_of(*scene);
    double mean = 0.0;
    for (int cell = 0; cell < 48; ++cell) mean += share_of_cell(cell % 8, cell / 8, 0, 1) / 48.0;
    EXPECT_NEAR(double(places.size()), 0.5 * 120000.0 * mean, 3.0 * std::sqrt(0.5 * 120000.0 * mean));
    // Chance exceeds 48 + 4 sqrt(96) once in ten thousand seeds; a flipped or shifted map comes to thousands.
    EXPECT_LT(chi_square(places, 0, 1, 0.5), 48.0 + 4.0 * std::sqrt(96.0));
    EXPECT_GT(chi_square(places, 1, 0, 0.5), 10000.0);
}

TEST(DensityMap, BlackAndWhiteAreSharesOfTheDensity) {
    const auto scene = load(scene_with(std::string(R"({"plant": "oak", "density_per_m2": 0.5, "seed": 5,
        "region": {"rectangle": {"center": [100, 30], "size_m": [400, 300]}}, )") + k_map +
                                       R"(, "black": 0.8, "white": 0.2}})"),
                            pgm_16());
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_LT(chi_square(places_of(*scene), 0.8, 0.2, 0.5), 48.0 + 4.0 * std::sqrt(96.0));
}

TEST(DensityMap, HoldsForCountsAndDistancesAndGrids) {
    const std::string region = R"("region": {"rectangle": {"center": [100, 30], "size_m": [400, 300]}}, )";
    const auto counted = load(scene_with(R"({"plant": "oak", "count": 20000, "seed": 3, )" + region + k_map + "}}"), pgm_16());
    ASSERT_TRUE(counted) << to_string(counted.error());
    double mean = 0.0;
    for (int cell = 0; cell < 48; ++cell) mean += share_of_cell(cell % 8, cell / 8, 0, 1) / 48.0;
    ASSERT_EQ(places_of(*counted).size(), 20000u);
    EXPECT_LT(chi_square(places_of(*counted), 0, 1, 20000.0 / 120000.0 / mean), 48.0 + 4.0 * std::sqrt(96.0));

    // Plants that keep a distance are spread more evenly than chance does it, so less is left to chance.
    const auto apart = load(
        scene_with(R"({"plant": "oak", "density_per_m2": 0.2, "spacing_m": 1.5, "seed": 3, )" + region + k_map + "}}"),
        pgm_16());
    ASSERT_TRUE(apart) << to_string(apart.error());
    EXPECT_LT(chi_square(places_of(*apart), 0, 1, 0.2), 48.0);
    const auto gridded = load(scene_with(R"({"plant": "oak", "grid": {"spacing_m": 2}, )" + region + k_map + "}}"), pgm_16());
    ASSERT_TRUE(gridded) << to_string(gridded.error());
    EXPECT_LT(chi_square(places_of(*gridded), 0, 1, 0.25), 48.0 + 4.0 * std::sqrt(96.0));
}

TEST(DensityMap, LiesOverTheTerrainWithoutARectangle) {
    // The left half white: plants where x is negative.
    const auto scene = load(scene_with(R"({"plant": "oak", "density_per_m2": 0.1,
        "density_map": {"picture": "half.pgm"}})"), "P5 2 1 255 " + std::string("\xff\x00", 2), "half.pgm");
    ASSERT_TRUE(scene) << to_string(scene.error());
    size_t left = 0, far_right = 0;
    for (const dvec2& at : places_of(*scene)) left += at.x < 0, far_right += at.x > 100;
    EXPECT_GT(left, 5000u);
    EXPECT_EQ(far_right, 0u);
}

TEST(DensityMap, SameFilesSamePlants) {
    const std::string text = scene_with(std::string(R"({"plant": "oak", "density_per_m2": 0.5, )") + k_map + "}}");
    const auto a = load(text, pgm_16()), b = load(text, pgm_16());
    ASSERT_TRUE(a && b);
    EXPECT_EQ(places_of(*a), places_of(*b));
    std::string other = pgm_16();
    other.back() = '\x10';
    other[other.size() - 2] = '\x10';
    const auto c = load(text, other);
    ASSERT_TRUE(c);
    EXPECT_NE(places_of(*a), places_of(*c));
}

TEST(DensityMap, PicturesAreWatched) {
    static std::vector<std::string> opened;
    opened.clear();
    set_file_watcher([](void*, const std::string& path) { opened.push_back(path); }, nullptr);
    const auto scene = load(scene_with(std::string(R"({"plant": "oak", "density_per_m2": 0.01, )") + k_map + "}}"), pgm_16());
    set_file_watcher(nullptr, nullptr);
    ASSERT_TRUE(scene);
    EXPECT_TRUE(std::any_of(opened.begin(), opened.end(), [](const auto& path) { return path.ends_with("/map.pgm"); }));
}

TEST(DensityMap, FaultsAreNamed) {
    struct Case {
        const char* map;
        std::string picture, place, fault;
    };
    const std::string good = pgm_16();
    const std::string rectangle = R"(, "center": [0, 0], "size_m": [100, 100])";
    float not_a_number[6] = {0.5f, 0.5f, 0.5f, NAN, 0.5f, 0.5f};
    const Case cases[] = {
        {R"("picture": "none.pgm")", good, "picture", "no such file"},
        {R"("picture": "map.pgm", "size_m": [0, 10], "center": [0, 0])", good, "size_m", "0"},
        {R"("picture": "map.pgm", "size_m": [10, 10])", good, "center", "missing"},
        {R"("picture": "map.pgm", "channel": "rad")", good, "channel", "rad"},
        {R"("picture": "map.pgm", "white": 2)", good, "white", "2"},
        {R"("picture": "map.pgm", "wide": 2)", good, "wide", "unknown"},
        {R"("picture": "map.pgm")", good.substr(0, 40), "picture", "ends early"},
        {R"("picture": "map.pgm")", "P5 0 4 255 ", "picture", "bad width"},
        {R"("picture": "map.pgm")", "P5 2 1 100 " + std::string("\x10\x70", 2), "picture", "value 112"},
        {R"("picture": "map.pgm")", "not a picture", "picture", "images plugin"},
    };
    for (const Case& each : cases) {
        const auto scene = load(scene_with(R"({"plant": "oak", "density_per_m2": 0.01, "density_map": {)" +
                                           std::string(each.map) + "}}"),
                                each.picture);
        ASSERT_FALSE(scene) << each.map;
        EXPECT_NE(scene.error().place.find("placements[0].scatter.density_map"), std::string::npos) << each.map;
        EXPECT_NE(to_string(scene.error()).find(each.place), std::string::npos) << to_string(scene.error());
        EXPECT_NE(to_string(scene.error()).find(each.fault), std::string::npos) << to_string(scene.error());
    }
    // What the plugin reads may be no number.
    static FloatPicture k_bad;
    k_bad = {2, 1, {not_a_number, not_a_number + 6}};
    static ImagesInterface images{};
    images.read_float = [](const std::string&) -> Result<FloatPicture> { return k_bad; };
    const ScratchFile file("map.exr", "v/1");
    MapPictures pictures([] { return &images; });
    const auto read = pictures.read(file.path(), MapChannel::mean);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().id, ErrorId::value_out_of_range);
    EXPECT_EQ(read.error().place, "pixel 1, 0");
    EXPECT_TRUE(pictures.read(file.path(), MapChannel::green));  // that channel is sound
}

// Distances to others.

double nearest_m(const std::vector<dvec2>& others, dvec2 at) {
    double nearest = INFINITY;
    for (const dvec2& other : others) nearest = std::min(nearest, glm::length(other - at));
    return nearest;
}

Result<Scene> load_rules(const std::string& placements) {
    return load_scene_text(R"({"plants": {"oak": {"source": "oak.json", "variations": 3},
        "birch": {"source": "birch.json"}, "fern": {"source": "fern.json"}},
        "terrain": {"flat": {"size_m": 200, "cell_m": 4}}, "placements": [)" + placements + "]}");
}

TEST(Distance, HoldsBetweenScatters) {
    const std::string oaks = R"({"scatter": {"plant": "oak", "count": 120, "spacing_m": 3, "seed": 1}})";
    const std::string ferns = R"({"scatter": {"plant": "fern", "density_per_m2": 0.3, "seed": 2)";
    const auto free = load_rules(oaks + "," + ferns + "}}");
    ASSERT_TRUE(free) << to_string(free.error());
    double nearest = INFINITY, farthest = 0.0;
    for (const dvec2& at : places_of(*free, "fern")) {
        const double away_m = nearest_m(places_of(*free, "oak"), at);
        nearest = std::min(nearest, away_m);
        farthest = std::max(farthest, away_m);
    }
    EXPECT_LT(nearest, 1.0);
    EXPECT_GT(farthest, 12.0);
    const auto ruled = load_rules(oaks + "," + ferns + R"(, "distance": {"from": "oak", "least_m": 2, "most_m": 8}}})");
    ASSERT_TRUE(ruled) << to_string(ruled.error());
    const auto placed = places_of(*ruled, "fern");
    EXPECT_EQ(places_of(*ruled, "oak").size(), places_of(*free, "oak").size());
    // All the ferns of that ring, and no others: what the rule leaves stands where it stood. Tiles round to fractions of a
    // millimetre.
    size_t expected = 0;
    for (const dvec2& at : places_of(*free, "fern")) {
        const double away_m = nearest_m(places_of(*free, "oak"), at);
        expected += away_m >= 2.0 && away_m < 8.0;
    }
    EXPECT_GT(expected, 1000u);
    EXPECT_NEAR(double(placed.size()), double(expected), 3.0);
    for (const dvec2& at : placed) {
        const double away_m = nearest_m(places_of(*ruled, "oak"), at);
        EXPECT_TRUE(away_m > 1.999 && away_m < 8.001) << away_m;
    }
}

TEST(Distance, CountsWhatIsListedAnywhereAndRulesBefore) {
    const std::string fern = R"({"scatter": {"plant": "fern", "density_per_m2": 0.5, "distance": )";
    const std::string oak = R"({"plant": "oak", "at": [10, 20]})", birch = R"({"plant": "birch", "at": [-30, 0, 5]})";
    const auto scene = load_rules(fern + R"({"from": ["oak", "birch"], "most_m": 5}}},)" + oak + "," + birch);
    ASSERT_TRUE(scene) << to_string(scene.error());
    const auto ferns = places_of(*scene, "fern");
    EXPECT_NEAR(double(ferns.size()), 2.0 * 25.0 * 3.1416 * 0.5, 30.0);
    for (const dvec2& at : ferns) EXPECT_LT(nearest_m({{10, 20}, {-30, 5}}, at), 5.0);
    // A rule that comes later has no plants yet.
    const auto later = load_rules(fern + R"({"from": "oak", "most_m": 5}}}, {"scatter": {"plant": "oak", "count": 9}})");
    ASSERT_TRUE(later) << to_string(later.error());
    EXPECT_TRUE(places_of(*later, "fern").empty());
    // Two rules hold both.
    const auto both = load_rules(fern + R"([{"from": "oak", "most_m": 30}, {"from": "birch", "least_m": 15}]}},)" +
                                 oak + R"(, {"plant": "birch", "at": [20, 20]})");
    ASSERT_TRUE(both) << to_string(both.error());
    EXPECT_GT(places_of(*both, "fern").size(), 100u);
    for (const dvec2& at : places_of(*both, "fern")) {
        EXPECT_LT(nearest_m({{10, 20}}, at), 30.0);
        EXPECT_GE(nearest_m({{20, 20}}, at), 15.0);
    }
}

TEST(Distance, CountsAreKept) {
    const auto scene = load_rules(R"({"scatter": {"plant": "oak", "count": 30, "seed": 4}},
        {"scatter": {"plant": "fern", "count": 700, "distance": {"from": "oak", "least_m": 1, "most_m": 4}}})");
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(places_of(*scene, "fern").size(), 700u);
    const auto impossible = load_rules(R"({"scatter": {"plant": "fern", "count": 7, "distance": {"from": "oak", "most_m": 4}}})");
    ASSERT_FALSE(impossible);
    EXPECT_EQ(impossible.error().id, ErrorId::value_out_of_range);
}

TEST(Distance, FaultsAreNamed) {
    for (const auto& [rule, place] : std::vector<std::pair<std::string, std::string>>{
             {R"({"from": "oka", "least_m": 1})", "distance.from"},
             {R"({"from": [], "least_m": 1})", "distance.from"},
             {R"({"from": [1], "least_m": 1})", "distance.from"},
             {R"({"least_m": 1})", "distance.from"},
             {R"({"from": "oak"})", "distance.least_m"},
             {R"({"from": "oak", "least_m": 3, "most_m": 2})", "distance.most_m"},
             {R"({"from": "oak", "least_m": 0})", "distance.least_m"},
             {R"([{"from": "oak", "least_m": 1}, {"from": "oak", "least": 1}])", "distance[1]"},
             {R"([3])", "distance[0]"},
             {R"(3)", "distance"}}) {
        const auto scene = load_rules(R"({"scatter": {"plant": "fern", "count": 7, "distance": )" + rule + "}}");
        ASSERT_FALSE(scene) << rule;
        EXPECT_NE(scene.error().place.find("placements[0].scatter." + place), std::string::npos)
            << to_string(scene.error());
    }
}

}  // namespace
}  // namespace coppice
