// A folder of a test's own with a small scene in it, and sessions on that.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <map>
#include <gtest/gtest.h>
#include "editor/session/session.h"
#include "plugins/terrain/load_terrain.h"
#include "runtime/core/file.h"

namespace coppice {

inline constexpr TerrainInterface k_test_terrain{sizeof(TerrainInterface), load_terrain};

// As an author may write it: with keys that nobody knows, and spaces as they come.
inline constexpr const char* k_workplace_scene = R"({
  "note_of_the_author": {"kept": [1,2,   3]},
  "plants": {
    "oak":   {"source": "oak.json", "variations": 3, "height_m": 14},
    "birch": {"source": "birch.json", "individuals": 20, "variations": 2},
    "fern":  {"source": "fern.glb"}
  },
  "regions": {"pond": {"circle": {"center": [20, 0], "radius_m": 8}}},
  "terrain": {"procedural": {"size_m": 512, "cell_m": 8, "seed": 3, "amplitude_m": 20, "wavelength_m": 90}},
  "placements": [
    {"scatter": {"plant": "oak", "count": 40, "region": {"rectangle": {"center": [-100, -100], "size_m": [80, 80]}}}}
  ]
})";

struct Workplace : testing::Test {
    void SetUp() override {
        std::string name = testing::TempDir() + "coppice_editor_XXXXXX";
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
        path = folder + "/scene.eco.json";
        ASSERT_TRUE(write_text_file(path, k_workplace_scene));
    }
    void TearDown() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder, ignored);
    }

    std::unique_ptr<Session> open(bool journal = true) {
        auto session = Session::open(path, {&k_test_terrain, journal});
        EXPECT_TRUE(session) << to_string(session.error());
        return session ? std::move(*session) : nullptr;
    }
    // Expected to do something; its name.
    static std::string perform(Session& session, const std::string& name, const char* arguments) {
        auto edit = session.perform(name, nlohmann::json::parse(arguments));
        EXPECT_TRUE(edit) << name << ": " << (edit ? "" : to_string(edit.error()));
        EXPECT_TRUE(!edit || *edit) << name << " changed nothing";
        return edit && *edit ? (*edit)->name : "";
    }
    static Error refuse(Session& session, const std::string& name, const char* arguments) {
        const uint64_t before = session.document().hash();
        auto edit = session.perform(name, nlohmann::json::parse(arguments));
        EXPECT_FALSE(edit) << name << " " << arguments;
        EXPECT_EQ(session.document().hash(), before);
        return edit ? Error{} : edit.error();
    }
    static size_t count(const Session& session, const std::string& kind = "") {
        size_t found = 0;
        for (const PlacedPlant& plant : session.document().root().plants.all())
            found += kind.empty() || session.document().kinds()[plant.kind] == kind;
        return found;
    }
    std::string read(const std::string& name) const {
        auto text = read_text_file(folder + "/" + name);
        EXPECT_TRUE(text) << name;
        return text.value_or("");
    }

    std::string folder, path;
};

// Every file as it would be saved.
inline std::map<std::string, std::string> all_bytes(const Document& document) {
    std::map<std::string, std::string> bytes;
    for (const auto& [path, file] : document.files()) {
        if (auto text = document.text_bytes(file)) bytes[path] = *text;
        if (auto plants = document.plants_bytes(file)) bytes[file.placed_path] = *plants;
    }
    return bytes;
}

}  // namespace coppice
