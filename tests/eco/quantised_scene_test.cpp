// Scenes whose populations have more individuals than models: what is grown, which models there are, and how plants of
// the others come to be drawn.
#include <algorithm>
#include <atomic>
#include <set>
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

constexpr uint32_t k_individuals = 12, k_forms = 3;
std::atomic<int> g_grown = 0;

float height_m(uint64_t individual) { return 10.0f + 0.25f * float(individual); }

// Individual i has form i % 3: one leaf, upright, a half, one or two times as wide as it is tall.
Result<PlantDescription> grow_form(std::string_view, const std::string&, uint64_t individual) {
    ++g_grown;
    PlantDescription plant;
    PartDescription& leaf = plant.parts.emplace_back();
    leaf.leaf = true;
    const float height = height_m(individual), width = height * float(1 << individual % k_forms) / 2.0f;
    for (vec3 at : {vec3(0), vec3(width, 0, 0), vec3(0, height, 0)})
        leaf.vertices.push_back({at, vec3(0, 0, 1), vec3(0.5f)});
    leaf.indices = {0, 1, 2};
    return plant;
}
constexpr ModellerInterface k_modeller{sizeof(ModellerInterface), &grow_form};

Result<Scene> load(const std::string& plants, const std::string& placements,
                   const ModellerInterface* modeller = &k_modeller) {
    ScratchFile species("tree.json", "{}"), model("tree.glb", "");
    ScratchFile file("scene.eco.json",
                     "{\"plants\": {" + plants + "}, \"placements\": [" + placements + "]}");
    return load_scene(file.path(), {nullptr, modeller});
}

const std::string k_population =
    R"("tree": {"source": "tree.json", "individuals": 12, "variations": 3, "height_m": 10})";
const std::string k_scatter =
    R"({"scatter": {"plant": "tree", "grid": {"spacing_m": 9, "columns": 30, "rows": 30}}})";

class QuantisedScene : public testing::Test {
  protected:
    QuantisedScene() {
        g_grown = 0;
        set_log_sink(
            [](void* lines, LogLevel, std::string_view line) {
                static_cast<std::vector<std::string>*>(lines)->emplace_back(line);
            },
            &notes_);
    }
    ~QuantisedScene() override { set_log_sink(nullptr, nullptr); }
    std::vector<std::string> notes_;
};

// Of all individuals, which one has this form and comes to this height? k_individuals: none.
uint64_t individual_of(const Scene& scene, size_t plant) {
    const uint64_t medoid = scene.models[scene.plant_models[plant].model].variation;
    const float drawn_m = scene.positions[plant].scale * height_m(medoid);
    uint64_t i = 0;
    while (i < k_individuals && (i % k_forms != medoid % k_forms || std::abs(height_m(i) - drawn_m) > 1e-4f))
        ++i;
    return i;
}

TEST_F(QuantisedScene, DrawsEachPlantAsTheModelOfItsForm) {
    auto scene = load(k_population, k_scatter);
    ASSERT_TRUE(scene) << to_string(scene.error());
    EXPECT_EQ(g_grown, int(k_individuals));
    ASSERT_EQ(scene->models.size(), k_forms);
    std::set<uint64_t> forms;
    for (const SceneModel& model : scene->models) {
        EXPECT_LT(model.variation, k_individuals);
        forms.insert(model.variation % k_forms);
    }
    EXPECT_EQ(forms.size(), k_forms);

    ASSERT_EQ(scene->plant_models.size(), 900u);
    std::array<int, k_individuals + 1> drawn{};
    for (size_t plant = 0; plant < 900; ++plant) ++drawn[individual_of(*scene, plant)];
    EXPECT_EQ(drawn[k_individuals], 0) << "plants that are no individual";
    for (uint32_t i = 0; i < k_individuals; ++i) EXPECT_NEAR(drawn[i], 75, 40) << "individual " << i;
}

TEST_F(QuantisedScene, SaysSo) {
    ASSERT_TRUE(load(k_population, k_scatter));
    ASSERT_EQ(notes_.size(), 1u);
    for (const char* word : {"scene.eco.json", "tree", "12 individuals", "3 of them", "error 0.0"})
        EXPECT_NE(notes_[0].find(word), std::string::npos) << word << " in " << notes_[0];
}

