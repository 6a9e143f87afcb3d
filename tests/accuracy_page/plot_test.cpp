#include "tools/accuracy/log_plot.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include "tests/accuracy_page/made_record.h"

using namespace coppice;

namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

LogPlotSettings make_settings() { return {"a plot", "time, ms", {1, 100}, {0.01, 1}}; }
std::string at(double x, double y) { return fmt::format("translate({:.1f},{:.1f})", x, y); }

}  // namespace

TEST(LogPlot, PutsAPointWhereItsLogarithmsSay) {
    const LogPlotFrame frame;
    const double middle_x = (frame.left + frame.width - frame.right) / 2;
    const double bottom = frame.height - frame.bottom, quarter = (bottom - frame.top) / 4;
    const std::string svg =
        log_plot({{{"m0", "red", 0}, {{10, 0.01, "low"}, {100, std::sqrt(0.1), "high"}}}}, make_settings());
    EXPECT_NE(svg.find(at(middle_x, bottom) + "\"><title>low"), std::string::npos) << svg;
    EXPECT_NE(svg.find(at(frame.width - frame.right, bottom - 3 * quarter) + "\"><title>high"),
              std::string::npos)
        << svg;
}

TEST(LogPlot, KeepsWhatNoAxisReachesAtItsEnd) {
    const LogPlotFrame frame;
    const std::string svg =
        log_plot({{{"m0", "red", 0}, {{0, 0, "zero"}, {1e9, 1e9, "huge"}}}}, make_settings());
    EXPECT_NE(svg.find(at(frame.left, frame.height - frame.bottom)), std::string::npos);
    EXPECT_NE(svg.find(at(frame.width - frame.right, frame.top)), std::string::npos);
}

TEST(LogPlot, LeavesOutWhatIsNoNumber) {
    LogPlotSettings settings = make_settings();
    settings.reference = {{k_nan, 1, ""}};
    const std::string svg =
        log_plot({{{"m0", "red", 0}, {{k_nan, 0.1, "lost"}, {2, 0.1, "kept"}}}}, settings);
    EXPECT_EQ(svg.find("lost"), std::string::npos);
    EXPECT_NE(svg.find("kept"), std::string::npos);
    EXPECT_FALSE(has_word(svg, "nan"));
}

TEST(LogPlot, ShadesWhatIsBetterThanTheReference) {
    const LogPlotFrame frame;
    LogPlotSettings settings = make_settings();
    EXPECT_EQ(log_plot({}, settings).find("better"), std::string::npos);
    settings.reference = {{10, 0.1, ""}};
    const double width = (frame.width - frame.left - frame.right) / 2;
    const double height = (frame.height - frame.top - frame.bottom) / 2;
    EXPECT_NE(
        log_plot({}, settings)
            .find(fmt::format("class=\"better\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"",
                              frame.left, frame.top + height, width, height)),
        std::string::npos);
}

TEST(LogTicks, AreOnesTwosAndFives) {
    EXPECT_EQ(log_ticks({0.9, 110}), (std::vector<double>{1, 2, 5, 10, 20, 50, 100}));
    EXPECT_EQ(log_ticks({0.05, 0.5}), (std::vector<double>{0.05, 0.1, 0.2, 0.5}));
}

TEST(LogTicks, StayFewOverManyDecadesAndEnoughWithinOne) {
    EXPECT_EQ(log_ticks({1, 1e6}).size(), 7u);
    EXPECT_EQ(log_ticks({0.055, 0.085}), (std::vector<double>{0.06, 0.07, 0.08}));
    EXPECT_GE(log_ticks({0.101, 0.119}).size(), 3u);
}

TEST(LogRange, CoversWhatIsPositive) {
    const std::vector<double> values = {0, -3, k_nan, 2, 50, std::numeric_limits<double>::infinity()};
    const LogRange range = log_range(values);
    EXPECT_LT(range.low, 2);
    EXPECT_GT(range.low, 1);
    EXPECT_GT(range.high, 50);
    EXPECT_LT(range.high, 100);
    const LogRange none = log_range({});
    EXPECT_LT(none.low, none.high);
}

TEST(LineKey, LooksDifferentForEveryOneOfTwelve) {
    std::vector<std::string> keys;
    for (uint32_t pattern = 0; pattern < 12; ++pattern) {
        const std::string key = line_key({"", "red", pattern});
        EXPECT_EQ(std::count(keys.begin(), keys.end(), key), 0) << pattern;
        keys.push_back(key);
    }
}
