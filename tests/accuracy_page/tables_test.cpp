#include "tools/accuracy/accuracy_tables.h"
#include <limits>
#include <locale>
#include <vector>
#include <gtest/gtest.h>
#include "tests/accuracy_page/made_record.h"
#include "tools/accuracy/accuracy_page.h"

using namespace coppice;

namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();

struct DecimalComma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

// As RFC 4180 has it.
std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
    std::vector<std::vector<std::string>> lines(1, {""});
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
            lines.back().back() += text[++i];
        else if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            lines.back().push_back("");
        else if (c == '\n' && !quoted)
            lines.push_back({""});
        else
            lines.back().back() += c;
    }
    lines.pop_back();  // behind the last line's end
    return lines;
}

}  // namespace

TEST(AccuracyCsv, HasALineASampleWithAsManyColumnsAsNames) {
    const AccuracyRecord record = make_record();
    const auto lines = parse_csv(accuracy_csv(record));
    ASSERT_EQ(lines.size(), record.samples.size() + 1);
    EXPECT_EQ(lines[0].size(), 9u + 2 * 7);
    for (const auto& line : lines) EXPECT_EQ(line.size(), lines[0].size()) << line[0];
    EXPECT_EQ(lines[2][0], record.methods[1].name);
    EXPECT_EQ(lines[2][2], record.views[0].name);
    EXPECT_EQ(lines[2][1], "0.1");
    EXPECT_EQ(lines[0].back(), "unshadowed_mean_color_bias");
    EXPECT_EQ(lines[2].back(), "0.0005");
}

TEST(AccuracyCsv, WritesDecimalPointsWhateverTheLocale) {
    const std::string before = accuracy_csv(make_record());
    const std::locale old = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
    const std::string after = accuracy_csv(make_record()), page = accuracy_page(make_record());
    std::locale::global(old);
    EXPECT_EQ(before, after);
    EXPECT_NE(before.find("0.0005"), std::string::npos);
    EXPECT_EQ(page, accuracy_page(make_record()));
}

TEST(AccuracyCsv, LeavesWhatIsNoNumberEmpty) {
    AccuracyRecord record = make_record();
    record.samples[0].errors.psnr_db = k_infinity;
    const auto lines = parse_csv(accuracy_csv(record));
    EXPECT_EQ(lines[0][10], "psnr_db");
    EXPECT_EQ(lines[1][10], "");
    EXPECT_EQ(lines[2][10], "20");
}

TEST(AccuracyJson, ListsFiguresAsOtherBenchmarksDo) {
    const nlohmann::json json = accuracy_json(make_record());
    EXPECT_EQ(json.at("name"), "accuracy");
    EXPECT_EQ(json.at("device"), "none");
    const nlohmann::json& figures = json.at("figures");
    ASSERT_EQ(figures.size(), 3u);
    EXPECT_EQ(
        figures[0],
        (nlohmann::json{
            {"name", "reached"}, {"value", 60.0}, {"unit", "times"}, {"reach", 50.0}, {"holds", true}}));
    EXPECT_EQ(figures[1].at("holds"), false);
    EXPECT_TRUE(figures[2].at("reach").is_null());
    EXPECT_TRUE(figures[2].at("holds").is_null());
}

TEST(AccuracyJson, KeepsEverySampleAndMakesInfinityNull) {
    AccuracyRecord record = make_record();
    record.samples[1].unshadowed_errors.psnr_db = k_infinity;
    const nlohmann::json json = nlohmann::json::parse(accuracy_json(record).dump());
    ASSERT_EQ(json.at("samples").size(), record.samples.size());
    const nlohmann::json& sample = json.at("samples")[1];
    EXPECT_TRUE(sample.at("unshadowed_errors").at("psnr_db").is_null());
    EXPECT_EQ(sample.at("errors").at("psnr_db"), 20.0);
    EXPECT_EQ(sample.at("quality"), 0.1);
    EXPECT_EQ(sample.at("list_bytes"), 5);
    EXPECT_EQ(json.at("resting").size(), 3u);
    EXPECT_EQ(json.at("views")[1].at("plant_coverage"), 0.2);
    EXPECT_EQ(json.at("methods")[1].at("pop_energy"), 1e-4);
    EXPECT_TRUE(json.at("methods")[0].at("shimmer").is_null());
}
