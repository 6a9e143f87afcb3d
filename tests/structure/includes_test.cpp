// What may include what. Folders are stages, and a stage includes only what stands before it.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <gtest/gtest.h>
#include "tests/structure/source_tree.h"

namespace {

// "runtime/gpu/device.h", 2 -> "runtime/gpu". Empty where there are fewer folders.
std::string folder_of(const std::string& path, int depth) {
    size_t end = 0;
    for (int i = 0; i < depth; ++i) {
        end = path.find('/', i == 0 ? 0 : end + 1);
        if (end == std::string::npos) return {};
    }
    return path.substr(0, end);
}

std::string describe(const Include& include) {
    return include.from + ":" + std::to_string(include.line) + " includes " + include.to;
}

// Fails for every include under `parent` that goes from a folder to one that is not among its allowed ones.
void expect_edges(const std::string& parent, int depth,
                  const std::map<std::string, std::set<std::string>>& allowed,
                  const std::set<std::string>& excepted_headers = {}) {
    size_t checked = 0;
    for (const Include& include : find_includes(parent)) {
        const std::string from = folder_of(include.from, depth), to = folder_of(include.to, depth);
        if (from.empty() || to.empty() || !include.to.starts_with(parent + "/") || from == to) continue;
        ++checked;
        if (excepted_headers.contains(include.to)) continue;
        auto edges = allowed.find(from.substr(parent.size() + 1));
        ASSERT_NE(edges, allowed.end())
            << "folder " << from << " has no place in the order: " << describe(include);
        EXPECT_TRUE(edges->second.contains(to.substr(parent.size() + 1))) << describe(include);
    }
    EXPECT_GT(checked, 0u) << "no include between the folders of " << parent
                           << " was found: is the test blind?";
}

}  // namespace

TEST(Includes, RuntimeLibrariesIncludeOnlyWhatStandsBelow) {
    expect_edges("runtime", 2,
                 {{"core", {}},
                  {"ecs", {"core"}},
                  {"gpu", {"core"}},
                  {"frame", {"core", "gpu"}},
                  {"plugin", {"core"}},
                  {"window", {"core", "gpu"}}});
}

TEST(Includes, RuntimeIncludesNothingAboveIt) {
    for (const Include& include : find_includes("runtime"))
        for (const char* above : {"plugins/", "tools/", "editor/", "tests/"})
            EXPECT_FALSE(include.to.starts_with(above)) << describe(include);
}

// Offline and online meet in the packed plant only, and the pictures' order is the order of the folders. The
// one exception is last frame's report, which what controls d' reads.
TEST(Includes, StagesOfVegetationIncludeOnlyWhatStandsBefore) {
    expect_edges("plugins/vegetation", 3,
                 {{"plant", {}},
                  {"cook", {"plant"}},
                  {"eco", {"plant"}},
                  {"query", {"plant", "eco"}},
                  {"cull", {"plant", "eco"}},
                  {"lod", {"plant", "eco", "cull"}},
                  {"shadow", {"plant", "eco", "cull", "lod"}},
                  {"draw", {"plant", "eco", "cull", "lod", "shadow"}},
                  {"report", {"plant", "eco", "cull", "lod", "shadow", "draw"}}},
                 {"plugins/vegetation/report/report.h"});
}

TEST(Includes, OnlyTheBudgetReadsTheReportBackwards) {
    for (const Include& include : find_includes("plugins/vegetation")) {
        if (include.to != "plugins/vegetation/report/report.h") continue;
        const std::string stage = folder_of(include.from, 3);
        EXPECT_TRUE(stage.empty() || stage == "plugins/vegetation/report" ||
                    include.from.starts_with("plugins/vegetation/lod/budget"))
            << describe(include);
    }
}

TEST(Includes, DrawingNeverIncludesTheCook) {
    for (const char* folder :
         {"plugins/vegetation/draw", "plugins/vegetation/cull", "plugins/vegetation/lod",
          "plugins/vegetation/eco", "plugins/vegetation/plant", "plugins/vegetation/shadow"})
        for (const Include& include : find_includes(folder))
            EXPECT_FALSE(include.to.starts_with("plugins/vegetation/cook")) << describe(include);
}

TEST(Includes, PluginsIncludeNoTool) {
    for (const Include& include : find_includes("plugins"))
        for (const char* above : {"tools/", "editor/", "tests/"})
            EXPECT_FALSE(include.to.starts_with(above)) << describe(include);
}

// What a scene says, what changes it, who keeps that, and who shows it: only the last two know a device or a window.
TEST(Includes, StagesOfTheEditorIncludeOnlyWhatStandsBefore) {
    expect_edges("editor", 2,
                 {{"document", {}},
                  {"commands", {"document"}},
                  {"session", {"document", "commands"}},
                  {"view", {"document", "commands", "session"}},
                  {"plant", {"document", "commands", "session", "view"}},
                  {"window", {"document", "commands", "session", "view", "plant"}}});
    for (const char* folder : {"editor/document", "editor/commands", "editor/session"})
        for (const Include& include : find_includes(folder))
            for (const char* above : {"runtime/gpu/", "runtime/frame/", "runtime/window/", "plugins/vegetation/draw/",
                                      "plugins/vegetation/vegetation.h", "tools/"})
                EXPECT_FALSE(include.to.starts_with(above)) << describe(include);
}

// Of another plugin, its interface and the descriptions it hands over, nothing else.
TEST(Includes, PluginsKnowEachOtherByTheirInterfaces) {
    const std::set<std::string> shared{"plugins/modeller/modeller.h",
                                       "plugins/terrain/terrain.h",
                                       "plugins/images/images.h",
                                       "plugins/vegetation/vegetation.h",
                                       "plugins/vegetation/plant/description.h",
                                       "plugins/vegetation/plant/plant.h",
                                       "plugins/vegetation/plant/surface.h"};
    for (const Include& include : find_includes("plugins")) {
        const std::string from = folder_of(include.from, 2), to = folder_of(include.to, 2);
        if (!include.to.starts_with("plugins/") || from == to) continue;
        // A static library that every plugin may use, and that knows none.
        EXPECT_NE(from, "plugins/shared") << describe(include);
        EXPECT_TRUE(to == "plugins/shared" || shared.contains(include.to)) << describe(include);
    }
}

TEST(Includes, OnlyTheWindowKnowsTheWindowSystem) {
    for (const char* folder : {"runtime", "plugins", "tools", "editor"})
        for (const Include& include : find_includes(folder))
            EXPECT_TRUE(!include.to.starts_with("GLFW/") || include.from.starts_with("runtime/window/") ||
                        include.from.starts_with("editor/window/"))
                << describe(include);
    for (const char* folder : {"runtime", "plugins", "tools"})
        for (const SourceFile& file : read_sources(folder)) {
            if (!file.path.ends_with("CMakeLists.txt")) continue;
            if (file.path == "runtime/window/CMakeLists.txt") continue;
            EXPECT_EQ(file.text.find("glfw"), std::string::npos) << file.path << " links the window system";
        }
}
