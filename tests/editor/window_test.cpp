// The editor's program in a window, worked with by the display's own mouse and keys.
#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>
#include "editor/document/journal.h"
#include "tests/editor/workplace.h"

namespace coppice {
namespace {

using namespace std::chrono_literals;

constexpr const char* k_window_scene = R"({
  "plants": {
    "birch": {"source": "birch.plant", "height_m": 10},
    "fern": {"source": "fern.plant"},
    "daisy": {"source": "daisy.plant"}
  },
  "placements": []
})";

bool xdotool(const std::string& arguments) {
    return std::system(("xdotool " + arguments + " >/dev/null 2>&1").c_str()) == 0;
}

struct EditorInAWindow : Workplace {
    void SetUp() override {
        Workplace::SetUp();
        const char* species = std::getenv("COPPICE_COOKED_SPECIES");
        if (!species || !std::getenv("DISPLAY") || !xdotool("version"))
            GTEST_SKIP() << "no display, no xdotool, or no cooked species";
        for (const char* name : {"birch", "fern", "daisy"})
            std::filesystem::create_symlink(fmt::format("{}/{}.plant", species, name),
                                            fmt::format("{}/{}.plant", folder, name));
        ASSERT_TRUE(write_text_file(path, k_window_scene));
    }

    void TearDown() override {
        kill();
        Workplace::TearDown();
    }

    // Whether its window came.
    bool start() {
        const std::string said = folder + "/said.txt";
        editor_ = ::fork();
        if (editor_ == 0) {
            ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
            if (!std::freopen(said.c_str(), "a", stderr)) ::_exit(125);
            ::execl(COPPICE_EDITOR, COPPICE_EDITOR, path.c_str(), "--width", "800", "--height", "600",
                    "--validation", nullptr);
            ::_exit(126);
        }
        if (!wait_until([] { return xdotool("search --name 'scene.eco.json.* Coppice'"); })) return false;
        return xdotool("search --name 'scene.eco.json.* Coppice' windowfocus sleep 0.3 mousemove 400 400");
    }

    template <class Condition>
    static bool wait_until(Condition condition) {
        for (int i = 0; i < 200; ++i) {
            if (condition()) return true;
            std::this_thread::sleep_for(100ms);
        }
        return condition();
    }

    // Its exit code when it has come to its end; none while it runs.
    std::optional<int> ended() {
        int status = 0;
        if (editor_ <= 0 || ::waitpid(editor_, &status, WNOHANG) != editor_) return {};
        editor_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    void kill() {
        if (editor_ <= 0) return;
        ::kill(editor_, SIGKILL);
        ::waitpid(editor_, nullptr, 0);
        editor_ = 0;
    }

    size_t journalled() const {
        auto journal = Journal::read(journal_path(path));
        return journal ? journal->edits.size() : 0;
    }
    // Presses the button, goes there, and waits until the step is in the journal.
    bool stroke(const char* modifier = "") {
        const size_t before = journalled();
        const std::string hold = *modifier ? fmt::format("keydown {} ", modifier) : "",
                          let_go = *modifier ? fmt::format(" keyup {}", modifier) : "";
        if (!xdotool(hold +
                     "mousemove 330 330 sleep 0.1 mousedown 1 mousemove 400 340 mousemove 470 350 mouseup 1" +
                     let_go))
            return false;
        return wait_until([&] { return journalled() > before; });
    }

    pid_t editor_ = 0;
};

TEST_F(EditorInAWindow, LaysOutAndSavesASceneByMouseAndKeys) {
    ASSERT_TRUE(start()) << read("said.txt");
    ASSERT_TRUE(stroke()) << read("said.txt");
    ASSERT_TRUE(xdotool("key 2"));
    ASSERT_TRUE(stroke());
    ASSERT_TRUE(xdotool("key 3"));
    ASSERT_TRUE(stroke());
    ASSERT_TRUE(stroke("ctrl"));  // the daisies go again
    ASSERT_TRUE(xdotool("key ctrl+z"));
    ASSERT_TRUE(wait_until([&] { return journalled() == 5; }));
    ASSERT_TRUE(xdotool("key ctrl+s"));
    ASSERT_TRUE(wait_until([&] { return !std::filesystem::exists(journal_path(path)); }));
    ASSERT_TRUE(xdotool("key ctrl+q"));
    std::optional<int> code;
    ASSERT_TRUE(wait_until([&] { return (code = ended()).has_value(); }));
    EXPECT_EQ(code, 0) << read("said.txt");
    EXPECT_EQ(read("said.txt").find("validation ["), std::string::npos) << read("said.txt");

    const auto session = open();
    for (const char* kind : {"birch", "fern", "daisy"}) EXPECT_GT(count(*session, kind), 0u) << kind;
    // Crowns touch at first: so many more of the small ones.
    EXPECT_GT(count(*session, "daisy"), 4 * count(*session, "birch"));
}

TEST_F(EditorInAWindow, OutlivesAnySizeAndLosesNothingWhenKilled) {
    ASSERT_TRUE(start()) << read("said.txt");
    const std::string window = "search --name 'scene.eco.json.* Coppice' ";
    for (const char* size : {"1 1", "64 3", "900 700", "800 600"})
        ASSERT_TRUE(xdotool(window + "windowsize " + size + " sleep 0.4")) << size;
    // Without a window manager nothing can be minimised; then it is taken off the display.
    ASSERT_TRUE(xdotool(window + "windowminimize sleep 0.3 windowunmap sleep 0.3"));
    ASSERT_TRUE(xdotool(window + "windowmap sleep 0.5 windowfocus sleep 0.3"));
    ASSERT_FALSE(ended().has_value()) << read("said.txt");
    ASSERT_TRUE(stroke()) << read("said.txt");

    // With unsaved work it asks, and goes on.
    ASSERT_TRUE(xdotool("key ctrl+q sleep 0.7"));
    ASSERT_FALSE(ended().has_value());
    kill();
    EXPECT_EQ(read("said.txt").find("validation ["), std::string::npos) << read("said.txt");
    auto session = open();
    ASSERT_EQ(session->recoverable_count(), 1u);
    ASSERT_TRUE(session->recover());
    EXPECT_GT(count(*session, "birch"), 0u);
}

}  // namespace
}  // namespace coppice
