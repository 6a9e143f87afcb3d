// What a program that was killed leaves behind.
#include <csignal>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include "tests/editor/workplace.h"

namespace coppice {
namespace {

struct Recovery : Workplace {
    // Six steps, one of them undone again, in a process that is killed without a chance to say goodbye. The states' hashes
    // after each record of its journal.
    std::vector<uint64_t> work_and_be_killed(int save_after = -1) {
        int channel[2];
        EXPECT_EQ(::pipe(channel), 0);
        const pid_t child = ::fork();
        if (child == 0) {
            auto session = Session::open(path, {&k_test_terrain});
            auto tell = [&] {
                const uint64_t hash = (*session)->document().hash();
                if (::write(channel[1], &hash, sizeof hash) != sizeof hash) ::_exit(1);
            };
            tell();
            int step = 0;
            auto done = [&] {
                tell();
                if (step++ == save_after && !(*session)->save()) ::_exit(1);
            };
            auto act = [&](const char* name, const char* arguments) {
                auto edit = (*session)->perform(name, nlohmann::json::parse(arguments));
                if (!edit || !*edit) ::_exit(1);
                done();
            };
            act("paint",
                R"({"scatter": {"plants": {"oak": 1, "fern": 3}, "density_per_m2": 0.3}, "stroke": [[0, 0], [5, 5]], "radius_m": 3})");
            act("erase", R"({"stroke": [[4, 4]], "radius_m": 2})");
            act("set_population", R"({"name": "oak", "importance": 3})");
            act("nest",
                R"({"region": {"circle": {"center": [0, 0], "radius_m": 3}}, "scene": "tile.eco.json", "at": [0, 0]})");
            if ((*session)->undo().empty()) ::_exit(1);
            done();
            act("place", R"({"population": "birch", "at": [1, 1]})");
            ::kill(::getpid(), SIGKILL);
        }
        ::close(channel[1]);
        std::vector<uint64_t> hashes;
        uint64_t hash = 0;
        while (::read(channel[0], &hash, sizeof hash) == sizeof hash) hashes.push_back(hash);
        ::close(channel[0]);
        int status = 0;
        ::waitpid(child, &status, 0);
        EXPECT_TRUE(WIFSIGNALED(status)) << "it stopped before it was killed";
        EXPECT_EQ(hashes.size(), 7u);
        return hashes;
    }
};

TEST_F(Recovery, BringsBackAllThatWasDone) {
    const std::vector<uint64_t> hashes = work_and_be_killed();
    auto session = open();
    ASSERT_TRUE(session);
    EXPECT_EQ(session->document().hash(), hashes.front());
    EXPECT_EQ(session->recoverable_count(), 6u);
    auto recovered = session->recover();
    ASSERT_TRUE(recovered) << to_string(recovered.error());
    EXPECT_EQ(*recovered, 6u);
    EXPECT_EQ(session->document().hash(), hashes.back());
    EXPECT_FALSE(session->saved());
    // With its history; and once more, should it be killed again.
    session.reset();
    session = open();
    EXPECT_EQ(session->recoverable_count(), 6u);
    ASSERT_TRUE(session->recover());
    for (int i = 0; i < 6; ++i) EXPECT_NE(session->undo(), "");
    EXPECT_EQ(session->document().hash(), hashes.front());
}

TEST_F(Recovery, BringsBackWhatIsWholeWhereverTheJournalEnds) {
    const std::vector<uint64_t> hashes = work_and_be_killed();
    const std::string journal = read("scene.eco.json.journal");
    // Shorter and shorter; a run at each record's end and just before, and for some places between them.
    size_t last_count = 6, end_count = 0;
    for (size_t length = journal.size() + 1; length-- > 0;) {
        std::filesystem::resize_file(path + ".journal", length);
        auto content = Journal::read(path + ".journal");
        const size_t whole = content ? content->edits.size() : 0;
        ASSERT_TRUE(whole == last_count || whole + 1 == last_count) << "cut at " << length;
        const bool at_end = content && content->dropped_bytes == 0;
        end_count += at_end;
        last_count = whole;
        if (!at_end && length % 499 != 0) continue;
        const std::string cut = read("scene.eco.json.journal");
        auto session = open();
        ASSERT_TRUE(session);
        EXPECT_EQ(session->recoverable_count(), whole);
        if (whole > 0) {
            auto recovered = session->recover();
            ASSERT_TRUE(recovered);
            EXPECT_EQ(*recovered, whole);
        }
        EXPECT_EQ(session->document().hash(), hashes[whole]) << "cut at " << length;
        session->drop_journal();
        session.reset();
        ASSERT_TRUE(write_text_file(path + ".journal", cut));
    }
    EXPECT_EQ(end_count, 7u);
}

TEST_F(Recovery, StopsAtTheFirstRecordThatIsNotWhole) {
    const std::vector<uint64_t> hashes = work_and_be_killed();
    const std::string journal = read("scene.eco.json.journal");
    for (size_t at = 100; at < journal.size(); at += 331) {
        std::string changed = journal;
        changed[at] = char(changed[at] ^ 0x20);
        ASSERT_TRUE(write_text_file(path + ".journal", changed));
        auto content = Journal::read(path + ".journal");
        const size_t whole = content ? content->edits.size() : 0;
        EXPECT_LT(whole, 6u);
        auto session = open();
        ASSERT_TRUE(session);
        if (session->recoverable_count() > 0) {
            ASSERT_TRUE(session->recover());
        }
        EXPECT_EQ(session->document().hash(), hashes[whole]) << at;
        session->drop_journal();
    }
}

TEST_F(Recovery, KnowsWhatWasSavedInBetween) {
    const std::vector<uint64_t> hashes = work_and_be_killed(2);
    auto session = open();
    EXPECT_EQ(session->document().hash(), hashes[3]);
    EXPECT_EQ(session->recoverable_count(), 3u);
    ASSERT_TRUE(session->recover());
    EXPECT_EQ(session->document().hash(), hashes[6]);
}

// Killed while it saved: some files are the new ones, the journal is still there.
TEST_F(Recovery, FindsTheFilesThatTheWorkWasOf) {
    const std::vector<uint64_t> hashes = work_and_be_killed(1);
    const std::string journal = read("scene.eco.json.journal");
    const std::string old_text = read("scene.eco.json"), old_plants = read("scene.plants");
    {
        auto session = open();
        ASSERT_TRUE(session->recover());
        ASSERT_TRUE(session->save());
        EXPECT_EQ(session->document().hash(), hashes[6]);
    }
    const std::string new_text = read("scene.eco.json"), new_plants = read("scene.plants");
    EXPECT_EQ(read("scene.plants.bak"), old_plants);
    for (const bool text_is_new : {false, true}) {
        ASSERT_TRUE(write_text_file(path, text_is_new ? new_text : old_text));
        ASSERT_TRUE(write_text_file(path + ".bak", old_text));
        ASSERT_TRUE(write_text_file(folder + "/scene.plants", new_plants));
        ASSERT_TRUE(write_text_file(folder + "/scene.plants.bak", old_plants));
        ASSERT_TRUE(write_text_file(path + ".journal", journal));
        auto session = open();
        auto recovered = session->recover();
        ASSERT_TRUE(recovered) << to_string(recovered.error());
        EXPECT_EQ(*recovered, 4u);
        EXPECT_EQ(session->document().hash(), hashes[6]);
        session->drop_journal();
    }
}

TEST_F(Recovery, LeavesAloneWhatAnotherProgramChanged) {
    work_and_be_killed();
    ASSERT_TRUE(write_text_file(path, R"({"plants": {}, "placements": [], "name": "another"})"));
    auto session = open();
    EXPECT_EQ(session->recoverable_count(), 6u);
    auto recovered = session->recover();
    ASSERT_FALSE(recovered);
    EXPECT_EQ(recovered.error().id, ErrorId::file_corrupt);
    EXPECT_TRUE(std::filesystem::exists(path + ".journal.old"));
    EXPECT_FALSE(std::filesystem::exists(path + ".journal"));
    perform(*session, "add_population", R"({"name": "oak", "source": "oak.json"})");
}

// One step of another scene in the middle: what stands before it is done again, and all of them are kept.
TEST_F(Recovery, KeepsStepsThatDoNotFit) {
    const std::vector<uint64_t> hashes = work_and_be_killed();
    const std::string journal_file = path + ".journal";
    auto content = Journal::read(journal_file);
    ASSERT_TRUE(content);
    std::vector<std::string> edits = content->edits;
    edits.erase(edits.begin() + 2);  // which the next one builds on
    for (const char* old : {".old", ".old.2"}) {
        ASSERT_TRUE(Journal::create(journal_file, content->base, edits));
        const std::string all = read("scene.eco.json.journal");
        auto session = open();
        ASSERT_EQ(session->recoverable_count(), 5u);
        auto recovered = session->recover();
        ASSERT_TRUE(recovered);
        EXPECT_EQ(*recovered, 2u);
        EXPECT_EQ(session->document().hash(), hashes[2]);
        EXPECT_EQ(read(std::string("scene.eco.json.journal") + old), all);
        EXPECT_EQ(Journal::read(journal_file)->edits.size(), 2u);
        perform(*session, "place", R"({"population": "birch", "at": [1, 1]})");
        EXPECT_EQ(Journal::read(journal_file)->edits.size(), 3u);
        session->drop_journal();
    }
}

// Where nothing more can be written no step is lost: the old journal stays until one with everything has room.
TEST_F(Recovery, LosesNothingOnAFullDisk) {
    const std::vector<uint64_t> hashes = work_and_be_killed();
    const std::string journal_file = path + ".journal";
    auto content = Journal::read(journal_file);
    ASSERT_TRUE(content);
    std::vector<std::string> edits = content->edits;
    edits.push_back("no edit");
    ASSERT_TRUE(Journal::create(journal_file, content->base, edits));
    const std::string before = read("scene.eco.json.journal");
    auto session = open();
    rlimit unlimited{};
    ::getrlimit(RLIMIT_FSIZE, &unlimited);
    const auto ignored = ::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{16, unlimited.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    auto recovered = session->recover();
    ::setrlimit(RLIMIT_FSIZE, &unlimited);
    ::signal(SIGXFSZ, ignored);
    ASSERT_TRUE(recovered);
    EXPECT_EQ(*recovered, 6u);
    EXPECT_FALSE(session->take_warnings().empty());
    EXPECT_EQ(read("scene.eco.json.journal"), before);
    EXPECT_FALSE(std::filesystem::exists(journal_file + ".new"));
    perform(*session, "place", R"({"population": "oak", "at": [3, 3]})");
    EXPECT_EQ(Journal::read(journal_file)->edits.size(), 7u);
    const uint64_t hash = session->document().hash();
    session.reset();
    session = open();
    ASSERT_TRUE(session->recover());
    EXPECT_EQ(session->document().hash(), hash);
}

// A journal that somebody else wrote has no say over files that are none of the scene's.
TEST_F(Recovery, MovesNoFileThatAJournalOnlyNames) {
    const std::string bystander = folder + "/diary.txt";
    ASSERT_TRUE(write_text_file(bystander, "mine"));
    ASSERT_TRUE(Journal::create(path + ".journal", {{bystander, k_no_file}}));
    {
        auto session = Session::open(path, {&k_test_terrain});
        ASSERT_TRUE(session);
        const auto recovered = (*session)->recover();
        ASSERT_FALSE(recovered);
        EXPECT_EQ(recovered.error().id, ErrorId::file_corrupt);
    }
    EXPECT_EQ(read("diary.txt"), "mine");
}

TEST_F(Recovery, MayBeDeclined) {
    const std::vector<uint64_t> hashes = work_and_be_killed();
    auto session = open();
    ASSERT_TRUE(session->discard_recovery());
    EXPECT_EQ(session->document().hash(), hashes.front());
    EXPECT_FALSE(std::filesystem::exists(path + ".journal"));
    perform(*session, "place", R"({"population": "oak", "at": [0, 0]})");
}

TEST_F(Recovery, WorksForASceneThatWasNeverSaved) {
    std::filesystem::remove(path);
    const pid_t child = ::fork();
    if (child == 0) {
        auto session = Session::open(path, {});
        auto edit = (*session)->perform("add_population", {{"name", "oak"}, {"source", "oak.json"}});
        auto placed = (*session)->perform("place", {{"population", "oak"}, {"at", {1, 2}}});
        ::kill(::getpid(), edit && placed ? SIGKILL : SIGTERM);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    EXPECT_FALSE(std::filesystem::exists(path));
    auto session = open();
    ASSERT_TRUE(session);
    auto recovered = session->recover();
    ASSERT_TRUE(recovered) << to_string(recovered.error());
    EXPECT_EQ(*recovered, 2u);
    EXPECT_EQ(count(*session, "oak"), 1u);
}

}  // namespace
}  // namespace coppice
