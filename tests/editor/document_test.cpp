#include "editor/document/document.h"

#include <sys/resource.h>
#include <csignal>
#include "plugins/vegetation/eco/load_scene.h"
#include "runtime/core/random.h"
#include "tests/editor/workplace.h"

namespace coppice {
namespace {

struct Documents : Workplace {};

TEST_F(Documents, KeepWhatTheyDoNotKnowAndEverySpaceOfIt) {
    auto session = open();
    ASSERT_TRUE(session);
    EXPECT_TRUE(session->saved());
    EXPECT_EQ(session->document().root().text->text, k_workplace_scene);
    perform(*session, "set_population", R"({"name": "fern", "importance": 2})");
    EXPECT_FALSE(session->saved());
    ASSERT_TRUE(session->save());
    const std::string saved = read("scene.eco.json");
    EXPECT_NE(saved.find(R"("note_of_the_author": {"kept": [1, 2, 3]})"), std::string::npos) << saved;
    EXPECT_LT(saved.find("oak"), saved.find("birch")) << "keys stay in their order";
    EXPECT_EQ(read("scene.eco.json.bak"), k_workplace_scene);
    session->undo();
    EXPECT_EQ(session->document().root().text->text, k_workplace_scene);
}

TEST_F(Documents, AreSavedAsScenesThatLoad) {
    auto session = open();
    perform(*session, "paint",
            R"({"scatter": {"plants": {"oak": 1, "birch": 2}, "density_per_m2": 0.3, "scale": [0.8, 1.2]},
                "stroke": [[0, 0], [30, 10]], "radius_m": 6})");
    const size_t placed = count(*session);
    EXPECT_GT(placed, 50u);
    ASSERT_TRUE(session->save());
    EXPECT_TRUE(session->saved());
    EXPECT_LT(std::filesystem::file_size(folder + "/scene.plants"), placed * 20 + 100);
    // Of birches no individuals are measured here, so that no modeller is needed.
    std::string text = read("scene.eco.json");
    text.replace(text.find(R"("individuals": 20)"), 17, R"("height_m": 9)");
    text.replace(text.find(R"("note_of_the_author": {"kept": [1, 2, 3]},)"), 42, "");
    ASSERT_TRUE(write_text_file(path, text));
    auto scene = load_scene(path, {&k_test_terrain});
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(scene->positions.size(), placed + 40);
}

TEST_F(Documents, AreTheSameBytesInWhateverOrderTheyCameToBe) {
    auto a = open(false), b = open(false);
    std::vector<const char*> places{
        R"({"population": "oak", "at": [1, 2]})", R"({"population": "fern", "at": [-50, 2], "turn_deg": 0})",
        R"({"population": "birch", "at": [1, 2], "scale": 2})", R"({"population": "oak", "at": [1, 2]})"};
    for (const char* place : places) perform(*a, "place", place);
    std::reverse(places.begin(), places.end());
    for (const char* place : places) perform(*b, "place", place);
    EXPECT_EQ(all_bytes(a->document()), all_bytes(b->document()));
    EXPECT_EQ(a->document().hash(), b->document().hash());
}

TEST_F(Documents, ListWhatTheyCannotReadAndShowTheRest) {
    ASSERT_TRUE(write_text_file(path, R"({"plants": {}, "placements": [{"packed": "lost.plants"}],
        "references": [{"scene": "missing.eco.json"}, {"scene": "broken.eco.json"}, {"scene": "good.eco.json"}]})"));
    ASSERT_TRUE(write_text_file(folder + "/broken.eco.json", "{\"plants\": "));
    ASSERT_TRUE(write_text_file(folder + "/good.eco.json", R"({"plants": {}, "placements": []})"));
    ASSERT_TRUE(write_text_file(folder + "/lost.plants", "CPLA and then nothing"));
    auto session = open();
    ASSERT_TRUE(session);
    const std::vector<Error>& faults = session->document().faults();
    ASSERT_EQ(faults.size(), 3u);
    EXPECT_TRUE(faults[0].file.ends_with("lost.plants"));
    EXPECT_TRUE(faults[1].file.ends_with("missing.eco.json"));
    EXPECT_EQ(faults[1].id, ErrorId::file_missing);
    EXPECT_TRUE(faults[2].file.ends_with("broken.eco.json"));
    EXPECT_EQ(faults[2].id, ErrorId::syntax);
    EXPECT_NE(session->document().find(folder + "/good.eco.json"), nullptr);
    // What could not be read is not written over.
    perform(*session, "add_population", R"({"name": "oak", "source": "oak.json"})");
    EXPECT_EQ(refuse(*session, "place", R"({"population": "oak", "at": [0, 0]})").id, ErrorId::file_corrupt);
    ASSERT_TRUE(session->save());
    EXPECT_EQ(read("lost.plants"), "CPLA and then nothing");
}

TEST_F(Documents, ThatAreNoObjectsAreRefused) {
    for (const char* text : {"", "[1, 2]", "{\"plants\": {}, ", "3"}) {
        ASSERT_TRUE(write_text_file(path, text));
        auto session = Session::open(path, {});
        ASSERT_FALSE(session) << text;
        EXPECT_EQ(session.error().id, ErrorId::syntax);
    }
}

TEST_F(Documents, KeepTheirPlantsWhereThePopulationIsGone) {
    auto session = open();
    perform(*session, "place", R"({"population": "fern", "at": [3, 4]})");
    perform(*session, "place", R"({"population": "oak", "at": [5, 4]})");
    ASSERT_TRUE(session->save());
    std::string text = read("scene.eco.json");
    text.replace(text.find("\"fern\""), 6, "\"bracken\"");
    ASSERT_TRUE(write_text_file(path, text));
    session.reset();
    session = open();
    EXPECT_EQ(count(*session, "fern"), 1u);
    perform(*session, "move", R"({"near": [3, 4], "by": [1, 0]})");
    perform(*session, "become", R"({"populations": ["fern"], "population": "bracken"})");
    EXPECT_EQ(count(*session, "bracken"), 1u);
    EXPECT_EQ(count(*session, "fern"), 0u);
}

// A disk without room, as far as a process can have one.
struct NoRoom {
    NoRoom() {
        ::getrlimit(RLIMIT_FSIZE, &before);
        old = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit none{64, before.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &none);
    }
    ~NoRoom() {
        ::setrlimit(RLIMIT_FSIZE, &before);
        std::signal(SIGXFSZ, old);
    }
    rlimit before{};
    void (*old)(int) = nullptr;
};

TEST_F(Documents, StayWholeOnAFullDisk) {
    auto session = open();
    const char* place = R"({"population": "oak", "at": [1, 2]})";
    perform(*session, "place", place);
    ASSERT_TRUE(session->save());
    const std::string text = read("scene.eco.json"), plants = read("scene.plants");
    {
        NoRoom full;
        perform(*session, "place", place);
        EXPECT_EQ(session->take_warnings().size(), 1u) << "that the journal cannot be written is said";
        const Status saved = session->save();
        ASSERT_FALSE(saved);
        EXPECT_EQ(saved.error().id, ErrorId::write_failed);
        EXPECT_FALSE(session->saved());
    }
    EXPECT_EQ(read("scene.eco.json"), text);
    EXPECT_EQ(read("scene.plants"), plants);
    EXPECT_EQ(count(*session), 2u) << "nothing is lost in the program";
    perform(*session, "place", place);
    EXPECT_TRUE(session->take_warnings().empty());
    // The journal has all of it again: a kill now loses nothing.
    auto journal = Journal::read(journal_path(path));
    ASSERT_TRUE(journal);
    EXPECT_EQ(journal->edits.size(), 2u);
    ASSERT_TRUE(session->save());
    EXPECT_EQ(count(*open(false)), 3u);
}

TEST(PlantSets, FindWhatTheyHoldAndNothingElse) {
    Random random(4);
    std::vector<PlacedPlant> plants;
    for (int i = 0; i < 3000; ++i)
        plants.push_back(pack_placed(
            {double(random.next_in(-200.0f, 200.0f)), 0.0, double(random.next_in(-200.0f, 200.0f))}, 1.0f, {},
            0, 0));
    PlantSet set;
    set.add(plants);
    EXPECT_EQ(set.size(), plants.size());
    for (int i = 0; i < 50; ++i) {
        const dvec2 a(random.next_in(-250.0f, 250.0f), random.next_in(-250.0f, 250.0f));
        const dvec2 b = a + dvec2(random.next_in(0.0f, 150.0f), random.next_in(0.0f, 150.0f));
        size_t wanted = 0, found = 0;
        for (const PlacedPlant& plant : plants) {
            const dvec2 at = ground_place(plant);
            wanted += at.x >= a.x && at.x <= b.x && at.y >= a.y && at.y <= b.y;
        }
        set.each_in(a, b, [&](const PlacedPlant&) { ++found; });
        EXPECT_EQ(found, wanted);
    }
    const PlacedPlant stranger = pack_placed({0.5, 3.0, 0.5}, 2.0f, {}, 7, 0);
    EXPECT_FALSE(set.remove({{plants[0], stranger}}));
    EXPECT_EQ(set.size(), plants.size());
    EXPECT_FALSE(set.remove({{plants[0], plants[0]}})) << "it is there once";
    EXPECT_TRUE(set.remove(plants));
    EXPECT_TRUE(set.cells().empty());
}

TEST_F(Documents, OneEditorAtATimeHasAScene) {
    auto first = open();
    ASSERT_TRUE(first);
    auto second = Session::open(path, {&k_test_terrain});
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().id, ErrorId::write_failed);
    EXPECT_NE(to_string(second.error()).find("another editor"), std::string::npos);
    first.reset();
    EXPECT_FALSE(std::filesystem::exists(path + ".lock"));
    // What a program left that was killed holds nobody out.
    ASSERT_TRUE(write_text_file(path + ".lock", ""));
    EXPECT_TRUE(open());
}

