// Everything can be undone, and done again.
#include <fmt/format.h>
#include "runtime/core/random.h"
#include "tests/editor/workplace.h"

namespace coppice {
namespace {

using Json = nlohmann::json;

// Commands as a person might give them, sensible or not.
class RandomCommands {
  public:
    explicit RandomCommands(uint64_t seed) : random_(seed) {}

    std::pair<std::string, Json> next(const Document& document) {
        names_.clear();
        for (const auto& [name, entry] : document.root().text->json["plants"].items()) names_.push_back(name);
        const Json at = place();
        switch (random_.next_below(24)) {
            case 0:
            case 1:
            case 2:
            case 3:
                return {
                    "paint",
                    {{"scatter", rule()}, {"stroke", {at, place(), place()}}, {"radius_m", 3 + below(6)}}};
            case 4:
            case 5: {
                Json erase = {{"stroke", {at, place()}}, {"radius_m", 2 + below(8)}, {"share", 0.7}};
                if (below(2)) erase["populations"] = {population()};
                return {"erase", erase};
            }
            case 6:
                return {"fill", {{"polygon", {at, place(), place()}}, {"scatter", rule()}}};
            case 7:
            case 8:
                return {"place",
                        {{"population", population()},
                         {"at", at},
                         {"scale", 0.5 + below(3)},
                         {"tilt_deg", below(20)}}};
            case 9:
                return {"move", {{"near", at}, {"radius_m", 40}, {"by", {below(9) - 4, below(9) - 4}}}};
            case 10:
                return {"turn", {{"region", circle(at)}, {"by_deg", below(300)}, {"about", at}}};
            case 11:
                return {"scale", {{"region", circle(at)}, {"by", 0.8 + 0.1 * below(5)}}};
            case 12:
                return {"delete", {{"near", at}, {"radius_m", 30}}};
            case 13:
                return {"become", {{"region", circle(at)}, {"population", population()}}};
            case 14:
                return {"compete", {{"region", circle(at)}, {"crown_radius_m", 0.8}, {"steps", 3}}};
            case 15:
                return {"add_population",
                        {{"name", fmt::format("kind{}", below(12))},
                         {"source", "x.json"},
                         {"variations", 1 + below(4)}}};
            case 16:
                return {"set_population", {{"name", population()}, {"importance", 1 + below(4)}}};
            case 17:
                return {"rename_population",
                        {{"name", population()}, {"to", fmt::format("kind{}", below(12))}}};
            case 18:
                return {"add_rule",
                        {{"scatter", {{"plant", population()}, {"count", 5}, {"region", circle(at)}}}}};
            case 19:
                return {below(2) ? "bake_rule" : "remove_rule", {{"index", below(4)}}};
            case 20:
                return {"set_region",
                        {{"name", fmt::format("r{}", below(3))}, {"region", below(3) ? circle(at) : Json()}}};
            case 21:
                return {"nest",
                        {{"region", circle(at)},
                         {"scene", fmt::format("tile{}.eco.json", tiles_++)},
                         {"at", at}}};
            case 22:
                return {below(2) ? "move_tile" : "duplicate_tile",
                        {{"index", below(3)}, {"at", at}, {"turn_deg", below(360)}}};
            default:
                return {below(4) ? "create_tile" : "remove_tile",
                        below(2) ? Json{{"index", below(3)}}
                                 : Json{{"scene", fmt::format("tile{}.eco.json", tiles_++)}, {"at", at}}};
        }
    }

  private:
    int below(int count) { return int(random_.next_below(uint32_t(count))); }
    Json place() { return {below(160) - 80, below(160) - 80}; }
    std::string population() { return names_[size_t(below(int(names_.size())))]; }
    Json circle(const Json& at) { return {{"circle", {{"center", at}, {"radius_m", 10 + below(15)}}}}; }
    Json rule() {
        return {{"plants", {{population(), 1}, {population(), 2}}},
                {"density_per_m2", 0.02 + 0.01 * below(10)},
                {"spacing_m", 0.5},
                {"scale", {0.7, 1.2}},
                {"seed", below(1000)},
                {"exclude", "pond"}};
    }
    Random random_;
    std::vector<std::string> names_;
    int tiles_ = 0;
};

struct Histories : Workplace {};

TEST_F(Histories, Of1000RandomCommandsLeadBackAndForth) {
    auto session = open(false);
    const auto start = all_bytes(session->document());
    RandomCommands commands(11);
    size_t done = 0, refused = 0;
    std::map<std::string, size_t> done_by_name;
    std::vector<uint64_t> hashes{session->document().hash()};
    while (done < 1000) {
        const auto [name, arguments] = commands.next(session->document());
        const auto edit = session->perform(name, arguments);
        if (edit && *edit) {
            ++done;
            ++done_by_name[name];
            hashes.push_back(session->document().hash());
        } else {
            refused += !edit;
            EXPECT_EQ(session->document().hash(), hashes.back());
        }
    }
    EXPECT_EQ(done_by_name.size(), 22u) << "some command never did anything";
    EXPECT_GT(count(*session), 500u);
    const auto end = all_bytes(session->document());
    for (size_t i = done; i-- > 0;) {
        ASSERT_FALSE(session->undo().empty());
        if (i % 50 == 0 || i < 20) {
            ASSERT_EQ(session->document().hash(), hashes[i]) << i;
        }
    }
    EXPECT_TRUE(session->undo().empty());
    EXPECT_EQ(all_bytes(session->document()), start);
    for (size_t i = 0; i < done; ++i) ASSERT_FALSE(session->redo().empty());
    EXPECT_TRUE(session->redo().empty());
    EXPECT_EQ(all_bytes(session->document()), end);
    EXPECT_GT(refused, 0u) << "refused commands change nothing, which was not seen here";
}

TEST_F(Histories, SayWhatTheyUndo) {
    auto session = open();
    EXPECT_EQ(session->undo(), "");
    EXPECT_EQ(perform(*session, "place", R"({"population": "oak", "at": [0, 0]})"), "place oak");
    const std::string painted =
        perform(*session, "paint",
                R"({"scatter": {"plant": "fern", "density_per_m2": 1}, "stroke": [[50, 0]], "radius_m": 4})");
    EXPECT_EQ(painted, fmt::format("paint {} fern", count(*session, "fern")));
    EXPECT_EQ(session->undo(), painted);
    EXPECT_EQ(session->undo(), "place oak");
    EXPECT_EQ(session->redo(), "place oak");
    // What was undone is gone once something else is done.
    perform(*session, "place", R"({"population": "oak", "at": [9, 0]})");
    EXPECT_EQ(session->redo(), "");
}

TEST_F(Histories, GoOnBeforeWhatWasSaved) {
    auto session = open();
    perform(*session, "place", R"({"population": "oak", "at": [0, 0]})");
    ASSERT_TRUE(session->save());
    EXPECT_TRUE(session->saved());
    session->undo();
    EXPECT_FALSE(session->saved());
    EXPECT_EQ(count(*session), 0u);
    session->redo();
    EXPECT_TRUE(session->saved());
}

}  // namespace
}  // namespace coppice
