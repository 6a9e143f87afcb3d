// A forest in a host's frame: plants of the host's own come, move and go, what was drawn is explained, and what was changed
// on disk is loaded while it is drawn.
#include "plugins/vegetation/embedded_forest.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <unistd.h>
#include <gtest/gtest.h>
#include "runtime/core/file.h"
#include "runtime/core/file_source.h"
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"

namespace coppice {
namespace {

constexpr uint32_t k_width = 320, k_height = 200;

std::string scene_of(const char* plants, int birches) {
    return std::string(R"({"name": "a clearing", "plants": )") + plants +
           R"(, "placements": [{"scatter": {"plant": "birch", "count": )" + std::to_string(birches) +
           R"(, "region": {"rectangle": {"center": [0, -60], "size_m": [80, 30]}}, "scale": [0.9, 1.1], "seed": 1}}],
  "haze": {"density_per_m": 0}, "camera_path": [{"time_s": 0, "at": [0, 2, 0]}]})";
}
constexpr const char* k_plants = R"({"fern": {"source": "fern.json"}, "birch": {"source": "birch.json"}})";

struct EmbeddedForestTest : testing::Test {
    void SetUp() override {
        folder = testing::TempDir() + "embedded_forest_" + std::to_string(::getpid());
        std::filesystem::create_directories(folder);
        for (const char* species : {"fern.json", "birch.json"})
            std::filesystem::copy_file(std::string(COPPICE_CONTENT_DIR "/species/") + species,
                                       folder + "/" + species,
                                       std::filesystem::copy_options::overwrite_existing);
        write("clearing.eco.json", scene_of(k_plants, 20));
        auto made = gpu::Device::create({});
        ASSERT_TRUE(made) << to_string(made.error());
        device = std::move(*made);
        auto frames = gpu::CommandRing::create(*device, 2);
        ASSERT_TRUE(frames);
        ring = std::move(*frames);
        // The host keeps its queue.
        EmbeddedForestSettings settings;
        settings.device = {device->instance, device->physical, device->handle};
        settings.device.queue_family = device->queue_family;
        settings.scene = folder + "/clearing.eco.json";
        settings.cache_dir = testing::TempDir() + "embedded_forest_cache";
        settings.width = k_width;
        settings.height = k_height;
        settings.loose_tiles = 4;
        auto created = EmbeddedForest::create(settings);
        ASSERT_TRUE(created) << to_string(created.error());
        forest = std::move(*created);
    }
    void TearDown() override {
        if (device) device->wait_idle();
        std::filesystem::remove_all(folder);
    }
    void write(const std::string& name, const std::string& text) {
        ASSERT_TRUE(write_text_file(folder + "/" + name, text));
    }

    using Pixels = std::vector<uint8_t>;
    static FrameSettings without_shadows() {
        FrameSettings settings;
        settings.shadows = ShadowKind::none;
        return settings;
    }
    Pixels draw(const FrameSettings& settings = without_shadows()) {
        for (int tries = 0; tries < 3; ++tries) {  // lists that were too short grow
            auto frame = ring.begin();
            EXPECT_TRUE(frame);
            const Status recorded = forest->record({frame->commands, frame->slot, Camera{}, settings, {}});
            EXPECT_TRUE(recorded) << to_string(recorded.error());
            EXPECT_TRUE(ring.submit());
            EXPECT_TRUE(ring.wait(frame->serial));
        }
        Pixels rgba(size_t(k_width) * k_height * 4);
        EXPECT_TRUE(
            gpu::read_now(*device, forest->vegetation().color(), 0, std::as_writable_bytes(std::span(rgba))));
        return rgba;
    }
    static size_t differing(const Pixels& a, const Pixels& b, uint32_t first_x, uint32_t end_x) {
        size_t count = 0;
        for (uint32_t y = 0; y < k_height; ++y)
            for (uint32_t x = first_x; x < end_x; ++x) {
                const size_t i = 4 * (size_t(y) * k_width + x);
                count += !std::equal(&a[i], &a[i] + 4, &b[i]);
            }
        return count;
    }

    std::string folder;
    std::unique_ptr<gpu::Device> device;
    gpu::CommandRing ring;
    std::unique_ptr<EmbeddedForest> forest;
};

constexpr uint32_t k_birch = 0, k_fern = 1;  // models stand in the order of their names
Placement fern_at(double x) { return {dvec3(x, 1.0, -4.0), 1.0f, pack_turn_about_y(0.0f), {k_fern, 7}}; }
Placement birch_at(double x) { return {dvec3(x, 0.0, -10.0), 1.0f, pack_turn_about_y(0.0f), {k_birch, 7}}; }

