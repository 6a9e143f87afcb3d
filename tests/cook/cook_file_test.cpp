#include "plugins/vegetation/cook/cook_file.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <filesystem>
#include "plugins/vegetation/cook/inspect.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/file.h"
#include "runtime/core/log.h"
#include "tests/cook/shapes.h"

namespace coppice {
namespace {

int g_grown = 0;

// A modeller whose plants have as many leaves as the species' text has characters.
Result<PlantDescription> grow_leaves(std::string_view json, const std::string& file, uint64_t variation) {
    ++g_grown;
    if (json.empty()) return fail(ErrorId::syntax, file, "line 1", "empty", "write a species");
    PlantDescription plant;
    plant.name = "leaves";
    plant.parts.push_back(shapes::leaf_cloud(uint32_t(json.size()), 1, 0.1f, variation));
    return plant;
}
constexpr ModellerInterface k_modeller{sizeof(ModellerInterface), &grow_leaves};

class CookFile : public testing::Test {
  protected:
    CookFile()
        : dir_(std::filesystem::temp_directory_path() / ("coppice_cook_file_" + std::to_string(::getpid()))) {
        std::filesystem::remove_all(dir_);
        std::filesystem::create_directories(dir_);
    }
    ~CookFile() override { std::filesystem::remove_all(dir_); }
    std::string write(const std::string& name, std::string_view text) {
        std::string path = (dir_ / name).string();
        EXPECT_TRUE(write_text_file(path, text));
        return path;
    }
    std::string cache_dir() const { return (dir_ / "cache").string(); }
    Result<Plant> find(const std::string& source, uint64_t variation = 0, const CookSettings& settings = {}) {
        const PlantSource one{source, variation};
        COPPICE_TRY(std::vector<Plant> plants,
                    find_or_cook(cache_dir(), std::span(&one, 1), settings, &k_modeller, nullptr));
        return std::move(plants.at(0));
    }
    // One triangle, its buffer in a file of its own.
    std::string write_triangle(float height_m) {
        const float positions[] = {0, 0, 0, 1, 0, 0, 0, height_m, 0};
        EXPECT_TRUE(write_file((dir_ / "triangle.bin").string(), std::as_bytes(std::span(positions))));
        return write("triangle.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "buffers": [{"uri": "triangle.bin", "byteLength": 36}],
            "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [0, 0, 0], "max": [1, 9, 0]}]})");
    }
    std::filesystem::path dir_;
};

TEST_F(CookFile, CooksASpeciesThroughTheModeller) {
    std::string source = write("a.json", "12345"), out = (dir_ / "a.plant").string();
    auto cooked = cook_file(source, out, 7, {}, &k_modeller, nullptr);
    ASSERT_TRUE(cooked) << to_string(cooked.error());
    auto plant = load_plant(out);
    ASSERT_TRUE(plant);
    EXPECT_EQ(plant->name, "leaves");
    EXPECT_EQ(plant->triangle_vertices.size(), 5u * 6);
}

TEST_F(CookFile, CooksAGltfFile) {
    std::string out = (dir_ / "t.plant").string();
    auto cooked = cook_file(write_triangle(2), out, 0, {}, nullptr, nullptr);
    ASSERT_TRUE(cooked) << to_string(cooked.error());
    EXPECT_EQ(load_plant(out)->bounds_plant.size(), vec3(1, 2, 0));
}

TEST_F(CookFile, SaysWhatIsMissing) {
    std::string out = (dir_ / "out.plant").string();
    auto refused = [&](const std::string& source, const ModellerInterface* modeller) {
        auto cooked = cook_file(source, out, 0, {}, modeller, nullptr);
        EXPECT_FALSE(cooked) << source;
        EXPECT_FALSE(std::filesystem::exists(out)) << source;
        return cooked ? Error{} : cooked.error();
    };
    Error without_plugin = refused(write("a.json", "1"), nullptr);
    EXPECT_EQ(without_plugin.id, ErrorId::name_unknown);
    EXPECT_NE(without_plugin.fault.find("modeller"), std::string::npos);
    EXPECT_EQ(refused(write("empty.json", ""), &k_modeller).id, ErrorId::syntax);
    EXPECT_EQ(refused((dir_ / "none.json").string(), &k_modeller).id, ErrorId::file_missing);
    EXPECT_EQ(refused((dir_ / "none.glb").string(), &k_modeller).id, ErrorId::file_missing);
    EXPECT_EQ(refused(write("a.obj", "v 0 0 0"), &k_modeller).id, ErrorId::format_unknown);
    Error flat = refused(write_triangle(0), nullptr);
    EXPECT_EQ(flat.id, ErrorId::value_out_of_range);
    EXPECT_EQ(flat.file, (dir_ / "triangle.gltf").string());
}

TEST_F(CookFile, AFailedCookLeavesTheOldFile) {
    std::string out = write("old.plant", "what was there");
    EXPECT_FALSE(cook_file(write_triangle(0), out, 0, {}, nullptr, nullptr));
    EXPECT_EQ(*read_text_file(out), "what was there");
}

TEST_F(CookFile, TheCacheCooksOnce) {
    std::string source = write("a.json", "12345");
    g_grown = 0;
    auto first = find(source), second = find(source);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->content_hash, second->content_hash);
    EXPECT_EQ(g_grown, 1);
    EXPECT_TRUE(load_plant(*cooked_path(cache_dir(), {source, 0}, {})));
}

TEST_F(CookFile, TheCacheFollowsSourceVariationSettingsAndReferences) {
    auto path_of = [this](const std::string& source, uint64_t variation = 0,
                          const CookSettings& settings = {}) {
        return *cooked_path(cache_dir(), {source, variation}, settings);
    };
    std::string source = write("a.json", "12345");
    std::string before = path_of(source);
    EXPECT_EQ(path_of(source), before);
    EXPECT_NE(path_of(source, 1), before);
    CookSettings shuffled;
    shuffled.order = PrefixOrder::shuffled;
    EXPECT_NE(path_of(source, 0, shuffled), before);
    EXPECT_EQ(find(source)->triangle_vertices.size(), 5u * 6);
    write("a.json", "1234567");
    EXPECT_NE(path_of(source), before);
    EXPECT_EQ(find(source)->triangle_vertices.size(), 7u * 6);

    std::string triangle = write_triangle(2), of_two = path_of(triangle);
    EXPECT_NEAR(find(triangle)->bounds_plant.size().y, 2.0f, 0.2f);
    write_triangle(3);  // the same .gltf, another .bin
    EXPECT_NE(path_of(triangle), of_two);
    EXPECT_NEAR(find(triangle)->bounds_plant.size().y, 3.0f, 0.2f);
}

// The lines logged while it lives.
class Log {
  public:
    Log() {
        set_log_sink([](void* log, LogLevel level,
                        std::string_view line) { static_cast<Log*>(log)->lines.emplace_back(level, line); },
                     this);
    }
    ~Log() { set_log_sink(nullptr, nullptr); }
    std::vector<std::pair<LogLevel, std::string>> lines;
};

TEST_F(CookFile, TheCacheReplacesWhatIsBrokenAndNotesIt) {
    std::string source = write("a.json", "12345"), path = *cooked_path(cache_dir(), {source, 0}, {});
    ASSERT_TRUE(find(source));
    std::filesystem::resize_file(path, 200);
    ASSERT_FALSE(load_plant(path));
    Log log;
    EXPECT_TRUE(find(source));
    EXPECT_TRUE(load_plant(path));
    ASSERT_EQ(log.lines.size(), 1u);
    EXPECT_EQ(log.lines[0].first, LogLevel::note);
    EXPECT_NE(log.lines[0].second.find(path), std::string::npos) << log.lines[0].second;
}

TEST_F(CookFile, WithoutAWritableCachePlantsStayInMemoryAfterOneWarning) {
    const std::vector<PlantSource> sources{{write("a.json", "12345"), 0}, {write("b.json", "123"), 0}};
    auto cached = find_or_cook(cache_dir(), sources, {}, &k_modeller, nullptr);
    write("file", "in the way");
    Log log;
    auto kept = find_or_cook((dir_ / "file").string(), sources, {}, &k_modeller, nullptr);
    ASSERT_TRUE(cached && kept);
    ASSERT_EQ(kept->size(), 2u);
    for (size_t i = 0; i < 2; ++i) EXPECT_EQ((*kept)[i].content_hash, (*cached)[i].content_hash);
    ASSERT_EQ(log.lines.size(), 1u);
    EXPECT_EQ(log.lines[0].first, LogLevel::warning);
}

TEST_F(CookFile, APackedPlantIsLoadedAsItIs) {
    std::string source = write("a.json", "12345"), packed = (dir_ / "a.plant").string();
    ASSERT_TRUE(cook_file(source, packed, 3, {}, &k_modeller, nullptr));
    auto plant = find(packed);
    ASSERT_TRUE(plant) << to_string(plant.error());
    EXPECT_EQ(plant->content_hash, load_plant(packed)->content_hash);
    EXPECT_FALSE(std::filesystem::exists(cache_dir()));
    EXPECT_EQ(find((dir_ / "none.plant").string()).error().id, ErrorId::file_missing);
}

TEST_F(CookFile, InspectShowsWhatIsInside) {
    auto plant = find(write("a.json", "12345"));
    ASSERT_TRUE(plant);
    std::string table = inspect_plant(*plant), json = inspect_plant_json(*plant);
    for (const char* word : {"leaves", "leaf", "points", "10", "20"})
        EXPECT_NE(table.find(word), std::string::npos) << word;
    EXPECT_NE(json.find("\"triangles\": 10"), std::string::npos);
    EXPECT_NE(json.find("\"area_m2\""), std::string::npos);
}

// What is set of a plant's parts stands beside it, and what was cooked without it is not what is found.
TEST_F(CookFile, SettingsBesideThePlantAreCookedWithIt) {
    const std::string source = write("a.json", "12345");
    const auto importance = [&] {
        auto plant = find(source);
        EXPECT_TRUE(plant) << to_string(plant.error());
        return plant ? plant->parts[0].importance : 0.0f;
    };
    EXPECT_FLOAT_EQ(importance(), 1.0f);
    const std::string path = *cooked_path(cache_dir(), {source, 0}, {});
    write("a.json.lod.json", R"({"parts": {"leaf": {"importance": 2}}})");
    EXPECT_FLOAT_EQ(importance(), 2.0f);
    EXPECT_NE(*cooked_path(cache_dir(), {source, 0}, {}), path);
    // Of what is being edited, in place of that.
    const PlantSource edited{source, 0, std::vector<PartSettings>{{"leaf", PartKind::automatic, 3.0f}}};
    auto plants = find_or_cook(cache_dir(), std::span(&edited, 1), {}, &k_modeller, nullptr);
    ASSERT_TRUE(plants);
    EXPECT_FLOAT_EQ(plants->at(0).parts[0].importance, 3.0f);
    EXPECT_FLOAT_EQ(importance(), 2.0f);
    write("a.json.lod.json", R"({"parts": {"leaf": {"importance": "much"}}})");
    auto refused = find(source);
    ASSERT_FALSE(refused);
    EXPECT_NE(to_string(refused.error()).find("a.json.lod.json"), std::string::npos);
    std::filesystem::remove(dir_ / "a.json.lod.json");
    EXPECT_FLOAT_EQ(importance(), 1.0f);
}

}  // namespace
}  // namespace coppice