TEST_F(Documents, WhatAnotherProgramWroteIsNotSavedOver) {
    auto session = open();
    perform(*session, "place", R"({"population": "oak", "at": [0, 0]})");
    const std::string theirs = std::string(k_workplace_scene) + "\n";
    ASSERT_TRUE(write_text_file(path, theirs));
    EXPECT_EQ(session->document().changed_elsewhere(), std::vector<std::string>{path});
    const Status refused = session->save();
    ASSERT_FALSE(refused);
    EXPECT_NE(to_string(refused.error()).find("another program"), std::string::npos);
    EXPECT_EQ(read("scene.eco.json"), theirs);
    EXPECT_FALSE(std::filesystem::exists(folder + "/scene.plants"));
    EXPECT_FALSE(session->saved());
    ASSERT_TRUE(session->save(true));
    EXPECT_EQ(read("scene.eco.json.bak"), theirs);
    EXPECT_TRUE(session->saved());
    EXPECT_TRUE(session->document().changed_elsewhere().empty());
    // Also a file that came where there was none, and one that is gone.
    std::filesystem::remove(path);
    perform(*session, "set_population", R"({"name": "oak", "importance": 3})");
    EXPECT_FALSE(session->save());
    ASSERT_TRUE(session->save(true));
    EXPECT_EQ(count(*session, "oak"), 1u);
}

}  // namespace
}  // namespace coppice