TEST_F(EmbeddedForestTest, PlantsComeMoveAndGo) {
    constexpr uint32_t k_half = k_width / 2;
    const Pixels without = draw();
    LoosePlants& plants = forest->plants();
    const auto fern = plants.add(fern_at(-1.5));
    ASSERT_TRUE(fern);
    const Pixels on_the_left = draw();
    EXPECT_GT(differing(without, on_the_left, 0, k_half), 300u);
    EXPECT_EQ(differing(without, on_the_left, k_half, k_width), 0u);
    EXPECT_EQ(forest->report().plants, 21u);
    ASSERT_TRUE(plants.move(*fern, fern_at(1.5)));
    const Pixels on_the_right = draw();
    EXPECT_EQ(differing(without, on_the_right, 0, k_half), 0u);
    EXPECT_GT(differing(without, on_the_right, k_half, k_width), 300u);
    ASSERT_TRUE(plants.remove(*fern));
    EXPECT_EQ(differing(without, draw(), 0, k_width), 0u);
    EXPECT_EQ(plants.size(), 0u);
    EXPECT_FALSE(plants.remove(*fern));
    EXPECT_FALSE(plants.move(*fern, fern_at(0.0)));
}

TEST_F(EmbeddedForestTest, ShadowsFollow) {
    draw(FrameSettings());
    for (int i = 0; i < 20 && forest->report().shadow_maps > 0; ++i) draw(FrameSettings());
    EXPECT_EQ(forest->report().shadow_maps, 0u);  // nothing moves: all maps stay
    ASSERT_TRUE(forest->plants().add(birch_at(0.0)));
    auto frame = ring.begin();
    ASSERT_TRUE(frame);
    ASSERT_TRUE(forest->record({frame->commands, frame->slot, Camera{}, {}, {}}));
    EXPECT_GT(forest->report().shadow_maps, 0u);
    EXPECT_GT(forest->report().shadow_plants, 0u);
    ASSERT_TRUE(ring.submit());
    ASSERT_TRUE(ring.wait(frame->serial));
}

// A scene that lies in a host's archive, and nowhere on the disk.
TEST_F(EmbeddedForestTest, FilesMayComeFromTheHost) {
    const Pixels from_disk = draw();
    struct Archive {
        std::map<std::string, std::string> files;
        std::mutex mutex;
        std::set<std::string> asked;
    } archive;
    for (const char* name : {"clearing.eco.json", "fern.json", "birch.json"}) {
        auto text = read_text_file(folder + "/" + name);
        ASSERT_TRUE(text);
        archive.files[std::string("archive:/clearing/") + name] = std::move(*text);
    }
    set_file_source(
        [](void* context, const std::string& path) -> Result<std::vector<std::byte>> {
            auto& of = *static_cast<Archive*>(context);
            std::lock_guard lock(of.mutex);
            of.asked.insert(path);
            const auto found = of.files.find(path);
            if (found == of.files.end()) return fail(ErrorId::file_missing, path, "", "not in the archive", "add it");
            const auto bytes = std::as_bytes(std::span(found->second));
            return std::vector<std::byte>(bytes.begin(), bytes.end());
        },
        &archive);
    device->wait_idle();
    forest.reset();
    EmbeddedForestSettings settings;
    settings.device = {device->instance, device->physical, device->handle};
    settings.device.queue_family = device->queue_family;
    settings.scene = "archive:/clearing/clearing.eco.json";
    settings.cache_dir = testing::TempDir() + "embedded_forest_cache_of_archive";
    std::filesystem::remove_all(settings.cache_dir);
    settings.width = k_width;
    settings.height = k_height;
    auto created = EmbeddedForest::create(settings);
    settings.scene = "archive:/clearing/none.eco.json";
    const auto missing = EmbeddedForest::create(settings);
    set_file_source(nullptr, nullptr);
    ASSERT_TRUE(created) << to_string(created.error());
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().id, ErrorId::file_missing);
    forest = std::move(*created);
    for (const auto& [path, text] : archive.files) EXPECT_TRUE(archive.asked.contains(path)) << path;
    EXPECT_EQ(differing(from_disk, draw(), 0, k_width), 0u);
}

