// The levels of detail of one plant, cooked, measured and shown beside the window.
#include "editor/plant/plant_editor.h"

#include <chrono>
#include <thread>
#include "runtime/gpu/buffer.h"
#include "tests/editor/workplace.h"

namespace coppice {
namespace {

constexpr uint32_t k_width = 400, k_height = 240;

struct PlantEditors : Workplace {
    void SetUp() override {
        Workplace::SetUp();
        path = folder + "/daisy.json";
        std::filesystem::copy_file(std::string(COPPICE_CONTENT_DIR) + "/species/daisy.json", path);
        for (const char* plugin : {"modeller", "vegetation"}) ASSERT_TRUE(registry.load(plugin)) << plugin;
        gpu::DeviceSettings settings;
        settings.validation = true;
        auto made = gpu::Device::create(settings);
        ASSERT_TRUE(made) << to_string(made.error());
        device = std::move(*made);
        auto frames = gpu::CommandRing::create(*device, 2);
        ASSERT_TRUE(frames);
        ring = std::move(*frames);
    }
    Result<std::unique_ptr<PlantEditor>> open_plant(const Session& session, const std::string& population) {
        PlantWork::Settings work;
        work.cache_dir = folder + "/cache";
        work.modeller = registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
        return PlantEditor::open(registry, session, population, *device, work, k_width, k_height);
    }
    // Until nothing is cooked any more, or measured.
    static bool settle(PlantEditor& plant, const Session& session, bool measured = false) {
        const auto busy = [&] { return plant.work().is_cooking() || (measured && plant.work().is_measuring()); };
        plant.follow(session);
        for (int i = 0; i < 4800 && busy(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(25));
        plant.follow(session);
        return !busy();
    }
    // Pixels of the left and of the right half that are not as the sky around them.
    std::array<size_t, 2> draw(PlantEditor& plant) {
        std::vector<uint32_t> colors(size_t(k_width) * k_height);
        for (int tries = 0; tries < 3; ++tries) {  // lists that were too short grow
            auto frame = plant.stage().begin_frame(ring, plant.view, 0.0f, float(k_width));
            EXPECT_TRUE(frame);
            EXPECT_TRUE(ring.submit());
            EXPECT_TRUE(ring.wait(frame->serial));
        }
        EXPECT_TRUE(gpu::read_now(*device, plant.stage().vegetation().color(), 0,
                                  std::as_writable_bytes(std::span(colors))));
        std::array<size_t, 2> covered{};
        for (uint32_t y = 0; y < k_height; ++y)
            for (uint32_t x = 0; x < k_width; ++x) {
                const uint32_t color = colors[size_t(y) * k_width + x], sky = colors[size_t(y) * k_width];
                for (uint32_t shift : {0u, 8u, 16u})
                    if (std::abs(int(color >> shift & 255u) - int(sky >> shift & 255u)) > 24) {
                        ++covered[x >= k_width / 2];
                        break;
                    }
            }
        return covered;
    }

    Registry registry;
    std::unique_ptr<gpu::Device> device;
    gpu::CommandRing ring;
};

TEST_F(PlantEditors, ShowMeasureAndFollowWhatIsSet) {
    const auto session = open();
    auto opened = open_plant(*session, "daisy");
    ASSERT_TRUE(opened) << to_string(opened.error());
    PlantEditor& plant = **opened;
    ASSERT_TRUE(settle(plant, *session, true));
    ASSERT_TRUE(plant.plant()) << plant.fault();
    uint32_t petals = UINT32_MAX;
    for (uint32_t part = 0; part < plant.plant()->parts.size(); ++part)
        if (std::string(plant.plant()->parts[part].name) == "petals") petals = part;
    ASSERT_NE(petals, UINT32_MAX);

    // Fewer the smaller it is; both halves show as much.
    plant.view.height_px = 400.0f;
    const std::array<size_t, 2> near = draw(plant);
    const uint64_t near_vertices = vertices_of(plant.stage().drawn());
    plant.view.height_px = 40.0f;
    const std::array<size_t, 2> far = draw(plant);
    const uint64_t far_vertices = vertices_of(plant.stage().drawn());
    EXPECT_GT(near[0], 500u);
    EXPECT_NEAR(double(near[1]) / double(near[0]), 1.0, 0.05);
    EXPECT_EQ(far[0], near[0]) << "all triangles, whatever the level";
    EXPECT_NEAR(double(far[1]) / double(far[0]), 1.0, 0.35) << "one view of squares";
    EXPECT_LT(4 * far_vertices, near_vertices);
    const PartChoice choice = plant.choice_at(petals, 40.0f);
    EXPECT_GT(choice.points + choice.leaves, 0u);
    EXPECT_EQ(choice.triangles, 0u);

    const std::vector<LevelFigures> figures = plant.work().figures();
    ASSERT_GE(figures.size(), 4u);
    for (size_t i = 0; i < figures.size(); ++i) {
        EXPECT_EQ(figures[i].height_px, PlantWork::k_sizes_px[i]);
        EXPECT_LT(std::fabs(figures[i].coverage_error), 0.15);
        EXPECT_GT(figures[i].coverage_px, 0.0);
        if (i > 0) {
            EXPECT_GE(vertices_of(figures[i].drawn), vertices_of(figures[i - 1].drawn));
        }
    }

    // Tried at once, cooked in the background, undone.
    const float own = plant.plant()->parts[petals].importance;
    const PartChoice own_choice = plant.choice_at(petals, 12.0f);
    plant.try_importance(petals, 5.0f * own);
    EXPECT_GT(plant.choice_at(petals, 12.0f).points, 3 * own_choice.points);
    ASSERT_TRUE(session->perform(
        "set_part", {{"population", "daisy"}, {"part", "petals"}, {"kind", "points"}, {"importance", 5.0 * own}}));
    ASSERT_TRUE(settle(plant, *session));
    EXPECT_FLOAT_EQ(plant.plant()->parts[petals].importance, 5.0f * own);
    EXPECT_EQ(plant.settings_of("petals").kind, PartKind::points);
    session->undo();
    ASSERT_TRUE(settle(plant, *session));
    EXPECT_FLOAT_EQ(plant.plant()->parts[petals].importance, own);
    EXPECT_EQ(plant.settings_of("petals").kind, PartKind::automatic);
    EXPECT_EQ(device->validation_messages(), 0u);
}

TEST_F(PlantEditors, SayWhatCannotBeShown) {
    const auto session = open();
    EXPECT_EQ(open_plant(*session, "rose").error().id, ErrorId::name_unknown);
    ASSERT_TRUE(write_text_file(path, R"({"form": "flower", "head": {"petals": "many"}})"));
    auto broken = open_plant(*session, "daisy");
    ASSERT_TRUE(broken);
    ASSERT_TRUE(settle(**broken, *session));
    EXPECT_NE((*broken)->fault().find("daisy.json"), std::string::npos);
    EXPECT_FALSE((*broken)->plant());
    draw(**broken);  // nothing, and no harm
    path = folder + "/scene.eco.json";
    ASSERT_TRUE(write_text_file(path, R"({"plants": {"a": {"source": "a.plant"}}, "placements": []})"));
    const auto packed = open();
    EXPECT_EQ(open_plant(*packed, "a").error().id, ErrorId::value_out_of_range);
}

}  // namespace
}  // namespace coppice
