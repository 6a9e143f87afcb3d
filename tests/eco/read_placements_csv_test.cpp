#include "plugins/vegetation/eco/read_placements_csv.h"

#include "tests/eco/scratch.h"

namespace coppice {
namespace {

Result<std::vector<Placement>> read(std::string_view text) {
    ScratchFile file("plants.csv", text);
    CsvSettings settings;
    settings.kinds = {{"oak", {{{0}, {1}}, 10.0f}}, {"fern", {{{2}}, 0.0f}}};
    settings.offset = dvec2(-1000.0, 0.0);
    return read_placements_csv(file.path(), settings);
}

TEST(ReadPlacementsCsv, TakesColumnsInAnyOrder) {
    auto plants = read("species,height,x,y\n\noak,20,1001.5,2\r\n\"fern\", ,1003,-4e1\n");
    ASSERT_TRUE(plants) << to_string(plants.error());
    ASSERT_EQ(plants->size(), 2u);
    EXPECT_EQ((*plants)[0].position_world, dvec3(1.5, 0, 2));
    EXPECT_EQ((*plants)[0].scale, 2.0f);
    EXPECT_LT((*plants)[0].model.model, 2u);
    EXPECT_EQ((*plants)[1].position_world, dvec3(3, 0, -40));
    EXPECT_EQ((*plants)[1].scale, 1.0f);
    EXPECT_EQ((*plants)[1].model.model, 2u);
}

TEST(ReadPlacementsCsv, TakesOtherSeparatorsAndColumns) {
    auto semicolons = read("\xef\xbb\xbfid;x;y;species;diameter\n7;1;2;\"oak\";0.4\n");
    ASSERT_TRUE(semicolons) << to_string(semicolons.error());
    EXPECT_EQ(semicolons->size(), 1u);
    auto tabs = read("x\ty\tspecies\n1\t2\toak");
    ASSERT_TRUE(tabs) << to_string(tabs.error());
    EXPECT_EQ(tabs->front().position_world.z, 2.0);
    EXPECT_TRUE(read("x,y,species\n")->empty());
}

TEST(ReadPlacementsCsv, EveryFaultByItsLine) {
    struct Case {
        const char* text;
        ErrorId id;
        const char* place;
    };
    for (const Case& bad : std::initializer_list<Case>{
             {"", ErrorId::syntax, "line 1"},
             {"x,y\n1,2\n", ErrorId::syntax, "line 1"},
             {"x,y,species,x\n", ErrorId::syntax, "line 1"},
             {"x,y,species\n1,2\n", ErrorId::syntax, "line 2"},
             {"x,y,species\n1,2,oak\n1,2,\"oak\n", ErrorId::syntax, "line 3"},
             {"x,y,species\n1,2,oak\n\n1,abc,oak\n", ErrorId::value_out_of_range, "line 4"},
             {"x,y,species\n1,nan,oak\n", ErrorId::value_out_of_range, "line 2"},
             {"x,y,species\n1,1e300,oak\n", ErrorId::value_out_of_range, "line 2"},
             {"x,y,species\n1,2 ,oka\n", ErrorId::name_unknown, "line 2"},
             {"x,y,species,height\n1,2,oak,-3\n", ErrorId::value_out_of_range, "line 2"},
             {"x,y,species,height\n1,2,fern,0.3\n", ErrorId::value_out_of_range, "line 2"},
             {"x,y,species,diameter\n1,2,oak,x\n", ErrorId::value_out_of_range, "line 2"},
         }) {
        auto plants = read(bad.text);
        ASSERT_FALSE(plants) << bad.text;
        EXPECT_EQ(plants.error().id, bad.id) << bad.text << to_string(plants.error());
        EXPECT_EQ(plants.error().place, bad.place) << bad.text << to_string(plants.error());
        EXPECT_FALSE(plants.error().remedy.empty());
    }
    EXPECT_NE(read("x,y,species\n1,2,oka\n").error().remedy.find("'oak'"), std::string::npos);
    EXPECT_EQ(read_placements_csv("nowhere.csv", {}).error().id, ErrorId::file_missing);
}

}  // namespace
}  // namespace coppice
