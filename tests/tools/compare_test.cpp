// Whether a difference is one: the rank tests against counting by hand, verdicts, reports, two programs in turn.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include "runtime/core/random.h"
#include "tests/tools/run_program.h"
#include "tools/coppice/comparison.h"
#include "tools/coppice/compare_folders.h"
#include "tools/coppice/lockstep_program.h"
#include "tools/coppice/rank_tests.h"
#include "tools/coppice/statistics.h"

using namespace coppice;
using nlohmann::json;

namespace {

// A report of flights whose frames take these times, all alike within a repeat.
std::string write_report(const std::string& folder, const std::vector<double>& repeat_ms, int vertices = 1000,
                         const std::string& processor = "a processor") {
    std::filesystem::create_directories(folder);
    std::ofstream(folder + "/summary.json")
        << json{{"settings", {{"width", 64}, {"repeats", repeat_ms.size()}}},
                {"scene", {{"name", "meadow"}}},
                {"machine", {{"processor", processor}}}};
    std::ofstream csv(folder + "/frames.csv");
    csv << "frame,repeat,FrameTime,vertices\n";
    for (size_t repeat = 0; repeat < repeat_ms.size(); ++repeat)
        for (int frame = 0; frame < 3; ++frame)
            csv << frame << ',' << repeat << ',' << repeat_ms[repeat] << ',' << vertices << '\n';
    return folder;
}

// A shell script to be run in place of coppice.
std::string write_program(const std::string& path, const std::string& script) {
    std::ofstream(path) << "#!/bin/sh\n" << script << "\n";
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
}

}  // namespace

TEST(RankTests, AgreeWithCountingByHand) {
    // Six positive differences: 2 of 2^6 ways of signs are as lopsided.
    EXPECT_NEAR(signed_rank_p(std::vector<double>{1, 2, 3, 4, 5, 6}), 2.0 / 64.0, 1e-12);
    // The smallest is negative: sums 0 and 1 of the minority, on both sides.
    EXPECT_NEAR(signed_rank_p(std::vector<double>{-1, 2, 3, 4, 5, 6}), 4.0 / 64.0, 1e-12);
    EXPECT_NEAR(signed_rank_p(std::vector<double>{1, -1, 0}), 1.0, 1e-12);
    EXPECT_EQ(signed_rank_p({}), 1.0);
    // Two groups of five that do not overlap: 2 of 252 choices.
    EXPECT_NEAR(rank_sum_p(std::vector<double>{1, 2, 3, 4, 5}, std::vector<double>{6, 7, 8, 9, 10}),
                2.0 / 252.0, 1e-12);
    EXPECT_NEAR(rank_sum_p(std::vector<double>{1, 1, 1}, std::vector<double>{1, 1, 1}), 1.0, 1e-12);
    // 1 3 against 2 4: rank sums 3 to 7 of six choices, 4 and 6 and beyond are as far from 5.
    EXPECT_NEAR(rank_sum_p(std::vector<double>{1, 3}, std::vector<double>{2, 4}), 4.0 / 6.0, 1e-12);
}

TEST(RankTests, FindNothingInNoiseAsOftenAsTheySay) {
    Random random(7);
    int paired = 0, grouped = 0;
    constexpr int k_trials = 2000;
    for (int trial = 0; trial < k_trials; ++trial) {
        std::vector<double> differences(15), a(8), b(8);
        for (double& value : differences) value = random.next_in(-1, 1);
        for (double& value : a) value = random.next_in(0, 1);
        for (double& value : b) value = random.next_in(0, 1);
        paired += signed_rank_p(differences) < 0.05;
        grouped += rank_sum_p(a, b) < 0.05;
    }
    // Exact tests err on the side of finding nothing; four standard deviations above 5 %.
    EXPECT_LT(paired, 0.07 * k_trials);
    EXPECT_LT(grouped, 0.07 * k_trials);
    EXPECT_GT(paired, 0.02 * k_trials);
    EXPECT_GT(grouped, 0.02 * k_trials);
}

