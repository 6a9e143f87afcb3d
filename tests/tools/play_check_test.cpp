// Budgets, their verdicts, and the figures of pace, of playthroughs that never were.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include "tools/coppice/frame_pace.h"
#include "tools/coppice/golden_pictures.h"
#include "tools/coppice/play_check.h"
#include "tools/coppice/play_junit.h"
#include "tools/coppice/play_record.h"
#include "tools/coppice/play_trace.h"

using namespace coppice;

namespace {

// Every frame of repeat r takes ms_of_repeat[r].
PlayRecord make_record(const std::vector<double>& ms_of_repeat, uint64_t points = 1000) {
    PlayRecord record;
    record.scene_name = "a <meadow>";
    record.device = "a device";
    record.passes = {"points", "resolve"};
    record.repeats = uint32_t(ms_of_repeat.size());
    for (uint32_t repeat = 0; repeat < ms_of_repeat.size(); ++repeat)
        for (uint32_t i = 0; i < 40; ++i) {
            FrameRecord frame{i, i * 0.1, ms_of_repeat[repeat], 1.0, {2.0, 3.0}, {}, repeat};
            frame.start_ms = 100.0 * i + 5000.0 * repeat;
            frame.cpu_ms = 4.0;
            frame.report.points = points;
            record.frames.push_back(frame);
        }
    return record;
}

Check check_one(const PlayRecord& record, const std::string& budget) {
    const auto budgets = parse_budgets(budget);
    EXPECT_TRUE(budgets) << to_string(budgets.error());
    return check_playthrough(record, *budgets).front();
}

}  // namespace

TEST(FramePace, TellsBothLowsApart) {
    std::vector<double> frames_ms(200, 10.0);
    frames_ms[40] = 100.0;
    frames_ms[150] = 50.0;
    const FramePace pace = measure_pace(frames_ms);
    EXPECT_EQ(pace.p50_ms, 10.0);
    EXPECT_NEAR(pace.mean_ms, (198 * 10.0 + 150.0) / 200.0, 1e-12);
    EXPECT_NEAR(pace.low_1_percent_as_p99_hz, 1000.0 / pace.p99_ms, 1e-9);
    EXPECT_NEAR(pace.low_1_percent_as_mean_hz, 1000.0 / 75.0, 1e-9) << "two of two hundred";
    EXPECT_LT(pace.low_1_percent_as_mean_hz, pace.low_1_percent_as_p99_hz);
    EXPECT_EQ(measure_pace({}).p99_ms, 0.0);
}

TEST(FramePace, AHitchIsLongerThanItsNeighboursNotThanAll) {
    std::vector<double> frames_ms(100, 10.0);
    EXPECT_EQ(measure_pace(frames_ms).hitches, 0u);
    frames_ms[50] = 21.0;
    EXPECT_EQ(measure_pace(frames_ms).hitches, 1u);
    frames_ms[50] = 19.0;
    EXPECT_EQ(measure_pace(frames_ms).hitches, 0u);
    // A scene that becomes three times as slow and stays so: no hitch, however much longer than before.
    for (size_t i = 50; i < 100; ++i) frames_ms[i] = 30.0;
    EXPECT_LE(measure_pace(frames_ms).hitches, k_hitch_frames) << "until the median has followed";
    for (double& ms : frames_ms) ms = 1.0;
    frames_ms[50] = 3.0;
    EXPECT_EQ(measure_pace(frames_ms).hitches, 0u) << "nobody sees two milliseconds";
}

TEST(FramePace, OverBudgetIsCountedAndSummed) {
    const std::vector<double> frames_ms{10, 20, 33, 40, 34};
    const OverBudget over = measure_over_budget(frames_ms, 33.0);
    EXPECT_EQ(over.frames, 2u);
    EXPECT_NEAR(over.ms, 8.0, 1e-12);
}

TEST(Budgets, AreReadWithTheirUnits) {
    const auto budgets = parse_budgets("frame=33ms,gpu=0.5s,memory=2GiB,error=0.05,points=1e6");
    ASSERT_TRUE(budgets) << to_string(budgets.error());
    ASSERT_EQ(budgets->size(), 5u);
    EXPECT_EQ((*budgets)[0].limit, 33.0);
    EXPECT_EQ((*budgets)[1].limit, 500.0);
    EXPECT_EQ((*budgets)[2].limit, 2048.0);
    EXPECT_EQ((*budgets)[3].limit, 0.05);
    EXPECT_EQ((*budgets)[4].limit, 1e6);
    EXPECT_TRUE(parse_budgets("")->empty());
    for (const char* wrong : {"frame", "frame=", "frame=33", "frame=33MiB", "frame=-1ms", "frame=nanms",
                              "memory=1ms", "points=1ms", "speed=3", "=", "frame=33ms,,gpu=1ms"})
        EXPECT_FALSE(parse_budgets(wrong)) << wrong;
    EXPECT_NE(parse_budgets("speed=3").error().remedy.find("device-memory"), std::string::npos);
}

