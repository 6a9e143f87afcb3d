#include "tools/accuracy/accuracy_summary.h"
#include <limits>
#include <gtest/gtest.h>
#include "tests/accuracy_page/made_record.h"

using namespace coppice;

TEST(MeanPoints, AverageTimeAndEveryErrorOverTheViews) {
    const std::vector<MethodPoint> means = mean_points(make_record());
    ASSERT_EQ(means.size(), 4u);
    const MethodPoint& fine = means[1];
    EXPECT_EQ(fine.method, 1u);
    EXPECT_EQ(fine.quality, 0.5);
    EXPECT_DOUBLE_EQ(fine.frame_ms, 100.0);
    EXPECT_DOUBLE_EQ(fine.points, 3.0);
    EXPECT_DOUBLE_EQ(fine.errors.rmse, 0.08);
    EXPECT_DOUBLE_EQ(fine.errors.psnr_db, 20.0);
    EXPECT_DOUBLE_EQ(fine.errors.coverage_bias, -0.08);
    EXPECT_DOUBLE_EQ(fine.unshadowed_errors.flip, 0.04);
}

TEST(MeanPoints, LeaveOutWhatSomeViewLacks) {
    for (const MethodPoint& point : mean_points(make_record())) EXPECT_NE(point.quality, 0.1);
    EXPECT_EQ(view_points(make_record(), 0).size(), 5u);
    EXPECT_EQ(view_points(make_record(), 1).size(), 4u);
}

TEST(BestWithin, IsTheLeastFlipThatIsQuickEnough) {
    const AccuracyRecord record = make_record();
    EXPECT_FALSE(best_within(record, 17.9));
    EXPECT_EQ(best_within(record, 18.0)->method, 2u) << "the budget itself is within";
    EXPECT_EQ(best_within(record, 33.0)->method, 2u) << "as good as the other, and quicker";
    EXPECT_EQ(best_within(record, 100.5)->quality, 0.5);
    EXPECT_EQ(best_within(record, 1e6)->method, 1u) << "full geometry is slower and worse";
}

TEST(BestWithin, GoesByTheReferenceAskedFor) {
    AccuracyRecord record = make_record();
    for (AccuracySample& sample : record.samples)
        if (sample.method == 2) sample.unshadowed_errors.flip = 0.001;
    EXPECT_EQ(best_within(record, 1e6, Truth::shadowed)->method, 1u);
    EXPECT_EQ(best_within(record, 1e6, Truth::unshadowed)->method, 2u);
}

TEST(BestWithin, NeverPicksWhatIsNotANumber) {
    AccuracyRecord record = make_record();
    for (AccuracySample& sample : record.samples)
        if (sample.method == 2) sample.errors.flip = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(best_within(record, 33.0)->method, 1u);
}

TEST(Default, IsTheMarkedMethodAtTheQualityNearestToItsDefault) {
    AccuracyRecord record = make_record();
    EXPECT_EQ(default_method(record), 1u);
    record.methods[1].default_quality = 0.6;
    EXPECT_EQ(point_at_default(record, mean_points(record), 1)->quality, 0.5);
    record.methods[1].is_default = false;
    EXPECT_EQ(default_method(record), record.full_method);
    EXPECT_FALSE(point_at_default(record, {}, 1));
}

TEST(SettingText, PutsTheUnitBehindTheNumber) {
    EXPECT_EQ(setting_text({"", "", "d' px"}, 0.5), "d' 0.5 px");
    EXPECT_EQ(setting_text({"", "", "texels across"}, 64), "texels across 64");
    EXPECT_EQ(setting_text({"", "", ""}, 1), "");
}
