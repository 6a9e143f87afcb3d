// Points, lines and triangles of a plant agree with its full geometry: coverage and mean colour within 3 % at 50, 100
// and 200 px of height, averaged over 16 directions. The full geometry is drawn at one sample a pixel at several
// places of the pixel grid; in the mean that is its exact coverage.
#include <gtest/gtest.h>
#include "plugins/modeller/grow.h"
#include "plugins/vegetation/cook/cook_plant.h"
#include "runtime/core/file.h"
#include "runtime/core/random.h"
#include "tests/images/plant_picture.h"

namespace coppice {
namespace {

constexpr int k_directions = 16, k_shifts = 4;
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

struct Means {
    double coverage_px = 0.0;
    double color[3] = {};
    uint64_t triangles = 0, lines = 0, points = 0;
};

Means mean_over_directions(PlantPicture& picture, float height_px, const FrameSettings& settings) {
    Means means;
    Random random(1);
    for (int i = 0; i < k_directions; ++i) {
        float yaw = 2.0f * k_pi * 0.618034f * float(i);
        float pitch = -0.35f * float(i % 4);  // from the side to 60 degrees above
        for (int shift = 0; shift < k_shifts; ++shift) {
            auto mean =
                picture.draw(height_px, yaw, pitch, {random.next_unit(), random.next_unit()}, settings);
            EXPECT_TRUE(mean) << to_string(mean.error());
            if (!mean) return means;
            means.coverage_px += mean->coverage_px;
            for (int c = 0; c < 3; ++c) means.color[c] += double(mean->color_linear[c]) * mean->coverage_px;
            means.triangles += picture.work().triangles;
            means.lines += picture.work().lines;
            means.points += picture.work().points;
        }
    }
    for (double& color : means.color) color /= std::max(means.coverage_px, 1.0);
    return means;
}

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

    FrameSettings full, lod;
    full.level_of_detail = false;
    for (float height_px : {50.0f, 100.0f, 200.0f}) {
        Means reference = mean_over_directions(**picture, height_px, full);
        Means drawn = mean_over_directions(**picture, height_px, lod);
        double coverage = drawn.coverage_px / reference.coverage_px - 1.0;
        double brightness = (reference.color[0] + reference.color[1] + reference.color[2]) / 3.0, color = 0.0;
        for (int c = 0; c < 3; ++c)
            color = std::max(color, std::fabs(drawn.color[c] - reference.color[c]) / brightness);
        std::printf(
            "%-12s %3.0f px: coverage %+6.2f %%, colour %5.2f %%, triangles %llu of %llu, lines %llu, points "
            "%llu\n",
            GetParam(), height_px, 100.0 * coverage, 100.0 * color,
            static_cast<unsigned long long>(drawn.triangles),
            static_cast<unsigned long long>(reference.triangles),
            static_cast<unsigned long long>(drawn.lines), static_cast<unsigned long long>(drawn.points));
        EXPECT_LE(std::fabs(coverage), k_bound) << height_px;
        EXPECT_LE(color, k_bound) << height_px;
        EXPECT_GT(reference.coverage_px, 100.0);
    }
    // A coarser sample distance means fewer and larger primitives, not more or less of the plant.
    FrameSettings coarse = lod;
    coarse.sample_distance_px = 2.0f;
    Means full_coarse = mean_over_directions(**picture, 150.0f, full);
    Means drawn_coarse = mean_over_directions(**picture, 150.0f, coarse);
    EXPECT_NEAR(drawn_coarse.coverage_px / full_coarse.coverage_px, 1.0, k_bound);
    // Else a level of detail that never leaves out a triangle would agree best.
    Means full_far = mean_over_directions(**picture, 20.0f, full),
          far = mean_over_directions(**picture, 20.0f, lod);
    EXPECT_LT(far.triangles, full_far.triangles / 5);
    EXPECT_GT(far.points + far.lines, 0u);
    EXPECT_EQ(shared_device()->validation_messages(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Species, Agreement,
                         ::testing::Values("pine", "birch", "oak", "stand_tree", "palm", "shrub", "grass",
                                           "fern", "daisy", "sunflower"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace coppice