TEST_F(EmbeddedForestTest, StemsFollow) {
    const StemIndex& stems = forest->stems();
    EXPECT_EQ(stems.size(), 20u);
    auto hit = [&](double x) { return stems.first_hit({x, 0.3, 0.0}, {0.0f, 0.0f, -1.0f}, 12.0f); };
    EXPECT_FALSE(hit(3.0).any());
    const auto birch = forest->plants().add(birch_at(3.0));
    ASSERT_TRUE(birch);
    EXPECT_EQ(hit(3.0).plant, *birch);
    EXPECT_NEAR(hit(3.0).distance_m, 10.0f, 0.5f);
    EXPECT_GE(*birch, k_first_loose_plant);
    ASSERT_TRUE(forest->plants().move(*birch, birch_at(-3.0)));
    EXPECT_FALSE(hit(3.0).any());
    EXPECT_EQ(hit(-3.0).plant, *birch);
    ASSERT_TRUE(forest->plants().remove(*birch));
    EXPECT_FALSE(hit(-3.0).any());
    EXPECT_EQ(stems.size(), 20u);
}

TEST_F(EmbeddedForestTest, PlantsThatMakeNoSenseAreRefused) {
    LoosePlants& plants = forest->plants();
    const auto fern = plants.add(fern_at(0.0));
    ASSERT_TRUE(fern);
    const Pixels before = draw();
    Placement shrunk = fern_at(0.0), nowhere = fern_at(NAN), unknown = fern_at(0.0);
    shrunk.scale = 0.0f;
    unknown.model.model = 2;
    for (const Placement& wrong : {shrunk, nowhere, unknown}) {
        const auto added = plants.add(wrong);
        ASSERT_FALSE(added);
        EXPECT_EQ(added.error().id, ErrorId::value_out_of_range);
        EXPECT_FALSE(plants.move(*fern, wrong));
    }
    // Four squares may have plants; one that is left is free for another.
    std::vector<uint32_t> far;
    for (int i = 1; i < 4; ++i) {
        const auto added = plants.add(fern_at(1000.0 + 20.0 * i));
        ASSERT_TRUE(added);
        far.push_back(*added);
    }
    const auto one_more = plants.add(fern_at(2000.0));
    ASSERT_FALSE(one_more);
    EXPECT_EQ(one_more.error().id, ErrorId::limit_exceeded);
    EXPECT_TRUE(plants.add(fern_at(1020.0)));
    draw();
    EXPECT_TRUE(plants.move(far[1], fern_at(2000.0)));
    EXPECT_EQ(differing(before, draw(), 0, k_width), 0u);
}

TEST_F(EmbeddedForestTest, ExplainsWhatItDrew) {
    EXPECT_TRUE(forest->vegetation().explain_frame().plants.empty());
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(forest->plants().add(fern_at(-7.0 + 0.3 * i)));
    FrameSettings with_budget;
    with_budget.vertex_budget = 20000;
    FrameSettings full;
    full.level_of_detail = false;
    std::vector<SampleDistanceReason> reasons;
    for (const FrameSettings& settings : {FrameSettings(), with_budget, full}) {
        draw(settings);
        const FrameReport& report = forest->report();
        const FrameExplanation explained = forest->vegetation().explain_frame();
        reasons.push_back(explained.reason);
        PrimitiveCounts drawn;
        uint64_t plants = 0, full_triangles = 0;
        auto add = [&](const PrimitiveCounts& of) {
            drawn.triangles += of.triangles;
            drawn.lines += of.lines;
            drawn.points += of.points;
            drawn.leaves += of.leaves;
        };
        for (const ExplainedPlants& row : explained.plants) {
            add(row.drawn);
            plants += row.plants;
            full_triangles += row.full_triangles;
            EXPECT_LE(row.nearest_m, row.farthest_m);
        }
        EXPECT_EQ(plants, report.plants_visible);
        EXPECT_EQ(explained.plants_seen, report.plants_visible);
        for (const ExplainedCloud& cloud : explained.clouds) {
            add(cloud.drawn);
            full_triangles += cloud.full_triangles;
        }
        EXPECT_EQ(explained.clouds.size(), report.clouds);
        EXPECT_EQ(explained.plants_in_clouds, report.cloud_plants);
        EXPECT_EQ(explained.plants_hidden, report.plants_hidden);
        EXPECT_EQ(drawn.triangles, report.triangles);
        EXPECT_EQ(drawn.lines, report.lines);
        EXPECT_EQ(drawn.points, report.points);
        EXPECT_EQ(drawn.leaves, report.leaves);
        EXPECT_EQ(vertices_of(drawn), report.vertices);
        EXPECT_EQ(full_triangles, report.full_triangles);
        EXPECT_EQ(explained.plants_seen + explained.plants_in_clouds + explained.plants_hidden +
                      explained.plants_elsewhere,
                  report.plants);
        EXPECT_TRUE(std::ranges::is_sorted(explained.plants, std::greater{},
                                           [](const auto& row) { return vertices_of(row.drawn); }));
        const std::string text = to_text(explained);
        EXPECT_NE(text.find("fern"), std::string::npos) << text;
    }
    EXPECT_EQ(reasons, (std::vector{SampleDistanceReason::asked, SampleDistanceReason::budget,
                                    SampleDistanceReason::no_levels}));
}

