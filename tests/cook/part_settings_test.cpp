#include "plugins/vegetation/cook/part_settings.h"

#include <gtest/gtest.h>

namespace coppice {
namespace {

TEST(PartSettings, AreReadAsTheyAreWritten) {
    const auto read = parse_part_settings(
        R"({"parts": {"leaves": {"kind": "points", "importance": 1.5}, "twigs": {"kind": "lines"}, "bark": {}}})", "a");
    ASSERT_TRUE(read) << to_string(read.error());
    EXPECT_EQ(*read, (std::vector<PartSettings>{{"bark", PartKind::automatic, 0.0f},
                                                {"leaves", PartKind::points, 1.5f},
                                                {"twigs", PartKind::lines, 0.0f}}));
    EXPECT_TRUE(parse_part_settings("{}", "a")->empty());
    for (PartKind kind : {PartKind::automatic, PartKind::points, PartKind::lines, PartKind::leaves}) {
        const auto one =
            parse_part_settings(std::string(R"({"parts": {"a": {"kind": ")") + name_of(kind) + R"("}}})", "a");
        ASSERT_TRUE(one);
        EXPECT_EQ(one->at(0).kind, kind);
    }
}

TEST(PartSettings, FaultsNamePlaceAndRemedy) {
    struct Case {
        const char *json, *place, *remedy;
    };
    for (const Case& wrong : {Case{R"({"parts": {"leaves": {"kind": "dots"}}})", "parts.leaves.kind", "points"},
                              Case{R"({"parts": {"leaves": {"importence": 2}}})", "parts.leaves", "importance"},
                              Case{R"({"parts": {"leaves": {"importance": -1}}})", "parts.leaves.importance", "0"},
                              Case{R"({"parts": {"leaves": {"importance": 1e9}}})", "parts.leaves.importance", "1000"},
                              Case{R"({"parts": {"leaves": 3}})", "parts.leaves", ""},
                              Case{R"({"parts": [1]})", "parts", ""}, Case{R"({"part": {}})", "", "parts"},
                              Case{R"({"parts": )", "line 1", ""}, Case{"[]", "", ""}}) {
        const auto read = parse_part_settings(wrong.json, "birch.json.lod.json");
        ASSERT_FALSE(read) << wrong.json;
        const std::string said = to_string(read.error());
        EXPECT_NE(said.find("birch.json.lod.json"), std::string::npos) << said;
        EXPECT_NE(said.find(wrong.place), std::string::npos) << said;
        EXPECT_NE(said.find(wrong.remedy), std::string::npos) << said;
    }
}

TEST(PartSettings, HashesDifferWhereSettingsDo) {
    const std::vector<PartSettings> one{{"a", PartKind::points, 1.0f}};
    std::vector<uint64_t> hashes{hash_part_settings({}), hash_part_settings(one)};
    for (const PartSettings& other : {PartSettings{"b", PartKind::points, 1.0f}, {"a", PartKind::lines, 1.0f},
                                      {"a", PartKind::points, 2.0f}})
        hashes.push_back(hash_part_settings({other}));
    for (size_t i = 0; i < hashes.size(); ++i)
        for (size_t j = 0; j < i; ++j) EXPECT_NE(hashes[i], hashes[j]);
}

}  // namespace
}  // namespace coppice