// Where counting gives way to the normal distribution, a verdict does not depend on which of the two it was.
TEST(RankTests, ExactAndNormalAgreeWhereOneTakesOver) {
    Random random(11);
    double worst = 0.0, worst_share = 0.0;
    for (int trial = 0; trial < 30; ++trial) {
        const bool ties = trial % 3 == 0;
        auto draw = [&](size_t count, double shift) {
            std::vector<double> values(count);
            for (double& value : values) {
                value = shift + random.next_in(-1, 1);
                if (ties) value = std::round(5.0 * value);
            }
            return values;
        };
        const double shift = 0.0075 * trial;
        const size_t some = trial % 2 ? k_exact_limit / 2 : k_exact_limit / 3;
        const std::vector<double> differences = draw(k_exact_limit, shift), a = draw(some, 0.0),
                                  b = draw(k_exact_limit - some, 2.0 * shift);
        for (const auto& [exact, normal] :
             {std::pair(exact_signed_rank_p(differences), normal_signed_rank_p(differences)),
              std::pair(exact_rank_sum_p(a, b), normal_rank_sum_p(a, b))}) {
            worst = std::max(worst, std::fabs(exact - normal));
            if (exact >= 0.001) worst_share = std::max(worst_share, std::fabs(normal / exact - 1.0));
        }
    }
    RecordProperty("worst_difference", std::to_string(worst));
    RecordProperty("worst_share", std::to_string(worst_share));
    EXPECT_LT(worst, 0.002);
    EXPECT_LT(worst_share, 0.2);
}

TEST(RankTests, LongComparisonsAreJudgedAtOnce) {
    Random random(3);
    std::vector<double> differences(20'000), later(20'000);
    for (double& value : differences) value = random.next_in(-1, 1);
    for (size_t i = 0; i < later.size(); ++i) later[i] = differences[later.size() - 1 - i] + 0.05;
    EXPECT_GT(signed_rank_p(differences), 1e-3);
    EXPECT_LT(signed_rank_p(later), 1e-6);
    EXPECT_LT(rank_sum_p(differences, later), 1e-6);
    EXPECT_NEAR(shift_between(differences, later), 0.05, 1e-9);
    EXPECT_NEAR(shift_of(later) - shift_of(differences), 0.05, 1e-9);
}

TEST(RankTests, EstimateTheShift) {
    EXPECT_EQ(shift_of(std::vector<double>{1, 2, 3, 100}), 2.75);
    EXPECT_EQ(shift_of(std::vector<double>{-1, 0, 1}), 0.0);
    EXPECT_EQ(shift_of({}), 0.0);
    EXPECT_EQ(shift_between(std::vector<double>{1, 2, 3}, std::vector<double>{11, 12, 13}), 10.0);
    Random random(5);
    for (size_t count : {1, 2, 7, 30}) {
        std::vector<double> values(count), means;
        for (double& value : values) value = std::round(random.next_in(-9, 9)) * (count % 2 ? 1.0 : 0.1);
        for (size_t i = 0; i < count; ++i)
            for (size_t k = i; k < count; ++k) means.push_back(0.5 * (values[i] + values[k]));
        EXPECT_EQ(shift_of(values), median(means)) << count << " values";
    }
}

TEST(Comparison, NeedsRareAndLargeEnough) {
    const double more = std::log(1.1), little = std::log(1.01);
    Comparison comparison;
    comparison.floor_share = 0.03;
    std::vector<double> ratios(20, 0.0);
    for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = more + 0.001 * double(i % 5);
    comparison.effect = effect_of_pairs(ratios);
    EXPECT_EQ(speed_of(comparison), Speed::slower);
    EXPECT_NEAR(comparison.effect.share, 0.102, 0.001);
    for (double& ratio : ratios) ratio = -ratio;
    comparison.effect = effect_of_pairs(ratios);
    EXPECT_EQ(speed_of(comparison), Speed::faster);
    EXPECT_TRUE(status_of(comparison));
    for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = little + 0.001 * double(i % 5);
    comparison.effect = effect_of_pairs(ratios);
    EXPECT_LT(comparison.effect.chance, k_chance) << "sure, but";
    EXPECT_EQ(speed_of(comparison), Speed::same) << "below the floor";
    for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = i % 2 ? 5.0 * more : -4.0 * more;
    comparison.effect = effect_of_pairs(ratios);
    EXPECT_EQ(speed_of(comparison), Speed::inconclusive) << "large, but it may be noise";
    for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = i % 2 ? 0.1 : -0.1;
    comparison.effect = effect_of_pairs(ratios);
    EXPECT_EQ(speed_of(comparison), Speed::same);
    comparison.itself = {0.05, 0.001};
    EXPECT_EQ(speed_of(comparison), Speed::inconclusive);
    EXPECT_EQ(exit_code_of(status_of(comparison).error().id), 4);
}

