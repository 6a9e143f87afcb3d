// What is set of a plant's parts: an edit like any other, of a file beside the plant.
#include "plugins/vegetation/cook/part_settings.h"

#include "tests/editor/workplace.h"

namespace coppice {
namespace {

struct Parts : Workplace {
    std::string settings_path() const { return part_settings_path(folder + "/oak.json"); }
    bool is_there() const { return std::filesystem::exists(settings_path()); }
    std::vector<PartSettings> saved() const {
        auto settings = read_part_settings(folder + "/oak.json");
        EXPECT_TRUE(settings) << to_string(settings.error());
        return settings.value_or(std::vector<PartSettings>());
    }
};

constexpr const char* k_leaves_as_points =
    R"({"population": "oak", "part": "leaves", "kind": "points", "importance": 2})";

TEST_F(Parts, AreSavedBesideThePlantAndUndone) {
    auto session = open();
    EXPECT_EQ(perform(*session, "set_part", k_leaves_as_points), "set oak: leaves");
    EXPECT_FALSE(is_there());
    EXPECT_FALSE(session->saved());
    ASSERT_TRUE(session->save());
    EXPECT_EQ(saved(), (std::vector<PartSettings>{{"leaves", PartKind::points, 2.0f}}));
    perform(*session, "set_part", R"({"population": "oak", "part": "leaves", "kind": "automatic"})");
    perform(*session, "set_part", R"({"population": "oak", "part": "twigs", "kind": "lines"})");
    ASSERT_TRUE(session->save());
    EXPECT_EQ(saved(), (std::vector<PartSettings>{{"leaves", PartKind::automatic, 2.0f},
                                                  {"twigs", PartKind::lines, 0.0f}}));
    // Back to before there was a file: there is none.
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(session->undo().empty());
    EXPECT_FALSE(session->saved());
    ASSERT_TRUE(session->save());
    EXPECT_FALSE(is_there());
    EXPECT_TRUE(session->saved());
    EXPECT_FALSE(session->redo().empty());
    ASSERT_TRUE(session->save());
    EXPECT_EQ(saved().size(), 1u);
    auto nothing = session->perform("set_part", nlohmann::json::parse(k_leaves_as_points));
    ASSERT_TRUE(nothing);
    EXPECT_EQ(*nothing, nullptr);
}

TEST_F(Parts, RefuseWhatTheCookWould) {
    // A key that the cook refuses is said before anything is changed.
    ASSERT_TRUE(write_text_file(settings_path(), R"({"parts": {"leaves": {"colour": 3}}})"));
    auto session = open();
    const auto refused = session->perform("set_part", nlohmann::json::parse(k_leaves_as_points));
    ASSERT_FALSE(refused);
    EXPECT_NE(to_string(refused.error()).find("colour"), std::string::npos);
    EXPECT_EQ(session->history().edits().size(), 0u);
    ASSERT_TRUE(write_text_file(settings_path(), R"({"parts": {"bark": {"importance": 3}}})"));
    session.reset();
    session = open();
    perform(*session, "set_part", k_leaves_as_points);
    ASSERT_TRUE(session->save());
    EXPECT_EQ(saved().size(), 2u) << "the other part's stay";
    EXPECT_EQ(refuse(*session, "set_part", R"({"population": "elm", "part": "leaves"})").id,
              ErrorId::name_unknown);
    EXPECT_EQ(refuse(*session, "set_part", R"({"population": "oak", "part": "leaves", "kind": "dots"})").id,
              ErrorId::name_unknown);
    EXPECT_EQ(
        refuse(*session, "set_part", R"({"population": "oak", "part": "leaves", "importance": -1})").id,
        ErrorId::value_out_of_range);
    EXPECT_EQ(refuse(*session, "set_part", R"({"population": "oak"})").id, ErrorId::syntax);
}

TEST_F(Parts, AreRecoveredWithTheOtherSteps) {
    ASSERT_TRUE(write_text_file(settings_path(), R"({"parts": {"bark": {"importance": 3}}})"));
    uint64_t hash = 0;
    {
        auto session = open();
        perform(*session, "set_part", k_leaves_as_points);
        perform(*session, "set_part", R"({"population": "birch", "part": "leaves", "importance": 0.5})");
        hash = session->document().hash();
    }
    auto session = open();
    ASSERT_EQ(session->recoverable_count(), 2u);
    auto recovered = session->recover();
    ASSERT_TRUE(recovered) << to_string(recovered.error());
    EXPECT_EQ(*recovered, 2u);
    EXPECT_EQ(session->document().hash(), hash);
    ASSERT_TRUE(session->save());
    EXPECT_EQ(saved().size(), 2u);
    EXPECT_EQ(read_part_settings(folder + "/birch.json")->size(), 1u);
}

// A plant is opened by itself; nothing but its settings is ever written.
TEST_F(Parts, OfAPlantByItself) {
    ASSERT_TRUE(write_text_file(folder + "/oak.json", R"({"form": "tree", "levels": [{}]})"));
    path = folder + "/oak.json";
    const auto files = [&] {
        std::set<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            names.insert(entry.path().filename().string());
        return names;
    };
    const std::set<std::string> before = files();
    {
        auto session = open();
        EXPECT_TRUE(session->saved());
        EXPECT_EQ(refuse(*session, "add_population", R"({"name": "elm", "source": "elm.json"})").id,
                  ErrorId::usage);
        EXPECT_EQ(refuse(*session, "place", R"({"population": "oak", "at": [0, 0]})").id, ErrorId::usage);
        perform(*session, "set_part", k_leaves_as_points);
    }
    auto session = open();
    ASSERT_EQ(session->recoverable_count(), 1u);
    ASSERT_TRUE(session->recover());
    ASSERT_TRUE(session->save());
    EXPECT_TRUE(session->saved());
    session.reset();
    std::set<std::string> after = before;
    after.insert("oak.json.lod.json");
    EXPECT_EQ(files(), after);
    EXPECT_EQ(saved().size(), 1u);
}

}  // namespace
}  // namespace coppice
