// The figures, the table and the page made from a playthrough that never was.
#include <algorithm>
#include <string>
#include <gtest/gtest.h>
#include "tools/coppice/page_text.h"
#include "tools/coppice/play_options.h"
#include "tools/coppice/play_page.h"
#include "tools/coppice/play_plot.h"
#include "tools/coppice/play_report.h"
#include "tools/coppice/statistics.h"

using namespace coppice;

namespace {

PlayRecord make_record(uint32_t frame_count) {
    PlayRecord record;
    record.scene_name = "a <b> & \"c\"";
    record.width = 64;
    record.height = 48;
    record.fps = 10;
    record.passes = {"points", "resolve"};
    for (uint32_t i = 0; i < frame_count; ++i) {
        FrameRecord frame{i, i * 0.1, 10.0 + i, 1.0, {2.0, 3.0}, {}};
        frame.report.points = 100;
        frame.report.lines = 10;
        frame.report.triangles = 1;
        frame.report.vertices = 100 + 2 * 10 + 3;
        record.frames.push_back(frame);
    }
    return record;
}

double value_of(const std::vector<Figure>& figures, const std::string& name) {
    for (const Figure& figure : figures)
        if (figure.name == name) return figure.value;
    ADD_FAILURE() << name;
    return 0;
}

size_t count_of(const std::string& text, const std::string& word) {
    size_t count = 0;
    for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
}

}  // namespace

TEST(Statistics, QuantilesAreLinearBetweenNeighbours) {
    EXPECT_EQ(median({}), 0.0);
    EXPECT_EQ(median({3, 1, 2}), 2.0);
    EXPECT_EQ(median({4, 1, 2, 3}), 2.5);
    EXPECT_EQ(quantile({0, 10}, 0.95), 9.5);
    EXPECT_EQ(quantile({5, 7}, 1.0), 7.0);
}

TEST(PlayFigures, AreWhatTheFramesSay) {
    const std::vector<Figure> figures = play_figures(make_record(5));
    EXPECT_EQ(value_of(figures, "median_ms"), 12.0);
    EXPECT_EQ(value_of(figures, "slowest_ms"), 14.0);
    EXPECT_NEAR(value_of(figures, "median_hz"), 1000.0 / 12.0, 1e-9);
    EXPECT_EQ(value_of(figures, "vertices"), 123.0);
    EXPECT_EQ(value_of(figures, "pass_resolve_ms"), 3.0);
}

TEST(PlayFigures, ComparisonIsTheRatioOfTheMedians) {
    PlayRecord record = make_record(3);
    record.compared = {{0, 10, 300, 1, 1, 30}, {1, 20, 900, 1, 1, 31}, {2, 12, 360, 1, 1, 32}};
    const std::vector<Figure> figures = play_figures(record);
    EXPECT_EQ(value_of(figures, "full_over_lod"), 360.0 / 12.0);
    EXPECT_EQ(value_of(figures, "psnr_to_full_db"), 30.0) << "of the worst frame";
}

TEST(Figure, HoldsInItsDirection) {
    EXPECT_TRUE(holds({"a", 31, "Hz", 30.0}));
    EXPECT_FALSE(holds({"a", 29, "Hz", 30.0}));
    EXPECT_TRUE(holds({"a", 29, "ms", 30.0, Reach::at_most}));
    EXPECT_FALSE(holds({"a", 31, "ms", 30.0, Reach::at_most}));
    EXPECT_TRUE(to_json({"a", 1, "", {}}).at("holds").is_null());
    EXPECT_EQ(to_json({"a", 29, "Hz", 30.0}).at("holds"), false);
}

TEST(FramesCsv, HasAsManyColumnsInEveryLine) {
    const std::string csv = frames_csv(make_record(4));
    size_t columns = 0, lines = 0;
    for (size_t first = 0; first < csv.size(); ++lines) {
        const size_t end = csv.find('\n', first);
        const size_t commas = size_t(std::count(csv.begin() + long(first), csv.begin() + long(end), ','));
        if (lines == 0) columns = commas;
        EXPECT_EQ(commas, columns) << csv.substr(first, end - first);
        first = end + 1;
    }
    EXPECT_EQ(lines, 5u);
    EXPECT_NE(csv.find("gpu_points_ms"), std::string::npos);
}

TEST(PlayPage, EscapesWhatTheSceneIsCalled) {
    const std::string page = play_page(make_record(3));
    EXPECT_NE(page.find("a &lt;b&gt; &amp; &quot;c&quot;"), std::string::npos);
    EXPECT_EQ(page.find("<b> &"), std::string::npos);
}

TEST(PlayPage, EmbedsPicturesAsBase64) {
    PlayRecord record = make_record(1);
    PlayPicture picture{0, 0.0, "frame_0000.png", {}, 7};
    for (char c : std::string("Man!")) picture.png.push_back(std::byte(c));
    record.pictures.push_back(picture);
    EXPECT_NE(play_page(record).find("base64,TWFuIQ==\""), std::string::npos);
}

TEST(PlayPage, StaysReadableForOneFrameAndForThousands) {
    for (uint32_t frames : {1u, 5000u}) {
        const std::string page = play_page(make_record(frames));
        EXPECT_EQ(count_of(page, "<svg"), 2u);
        EXPECT_EQ(page.find("nan"), std::string::npos);
        EXPECT_EQ(page.find("inf,"), std::string::npos);
        EXPECT_LT(page.size(), 400'000u) << frames;
    }
}

TEST(StackedPlot, SaysWhenItCutsPeaks) {
    std::vector<double> x(300), y(300, 1.0);
    for (size_t i = 0; i < x.size(); ++i) x[i] = double(i);
    EXPECT_EQ(stacked_plot(x, {{"a", "#000", y}}, {}).find("cut off"), std::string::npos);
    y[100] = 50.0;
    EXPECT_NE(stacked_plot(x, {{"a", "#000", y}}, {}).find("peaks up to 50 are cut off"), std::string::npos);
}

TEST(ShortCount, KeepsThreeDigits) {
    EXPECT_EQ(short_count(0), "0");
    EXPECT_EQ(short_count(999), "999");
    EXPECT_EQ(short_count(1234567), "1.23 M");
    EXPECT_EQ(short_count(999999), "1 M");
    EXPECT_EQ(short_count(2.5e13), "25 T");
}

TEST(ChosenFrames, AreSpreadOrListed) {
    EXPECT_EQ(*chosen_frames("3", 11), (std::vector<uint32_t>{0, 5, 10}));
    EXPECT_EQ(*chosen_frames("0", 11), std::vector<uint32_t>());
    EXPECT_EQ(*chosen_frames("1", 11), std::vector<uint32_t>{0});
    EXPECT_EQ(*chosen_frames("9", 2), (std::vector<uint32_t>{0, 1}));
    EXPECT_EQ(*chosen_frames("7,3,3,99", 11), (std::vector<uint32_t>{3, 7}));
    EXPECT_EQ(*chosen_frames("5,", 11), std::vector<uint32_t>{5});
    EXPECT_FALSE(chosen_frames("1;2", 11));
    EXPECT_FALSE(chosen_frames("-1", 11));
}