TEST(Comparison, CountsAreGatesWhateverTheTimes) {
    const std::map<std::string, double> base{{"points", 1000}, {"allocations", 10}, {"tiles", 5}};
    auto grew = [&](const std::map<std::string, double>& again,
                    const std::map<std::string, double>& changed) {
        std::string names;
        for (const CountChange& change : compare_counts(base, again, changed, 0.03))
            if (change.grew) names += change.name + " ";
        return names;
    };
    EXPECT_EQ(grew(base, base), "");
    EXPECT_EQ(grew(base, {{"points", 1020}, {"allocations", 10}, {"tiles", 1}, {"new", 7}}), "");
    EXPECT_EQ(grew(base, {{"points", 1040}, {"allocations", 10}}), "points ");
    EXPECT_EQ(grew({}, {{"allocations", 11}}), "allocations ");
    EXPECT_EQ(grew({{"allocations", 11}}, {{"allocations", 11}}), "") << "it varies by itself";
    Comparison comparison;
    comparison.itself = {0.5, 0.0};
    comparison.counts = {{"points", 1, 2, true}};
    EXPECT_EQ(exit_code_of(status_of(comparison).error().id), 1);
}

TEST(CompareFolders, TellsRepeatsApart) {
    const std::string folder = fresh_folder();
    const std::string base = write_report(folder + "/base", {10.0, 10.1, 10.2, 10.05, 10.15}),
                      slow = write_report(folder + "/slow", {11.0, 11.1, 11.2, 11.05, 11.15}),
                      noisy = write_report(folder + "/noisy", {10, 15, 10.5, 14, 9}),
                      few = write_report(folder + "/few", {10, 10.1}),
                      more = write_report(folder + "/more", {10.0, 10.1, 10.2, 10.05, 10.15}, 1100),
                      elsewhere = write_report(folder + "/elsewhere", {11.0, 11.1, 11.2, 11.05, 11.15}, 1000,
                                               "another");
    const auto compare = [](const std::string& a, const std::string& b) {
        return run_coppice({"compare", a, b});
    };
    EXPECT_EQ(compare(base, base).exit_code, 0);
    EXPECT_EQ(compare(base, slow).exit_code, 1);
    EXPECT_EQ(compare(slow, base).exit_code, 0) << "faster";
    EXPECT_EQ(compare(noisy, slow).exit_code, 4) << "base would not pass against itself";
    EXPECT_EQ(compare(base, elsewhere).exit_code, 4) << "times of two machines";
    EXPECT_EQ(compare(base, more).exit_code, 1) << "10 % more vertices";
    EXPECT_EQ(compare(base, few).exit_code, 2);
    std::ofstream(folder + "/slow/frames.csv") << "frame,repeat,FrameTime\n0,0,eleven\n";
    const ProgramResult broken = compare(base, slow);
    EXPECT_EQ(broken.exit_code, 2);
    EXPECT_NE(broken.err.find("line 2"), std::string::npos) << broken.err;
}