TEST_F(EmbeddedForestTest, ChangedFilesAreLoadedWhileItIsDrawn) {
    auto reload = [&] { return forest->reload_if_changed(); };
    const auto fern = forest->plants().add(fern_at(1.5));
    ASSERT_TRUE(fern);
    const Pixels before = draw();
    auto unchanged = reload();
    ASSERT_TRUE(unchanged);
    EXPECT_FALSE(*unchanged);

    // The scene; what the host placed is there, though models have other numbers now.
    const char* with_another_model =
        R"({"alder": {"source": "birch.json"}, "birch": {"source": "birch.json"}, "fern": {"source": "fern.json"}})";
    write("clearing.eco.json", scene_of(with_another_model, 60));
    auto loaded = reload();
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    EXPECT_TRUE(*loaded);
    const Pixels after = draw();
    EXPECT_EQ(forest->report().plants, 61u);
    EXPECT_EQ(forest->stems().size(), 60u);  // ferns have none
    EXPECT_GT(differing(before, after, 0, k_width), 300u);
    EXPECT_EQ(forest->plants().size(), 1u);

    // One that is wrong leaves all as it is, and is not tried twice.
    write("clearing.eco.json", R"({"name": "half a sce)");
    auto refused = reload();
    ASSERT_FALSE(refused);
    EXPECT_NE(to_string(refused.error()).find("clearing.eco.json"), std::string::npos);
    EXPECT_EQ(differing(after, draw(), 0, k_width), 0u);
    auto again = reload();
    ASSERT_TRUE(again);
    EXPECT_FALSE(*again);
    write("clearing.eco.json", scene_of(with_another_model, 60));
    ASSERT_TRUE(reload());
    EXPECT_EQ(differing(after, draw(), 0, k_width), 0u);

    // A plant: its triangles are others.
    auto species = read_text_file(folder + "/fern.json");
    ASSERT_TRUE(species);
    const size_t at = species->find("\"count\": 13");
    ASSERT_NE(at, std::string::npos);
    species->replace(at, 11, "\"count\": 5");
    write("fern.json", *species);
    loaded = reload();
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    EXPECT_TRUE(*loaded);
    EXPECT_GT(differing(after, draw(), 0, k_width), 100u);

    // Without the model its plants go.
    write("clearing.eco.json", scene_of(R"({"birch": {"source": "birch.json"}})", 60));
    ASSERT_TRUE(reload());
    draw();
    EXPECT_EQ(forest->plants().size(), 0u);
    EXPECT_EQ(forest->report().plants, 60u);
    EXPECT_FALSE(forest->plants().remove(*fern));
}

// Models of one name are a plant's variations: the host's plants keep theirs.
TEST_F(EmbeddedForestTest, VariationsStayWhenFilesChange) {
    const char* k_two = R"({"birch": {"source": "birch.json"}, "fern": {"source": "fern.json", "variations": 3}})";
    write("clearing.eco.json", scene_of(k_two, 20));
    ASSERT_TRUE(forest->reload_if_changed());
    std::vector<uint32_t> ferns;
    for (uint32_t m = 0; m < forest->scene().models.size(); ++m)
        if (forest->scene().models[m].name == "fern") ferns.push_back(m);
    ASSERT_EQ(ferns.size(), 3u);
    for (size_t i = 0; i < 3; ++i) {
        Placement fern = fern_at(double(i) - 1.0);
        fern.model.model = ferns[i];
        ASSERT_TRUE(forest->plants().add(fern));
    }
    const Pixels before = draw();
    const char* k_another_first =
        R"({"alder": {"source": "birch.json"}, "birch": {"source": "birch.json"}, "fern": {"source": "fern.json", "variations": 3}})";
    write("clearing.eco.json", scene_of(k_another_first, 20));
    auto loaded = forest->reload_if_changed();
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    ASSERT_TRUE(*loaded);
    EXPECT_EQ(differing(before, draw(), 0, k_width), 0u);
    EXPECT_EQ(forest->plants().size(), 3u);
    // Fewer than before: none is lost.
    write("clearing.eco.json", scene_of(k_plants, 20));
    ASSERT_TRUE(forest->reload_if_changed());
    draw();
    EXPECT_EQ(forest->plants().size(), 3u);
}

}  // namespace
}  // namespace coppice
