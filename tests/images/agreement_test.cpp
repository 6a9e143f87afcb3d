// Points, lines and triangles of a plant agree with its full geometry: coverage and mean colour within 3 % at 50, 100
// and 200 px of height, averaged over 16 directions. The full geometry is drawn at one sample a pixel at several
// places of the pixel grid; in the mean that is its exact coverage.
#include <gtest/gtest.h>
#include "plugins/modeller/grow.h"
#include "plugins/vegetation/cook/cook_plant.h"
#include "plugins/vegetation/report/measure_levels.h"
#include "runtime/core/file.h"

namespace coppice {
namespace {

constexpr double k_bound = 0.03;

const gpu::Device* shared_device() {
    static std::unique_ptr<gpu::Device> device = [] {
        gpu::DeviceSettings settings;
        settings.validation = true;
        auto made = gpu::Device::create(settings);
        EXPECT_TRUE(made) << to_string(made.error());
        return made ? std::move(*made) : nullptr;
    }();
    return device.get();
}

class Agreement : public ::testing::TestWithParam<const char*> {};

TEST_P(Agreement, LevelsOfDetailCoverWhatThePlantCovers) {
    ASSERT_TRUE(shared_device());
    std::string path = std::string(COPPICE_CONTENT_DIR) + "/species/" + GetParam() + ".json";
    auto text = read_text_file(path);
    ASSERT_TRUE(text) << to_string(text.error());
    auto description = modeller::grow_plant(*text, path, 0);
    ASSERT_TRUE(description) << to_string(description.error());
    auto bytes = cook_plant(*description, {});
    ASSERT_TRUE(bytes) << to_string(bytes.error());
    auto plant =
        load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(*bytes)), GetParam());
    ASSERT_TRUE(plant) << to_string(plant.error());
    auto picture = PlantPicture::create(*shared_device(), std::move(*plant), 512);
    ASSERT_TRUE(picture) << to_string(picture.error());

    auto measure = [&](float height_px, const FrameSettings& settings) {
        auto figures = measure_levels(**picture, height_px, settings);
        EXPECT_TRUE(figures) << to_string(figures.error());
        return figures ? *figures : LevelFigures{};
    };
    for (float height_px : {50.0f, 100.0f, 200.0f}) {
        const LevelFigures figures = measure(height_px, {});
        std::printf(
            "%-12s %3.0f px: coverage %+6.2f %%, colour %5.2f %%, triangles %llu of %llu, lines %llu, points "
            "%llu\n",
            GetParam(), height_px, 100.0 * figures.coverage_error, 100.0 * figures.color_error,
            static_cast<unsigned long long>(figures.drawn.triangles),
            static_cast<unsigned long long>(figures.full.triangles),
            static_cast<unsigned long long>(figures.drawn.lines),
            static_cast<unsigned long long>(figures.drawn.points));
        EXPECT_LE(std::fabs(figures.coverage_error), k_bound) << height_px;
        EXPECT_LE(figures.color_error, k_bound) << height_px;
        EXPECT_GT(figures.coverage_px, 2.0);
    }
    // A coarser sample distance means fewer and larger primitives, not more or less of the plant.
    FrameSettings coarse;
    coarse.sample_distance_px = 2.0f;
    EXPECT_LE(std::fabs(measure(150.0f, coarse).coverage_error), k_bound);
    // Else a level of detail that never leaves out a triangle would agree best.
    const LevelFigures far = measure(20.0f, {});
    EXPECT_LT(far.drawn.triangles, far.full.triangles / 5);
    EXPECT_GT(far.drawn.points + far.drawn.lines, 0u);
    EXPECT_EQ(shared_device()->validation_messages(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Species, Agreement,
                         ::testing::Values("pine", "birch", "oak", "stand_tree", "palm", "shrub", "grass",
                                           "fern", "daisy", "sunflower"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace coppice
