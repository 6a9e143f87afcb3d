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

constexpr const char* k_species[] = {"birch", "fern", "daisy", "grass", "shrub"};
constexpr const char* k_window_scene = R"({
  "plants": {
    "birch": {"source": "birch.plant", "height_m": 10},
    "fern": {"source": "fern.plant"},
    "daisy": {"source": "daisy.plant"},
    "grass": {"source": "grass.plant"},
    "shrub": {"source": "shrub.plant"}
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
        if (!species) GTEST_SKIP() << "COPPICE_COOKED_SPECIES names no folder of cooked plants: run it by ctest";
        if (!std::getenv("DISPLAY")) GTEST_SKIP() << "there is no display: run it by ctest, in Xvfb";
        if (!xdotool("version")) GTEST_SKIP() << "xdotool is not installed";
        for (const char* name : k_species)
            std::filesystem::create_symlink(fmt::format("{}/{}.plant", species, name),
                                            fmt::format("{}/{}.plant", folder, name));
        ASSERT_TRUE(write_text_file(path, k_window_scene));
    }

    void TearDown() override {
        kill();
        Workplace::TearDown();
    }

    // Whether its window came. plant: in place of the scene.
    bool start(const std::string& plant = "") {
        const std::string opened = plant.empty() ? path : plant;
        const std::string title = plant.empty() ? "scene.eco.json.* Coppice" : ".* - Coppice";
        const std::string said = folder + "/said.txt";
        editor_ = ::fork();
        if (editor_ == 0) {
            ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
            if (!std::freopen(said.c_str(), "a", stderr)) ::_exit(125);
            const bool wide = opened != path;
            ::execl(COPPICE_EDITOR, COPPICE_EDITOR, opened.c_str(), "--width", wide ? "1200" : "800", "--height",
                    wide ? "760" : "600", "--scale", "1", "--validation", nullptr);
            ::_exit(126);
        }
        const std::string window = "search --name '" + title + "' ";
        if (!wait_until([&] { return xdotool(window); })) return false;
        return xdotool(window + "windowfocus windowmove 0 0 sleep 0.3 mousemove 400 400");
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

    size_t journalled() const { return journalled(path); }
    static size_t journalled(const std::string& scene) {
        auto journal = Journal::read(journal_path(scene));
        return journal ? journal->edits.size() : 0;
    }
    // What xdotool does, and then a step more in the journal than before.
    bool step(const std::string& keys_and_mouse) {
        const size_t before = journalled();
        return xdotool(keys_and_mouse) && wait_until([&] { return journalled() > before; });
    }
    // Presses the button and moves on, `down` pixels further down than the middle of the view.
    bool stroke(const char* modifier = "", int down = 0) {
        const std::string hold = *modifier ? fmt::format("keydown {} ", modifier) : "",
                          let_go = *modifier ? fmt::format(" keyup {}", modifier) : "";
        return step(fmt::format("{}mousemove 330 {} sleep 0.1 mousedown 1 mousemove 400 {} mousemove 470 {} mouseup 1{}", hold,
                                330 + down, 340 + down, 350 + down, let_go));
    }
    // Its plants, as they are saved or in the journal.
    std::map<std::string, size_t> counts() {
        std::map<std::string, size_t> of_kind;
        const auto session = open(false);
        if (session && session->recoverable_count() > 0) EXPECT_TRUE(session->recover());
        for (const char* kind : k_species) of_kind[kind] = session ? count(*session, kind) : 0;
        return of_kind;
    }
    bool quit() {
        std::optional<int> code;
        return xdotool("key ctrl+q") && wait_until([&] { return (code = ended()).has_value(); }) && code == 0;
    }

    pid_t editor_ = 0;
};