TEST_F(QuantisedScene, APlacementMayNameItsIndividualAndItsScale) {
    for (uint32_t i = 0; i < k_individuals; ++i) {
        auto scene = load(k_population, R"({"plant": "tree", "at": [0, 0], "scale": 2, "variation": )" +
                                            std::to_string(i) + "}");
        ASSERT_TRUE(scene) << to_string(scene.error());
        scene->positions[0].scale /= 2.0f;
        EXPECT_EQ(individual_of(*scene, 0), i);
    }
    auto none = load(k_population, R"({"plant": "tree", "at": [0, 0], "variation": 12})");
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().id, ErrorId::value_out_of_range);
}

TEST_F(QuantisedScene, AnInventorysHeightsScaleTheIndividual) {
    ScratchFile csv("trees.csv", "x,y,species,height\n1,1,tree,10\n2,2,tree,10\n3,3,tree,10\n4,4,tree,10\n");
    auto scene = load(k_population, R"({"csv": "trees.csv"})");
    ASSERT_TRUE(scene) << to_string(scene.error());
    ASSERT_EQ(scene->positions.size(), 4u);
    for (size_t plant = 0; plant < 4; ++plant) EXPECT_LT(individual_of(*scene, plant), k_individuals);
}

TEST_F(QuantisedScene, AsManyModelsAsIndividualsNeedNotBeMeasured) {
    const std::string all = R"("tree": {"source": "tree.json", "individuals": 12, "variations": 12})";
    const std::string plain = R"("tree": {"source": "tree.json", "variations": 12})";
    auto scene = load(all, k_scatter, nullptr), same = load(plain, k_scatter, nullptr);
    ASSERT_TRUE(scene && same);
    EXPECT_EQ(g_grown, 0);
    EXPECT_TRUE(notes_.empty());
    ASSERT_EQ(scene->plant_models.size(), same->plant_models.size());
    for (size_t i = 0; i < scene->plant_models.size(); ++i) {
        EXPECT_EQ(scene->plant_models[i].model, same->plant_models[i].model);
        EXPECT_EQ(scene->positions[i].scale, 1.0f);
    }
}

TEST_F(QuantisedScene, SameOnAnyNumberOfThreads) {
    auto hash = [] {
        auto scene = load(k_population, k_scatter);
        EXPECT_TRUE(scene);
        uint64_t sum = 0;
        for (const SceneModel& model : scene->models) sum = hash_combine(sum, model.variation);
        return hash_bytes(
            scene->positions.data(), scene->positions.size() * sizeof(PlantPosition),
            hash_bytes(scene->plant_models.data(), scene->plant_models.size() * sizeof(PlantModel), sum));
    };
    set_thread_limit(1);
    const uint64_t one = hash();
    set_thread_limit(0);
    EXPECT_EQ(one, hash());
}

TEST_F(QuantisedScene, RefusesWhatCannotBeMeant) {
    auto error_of = [](const std::string& plant, const ModellerInterface* modeller = &k_modeller) {
        auto scene = load(R"("tree": )" + plant, "", modeller);
        EXPECT_FALSE(scene) << plant;
        return scene ? Error{} : scene.error();
    };
    const Error fewer = error_of(R"({"source": "tree.json", "individuals": 2, "variations": 3})");
    EXPECT_EQ(fewer.id, ErrorId::value_out_of_range);
    EXPECT_EQ(fewer.place, "plants.tree.individuals");
    const Error most = error_of(R"({"source": "tree.json", "individuals": 1025})");
    EXPECT_EQ(most.place, "plants.tree.individuals");
    const Error shape = error_of(R"({"source": "tree.glb", "individuals": 5})");
    EXPECT_EQ(shape.id, ErrorId::value_out_of_range);
    EXPECT_EQ(shape.place, "plants.tree.individuals");
    const Error plugin = error_of(R"({"source": "tree.json", "individuals": 5})", nullptr);
    EXPECT_EQ(plugin.id, ErrorId::name_unknown);
    EXPECT_NE(plugin.fault.find("modeller"), std::string::npos);
    EXPECT_EQ(error_of(R"({"source": "none.json", "individuals": 5})").id, ErrorId::file_missing);
}

}  // namespace
}  // namespace coppice
