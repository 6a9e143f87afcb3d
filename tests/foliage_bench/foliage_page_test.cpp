// The page and the JSON say what was measured.
#include <gtest/gtest.h>
#include "tools/foliage/foliage_record.h"

namespace coppice {
namespace {

FoliageRecord made_record() {
    FoliageRecord record;
    record.name = "Ash <& tree>";
    record.leaf_count = 3000;
    record.collapse_s = 0.25;
    for (uint32_t i = 1; i <= 20; ++i) {
        SweepStep step;
        step.leaf_count = 3000 - 142 * i;
        step.change = {ChangeCost{1.5 / i, 0.125, 12'000 / i}, ChangeCost{0.25, 0.0625, 777},
                       ChangeCost{0.0, 0.0001, 4}};
        record.sweep.push_back(step);
    }
    record.levels = {{1500, 0.0123, 0.987}};
    record.dropped = {{1500, 0.31, 0.21, 0.11, 0.07, 0.05, 0.8}};
    record.grove_file = "ash-grove.png";
    record.drawn = {{2250, 4.5, 1.625, 0.0001, "ash-2250.png"}};
    return record;
}

TEST(FoliagePage, ShowsPlantLevelsAndPictures) {
    const std::string page = foliage_page({made_record()}, "llvmpipe", "machine", "coppice bench foliage");
    for (const char* text :
         {"Ash &lt;&amp; tree&gt;", "VDF", "LoDF", "leaf lifetimes", "3000 leaves", "ash-2250.png",
          "ash-grove.png", "4.5 ms", "<td>1.23</td><td>-1.300</td>", "<td>777</td>",
          "<td>31.0</td><td>21.0</td><td>11.0</td><td>7.0</td><td>5.0</td><td>80.0</td>", "llvmpipe"})
        EXPECT_NE(page.find(text), std::string::npos) << text;
    EXPECT_EQ(page.find("<& tree>"), std::string::npos) << "names are text";
    EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST(FoliagePage, APlantOfTwoLeavesHasAPageToo) {
    FoliageRecord record;
    record.name = "twig";
    record.leaf_count = 2;
    const std::string page = foliage_page({record}, "", "", "");
    EXPECT_NE(page.find("2 leaves"), std::string::npos);
    EXPECT_EQ(page.find("nan"), std::string::npos);
}

TEST(FoliageJson, HasEveryStep) {
    const nlohmann::json json = foliage_json(made_record());
    ASSERT_EQ(json.at("sweep").size(), 20u);
    EXPECT_EQ(json["sweep"][0]["vdf"]["bytes"], 12'000);
    EXPECT_EQ(json["sweep"][0]["lodf"]["extract_ms"], 0.25);
    EXPECT_EQ(json["levels"][0]["area"], 0.987);
    EXPECT_EQ(json["drawn"][0]["leaves_ms"], 4.5);
    EXPECT_EQ(json["leaves"], 3000);
}

}  // namespace
}  // namespace coppice