// Five species, with every tool; saved, opened again, and flown through.
TEST_F(EditorInAWindow, LaysOutAndSavesASceneByMouseAndKeys) {
    ASSERT_TRUE(start()) << read("said.txt");
    for (int kind = 1; kind <= 5; ++kind) {
        ASSERT_TRUE(xdotool(fmt::format("key {}", kind)));
        ASSERT_TRUE(stroke("", 25 * kind)) << read("said.txt");
    }
    ASSERT_TRUE(stroke("ctrl", 125));  // the shrubs go again, and come back
    ASSERT_TRUE(step("key ctrl+z"));
    ASSERT_TRUE(step("key ctrl+y"));
    ASSERT_TRUE(step("key ctrl+z"));
    ASSERT_TRUE(stroke("shift", 175));  // whatever stands there
    ASSERT_TRUE(step("key ctrl+z"));
    // A larger and denser brush.
    ASSERT_TRUE(xdotool("key 3 key bracketright key bracketright key shift+bracketright key shift+bracketright"));
    ASSERT_TRUE(stroke("", 75));
    // A polygon of daisies, and one fern by itself, which is moved.
    ASSERT_TRUE(xdotool("key p sleep 0.2 mousemove 350 440 click 1 sleep 0.2 mousemove 460 445 click 1 sleep 0.2 "
                        "mousemove 400 500 click 1 sleep 0.2"));
    ASSERT_TRUE(step("key Return"));
    ASSERT_TRUE(step("key 2 key t sleep 0.2 mousemove 350 530 click 1"));
    ASSERT_TRUE(step("key v sleep 0.2 mousemove 350 530 click 1 sleep 0.3 mousedown 1 sleep 0.1 mousemove 370 520 sleep 0.1 "
                     "mousemove 390 510 sleep 0.1 mouseup 1"));
    ASSERT_TRUE(xdotool("key ctrl+s"));
    ASSERT_TRUE(wait_until([&] { return !std::filesystem::exists(journal_path(path)); }));
    ASSERT_TRUE(quit()) << read("said.txt");
    EXPECT_EQ(read("said.txt").find("validation ["), std::string::npos) << read("said.txt");

    std::map<std::string, size_t> saved = counts();
    for (const char* kind : k_species) EXPECT_GT(saved[kind], 0u) << kind;
    // Crowns touch at first: so many more of the small ones.
    EXPECT_GT(saved["daisy"], 4 * saved["birch"]);

    // Opened again it goes on from there.
    ASSERT_TRUE(start()) << read("said.txt");
    ASSERT_TRUE(xdotool("key 4"));
    ASSERT_TRUE(stroke("", 160)) << read("said.txt");
    ASSERT_TRUE(xdotool("key ctrl+s"));
    ASSERT_TRUE(wait_until([&] { return !std::filesystem::exists(journal_path(path)); }));
    ASSERT_TRUE(quit());
    std::map<std::string, size_t> again = counts();
    EXPECT_GT(again["grass"], saved["grass"]);
    saved["grass"] = again["grass"];
    EXPECT_EQ(again, saved);
    ASSERT_EQ(std::system(fmt::format("{} play {} --headless 160x100 --frames 3 --out {}/flown >{}/flown.txt 2>&1", COPPICE_PROGRAM,
                                      path, folder, folder)
                              .c_str()),
              0)
        << read("flown.txt");
    EXPECT_TRUE(std::filesystem::exists(folder + "/flown/summary.json"));
}

// The mark of a tile is dragged, and the tile comes after it.
TEST_F(EditorInAWindow, MovesTilesByHand) {
    ASSERT_TRUE(write_text_file(folder + "/tile.eco.json", k_window_scene));
    ASSERT_TRUE(write_text_file(path, R"({"plants": {}, "placements": [], "references": [{"scene": "tile.eco.json", "at": [0, 0]}]})"));
    ASSERT_TRUE(start()) << read("said.txt");
    // A new scene is looked at about its origin, which lies in the middle of the view.
    ASSERT_TRUE(step("key v sleep 0.3 mousemove 400 306 mousedown 1 sleep 0.1 mousemove 420 350 sleep 0.1 mousemove 440 400 sleep 0.1 "
                     "mouseup 1"))
        << read("said.txt");
    ASSERT_TRUE(xdotool("key ctrl+s"));
    ASSERT_TRUE(wait_until([&] { return !std::filesystem::exists(journal_path(path)); }));
    ASSERT_TRUE(quit()) << read("said.txt");
    const auto session = open(false);
    ASSERT_TRUE(session);
    const auto at = session->document().root().text->json["references"][0]["at"];
    EXPECT_GT(at[0].get<double>(), 1.0);   // to the right
    EXPECT_GT(at[1].get<double>(), 10.0);  // and nearer
    EXPECT_LT(at[1].get<double>(), 40.0);
}

// A plant by itself: a part's kind by the mouse, saved beside the plant.
TEST_F(EditorInAWindow, SetsWhatAPlantsPartsTurnInto) {
    if (!std::filesystem::exists("/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"))
        GTEST_SKIP() << "fonts-dejavu-core is not installed: rows are of another height";
    const std::string plant = folder + "/daisy.json";
    std::filesystem::copy_file(std::string(COPPICE_CONTENT_DIR) + "/species/daisy.json", plant);
    ASSERT_TRUE(start(plant)) << read("said.txt");
    const auto is_cooked = [&] {
        std::error_code ignored;
        for (const auto& entry : std::filesystem::directory_iterator(folder + "/coppice/plants", ignored))
            if (entry.path().filename().string().starts_with("daisy-")) return true;
        return false;
    };
    ASSERT_TRUE(wait_until(is_cooked)) << read("said.txt");
    // The first part's kind, and the third entry of its list.
    ASSERT_TRUE(xdotool("sleep 1 mousemove 150 160 click 1 sleep 0.7 mousemove 150 225 sleep 0.2 click 1"));
    const std::string scene = plant + ".eco.json";
    ASSERT_TRUE(wait_until([&] { return journalled(scene) == 1; })) << read("said.txt");
    ASSERT_TRUE(xdotool("key ctrl+z"));
    ASSERT_TRUE(wait_until([&] { return journalled(scene) == 2; }));
    ASSERT_TRUE(xdotool("key ctrl+y"));
    ASSERT_TRUE(wait_until([&] { return journalled(scene) == 3; }));
    ASSERT_TRUE(xdotool("key ctrl+s"));
    ASSERT_TRUE(wait_until([&] { return std::filesystem::exists(plant + ".lod.json"); }));
    EXPECT_NE(read("daisy.json.lod.json").find("\"kind\""), std::string::npos) << read("daisy.json.lod.json");
    ASSERT_TRUE(quit()) << read("said.txt");
    EXPECT_EQ(read("said.txt").find("validation ["), std::string::npos) << read("said.txt");
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
