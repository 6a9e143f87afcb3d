#include "editor/session/run_script.h"

#include "tests/editor/workplace.h"

namespace coppice {
namespace {

struct Scripts : Workplace {
    Status run(Session& session, const std::string& commands) {
        EXPECT_TRUE(write_text_file(folder + "/script.json", "{\"commands\": [" + commands + "]}"));
        return run_script(session, folder + "/script.json");
    }
};

TEST_F(Scripts, LayOutAndCheckASceneWithoutAWindow) {
    auto session = open();
    const Status done = run(*session, R"(
        {"paint": {"scatter": {"plants": {"oak": 1, "fern": 4}, "density_per_m2": 1}, "stroke": [[0, 0], [8, 0]], "radius_m": 4}},
        {"place": {"population": "birch", "at": [30, 30]}},
        {"expect": {"populations": ["birch"], "count": 1}},
        {"undo": {}}, {"expect": {"populations": ["birch"], "count": 0}},
        {"redo": {}}, {"expect": {"region": {"circle": {"center": [30, 30], "radius_m": 1}}, "count": 1}},
        {"expect": {"least": 60, "most": 180}},
        {"export_csv": {"csv": "plants.csv"}}, {"export_gltf": {"gltf": "plants.gltf"}}, {"save": {}})");
    ASSERT_TRUE(done) << to_string(done.error());
    EXPECT_TRUE(session->saved());
    EXPECT_NE(read("plants.csv").find("30,30,birch"), std::string::npos);
    EXPECT_NE(read("plants.gltf").find("\"birch\""), std::string::npos);
    EXPECT_EQ(count(*open(false), "birch"), 1u);
}

TEST_F(Scripts, StopWhereTheyFailAndSayWhere) {
    auto session = open();
    const std::string good = R"({"place": {"population": "oak", "at": [0, 0]}}, )";
    const Status unexpected = run(*session, good + R"({"expect": {"count": 3}}, {"undo": {}})");
    ASSERT_FALSE(unexpected);
    EXPECT_EQ(unexpected.error().id, ErrorId::regressed);
    EXPECT_EQ(exit_code_of(unexpected.error().id), 1);
    EXPECT_EQ(unexpected.error().place, "commands[1].expect.count");
    EXPECT_EQ(count(*session), 1u);
    const Status wrong = run(*session, good + R"({"place": {"population": "oak", "at": "here"}})");
    ASSERT_FALSE(wrong);
    EXPECT_EQ(exit_code_of(wrong.error().id), 2);
    EXPECT_EQ(wrong.error().place, "commands[1].place.at");
    EXPECT_TRUE(wrong.error().file.ends_with("script.json"));
    for (const char* broken :
         {"3", R"({"place": {}, "move": {}})", "{}", R"({"undo": {"times": 99}})", R"({"undo": 3})",
          R"({"save": {"to": "x"}})", R"({"export_csv": {}})", R"({"dance": {}})"})
        EXPECT_FALSE(run(*session, broken)) << broken;
    EXPECT_FALSE(run_script(*session, folder + "/none.json"));
}

TEST_F(Scripts, SayWhatCannotBeWritten) {
    auto session = open();
    const Status exported = run(*session, R"({"export_csv": {"csv": "/proc/nothing/plants.csv"}})");
    ASSERT_FALSE(exported);
    EXPECT_EQ(exported.error().id, ErrorId::write_failed);
}

}  // namespace
}  // namespace coppice