TEST(Budgets, OfTimesAreDecidedWhereAllRepeatsAgree) {
    EXPECT_EQ(check_one(make_record({10, 12, 11}), "frame=20ms").verdict, Verdict::passed);
    EXPECT_EQ(check_one(make_record({30, 32, 31}), "frame=20ms").verdict, Verdict::failed);
    EXPECT_EQ(check_one(make_record({10, 32, 31}), "frame=20ms").verdict, Verdict::inconclusive);
    PlayRecord busy = make_record({30, 32, 31});
    busy.others_share = 0.5;
    EXPECT_EQ(check_one(busy, "frame=20ms").verdict, Verdict::inconclusive);
    EXPECT_EQ(check_one(busy, "frame=40ms").verdict, Verdict::passed) << "others do not make it faster";
    EXPECT_EQ(check_one(busy, "cpu=5ms").verdict, Verdict::passed);
    EXPECT_EQ(check_one(make_record({30}), "gpu=4ms").verdict, Verdict::failed) << "two passes take 5 ms";
}

TEST(Budgets, OfCountsTakeTheWorstFrameOnAnyMachine) {
    PlayRecord record = make_record({10, 10});
    record.others_share = 0.9;
    record.frames[63].report.points = 5000;
    EXPECT_EQ(check_one(record, "points=4999").verdict, Verdict::failed);
    EXPECT_EQ(check_one(record, "points=5000").verdict, Verdict::passed);
    EXPECT_EQ(check_one(record, "error=0.5").verdict, Verdict::failed) << "nothing was compared";
}

TEST(Checks, RepeatsMustDrawTheSame) {
    PlayRecord record = make_record({10, 10});
    ASSERT_EQ(check_playthrough(record, {}).size(), 1u);
    EXPECT_TRUE(status_of(check_playthrough(record, {})));
    record.frames[41].report.points += 1;
    const std::vector<Check> checks = check_playthrough(record, {});
    EXPECT_EQ(checks.front().verdict, Verdict::failed);
    EXPECT_EQ(checks.front().value, 1.0);
    record.settings.time_budget_ms = 10.0f;
    EXPECT_TRUE(check_playthrough(record, {}).empty()) << "d' follows the clock";
}

TEST(Checks, ExitCodesPutFailuresBeforeDoubts) {
    const Check passed{"a", Verdict::passed, 1, 2, "", ""},
        failed{"b", Verdict::failed, 3, 2, "", "too much"},
        unclear{"c", Verdict::inconclusive, 3, 2, "", "noise"};
    EXPECT_TRUE(status_of({passed}));
    EXPECT_EQ(exit_code_of(status_of({unclear, passed, failed}).error().id), 1);
    EXPECT_EQ(exit_code_of(status_of({unclear, passed}).error().id), 4);
}

TEST(Junit, HasACaseACheckAndEscapesText) {
    PlayRecord record = make_record({10});
    record.checks = {{"frame", Verdict::failed, 3, 2, "ms", "3 > 2 & \"more\""},
                     {"gpu", Verdict::inconclusive, 3, 2, "ms", "noise"},
                     {"points", Verdict::passed, 1, 2, "", ""}};
    const std::string xml = junit_xml(record);
    EXPECT_NE(xml.find("tests=\"3\" failures=\"1\" errors=\"0\" skipped=\"1\""), std::string::npos) << xml;
    EXPECT_NE(xml.find("a &lt;meadow&gt;"), std::string::npos);
    EXPECT_NE(xml.find("<failure message=\"3 &gt; 2 &amp; &quot;more&quot;\"/>"), std::string::npos) << xml;
    EXPECT_NE(xml.find("name=\"points\"></testcase>"), std::string::npos);
}

TEST(Trace, LaysPassesBehindTheFramesSubmission) {
    const PlayRecord record = make_record({10});
    const auto trace = nlohmann::json::parse(chrome_trace(record));
    std::map<std::string, std::vector<nlohmann::json>> slices;
    for (const auto& event : trace.at("traceEvents"))
        if (event.at("ph") == "X") slices[event.at("name")].push_back(event);
    ASSERT_EQ(slices["points"].size(), 40u);
    ASSERT_EQ(slices["frame 7"].size(), 1u);
    const double frame_us = slices["frame 7"][0].at("ts"), points_us = slices["points"][7].at("ts"),
                 resolve_us = slices["resolve"][7].at("ts");
    EXPECT_EQ(frame_us, 700'000.0);
    EXPECT_EQ(points_us, frame_us + 4000.0);
    EXPECT_EQ(resolve_us, points_us + 2000.0);
}

TEST(PictureDistance, SeesWhatIsSmallAndWholeAndNotWhatIsScattered) {
    Picture grey{128, 64, std::vector<uint8_t>(128 * 64 * 4, 128)};
    EXPECT_EQ(picture_distance(grey, grey)->largest, 0.0);
    Picture spot = grey;  // something of 5 x 5 pixels is missing
    for (uint32_t y = 20; y < 25; ++y)
        for (uint32_t x = 50; x < 55; ++x) spot.rgba[4 * (y * 128 + x)] = 255;
    Picture scattered = grey;  // as many pixels, far from each other
    for (uint32_t i = 0; i < 25; ++i) scattered.rgba[4 * ((i / 5 * 12 + 3) * 128 + i % 5 * 25 + 9)] = 255;
    const GoldenSettings settings;
    EXPECT_GT(picture_distance(grey, spot)->largest, settings.tolerance);
    EXPECT_LT(picture_distance(grey, scattered)->largest, settings.tolerance);
    const Picture map = picture_distance(grey, spot)->map;
    EXPECT_GT(map.rgba[4 * (22 * 128 + 52)], map.rgba[4 * (50 * 128 + 100)]);
}