TEST(ComparePrograms, CountsAgreeAndAMissingProgramIsNamed) {
    const std::string folder = fresh_folder(),
                      scene = std::string(COPPICE_SOURCE_DIR) + "/content/species/daisy.json";
    const ProgramResult result =
        run_coppice({"compare", COPPICE_PROGRAM, COPPICE_PROGRAM, "--scene", scene, "--headless", "64x48",
                     "--seconds", "1", "--floor", "100", "--json", folder + "/comparison.json"},
                    {"XDG_CACHE_HOME=" + folder});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::ifstream stream(folder + "/comparison.json");
    const json comparison = json::parse(stream);
    EXPECT_GE(comparison.at("samples"), 12);
    EXPECT_GT(comparison.at("base_ms"), 0.0);
    for (const json& count : comparison.at("counts"))
        EXPECT_EQ(count.at("name"), "allocations") << "the same program draws the same: " << count;
    const ProgramResult missing =
        run_coppice({"compare", COPPICE_PROGRAM, folder + "/nothing", "--scene", scene});
    EXPECT_EQ(missing.exit_code, 2);
    EXPECT_NE(missing.err.find("nothing"), std::string::npos) << missing.err;
    EXPECT_EQ(run_coppice({"compare", COPPICE_PROGRAM, COPPICE_PROGRAM}).exit_code, 2) << "no scene";
    const auto compare = [&](const std::string& base, const std::string& changed) {
        return run_coppice({"compare", base, changed, "--scene", scene, "--headless", "64x48"},
                           {"XDG_CACHE_HOME=" + folder});
    };
    EXPECT_EQ(compare(COPPICE_PROGRAM, "/bin/true").exit_code, 1) << "a program that says nothing";
    EXPECT_EQ(compare("/bin/true", COPPICE_PROGRAM).exit_code, 2) << "with such a base nothing is compared";
    const std::string
        crashes = write_program(folder + "/crashes", "echo oh no >&2; kill -SEGV $$"),
        later = write_program(
            folder + "/later",
            R"(echo '{"frames": 3}'; read line; echo '{"ms": 1, "counts": {}}'; kill -SEGV $$)"),
        draws = write_program(
            folder + "/draws",
            R"(echo '{"frames": 3}'; while read line; do echo '{"ms": 1, "counts": {}}'; done)");
    for (const auto& [program, when] :
         {std::pair(crashes, "before its first frame"), std::pair(later, "while drawing")}) {
        const ProgramResult of_new = compare(draws, program), of_base = compare(program, draws);
        EXPECT_EQ(of_new.exit_code, 1) << of_new.err;
        EXPECT_EQ(of_base.exit_code, 2) << of_base.err;
        EXPECT_NE(of_base.err.find(program + ": base: was ended by signal 11"), std::string::npos)
            << of_base.err;
        EXPECT_NE(of_base.err.find(when), std::string::npos) << of_base.err;
    }
    EXPECT_NE(compare(draws, crashes).err.find("oh no"), std::string::npos) << "what it said itself";
    EXPECT_NE(compare(draws, crashes).err.find(crashes + ": new: "), std::string::npos);
}

// Cooking before the first frame takes as long as it takes, as long as something is done.
TEST(LockstepProgram, TellsASlowStartFromAHang) {
    const std::string folder = fresh_folder();
    const LockstepLimits limits{0.3, 20.0};
    const auto start = [&](const std::string& name, const std::string& script, const LockstepLimits& within) {
        return LockstepProgram::start(write_program(folder + "/" + name, script), {}, within);
    };
    const std::string ready = R"(echo '{"frames": 3}'; )";
    const auto cooks = start(
        "cooks", "n=0; while [ $n -lt 1500000 ]; do n=$((n + 1)); done; " + ready + "read line", limits);
    ASSERT_TRUE(cooks) << to_string(cooks.error());
    EXPECT_EQ((*cooks)->frame_count(), 3u);

    const auto idle = start("idle", "exec sleep 60", limits);
    ASSERT_FALSE(idle);
    EXPECT_NE(idle.error().fault.find("did nothing for 0.3 s before its first frame"), std::string::npos)
        << to_string(idle.error());
    const auto endless = start("endless", "while :; do :; done", {0.3, 1.0});
    ASSERT_FALSE(endless);
    EXPECT_NE(endless.error().fault.find("was not ready for 1 s"), std::string::npos)
        << to_string(endless.error());
    const auto stuck = start("stuck", ready + "while :; do :; done", limits);
    ASSERT_TRUE(stuck) << to_string(stuck.error());
    const auto drawn = (*stuck)->draw(0, 0.0);
    ASSERT_FALSE(drawn);
    EXPECT_NE(drawn.error().fault.find("gave no answer for 0.3 s while drawing"), std::string::npos)
        << to_string(drawn.error());
}
