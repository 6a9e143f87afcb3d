// What is left out behind the ground changes no picture: visibility words and colours pixel for pixel along a path.
#include "tests/images/hills.h"

namespace coppice {
namespace {

TEST(Occlusion, ChangesNoPixelAlongAPath) {
    HillsSettings scene;
    scene.amplitude_m = 60.0f;
    scene.validation = true;
    auto hills = Hills::create(scene);
    ASSERT_TRUE(hills) << to_string(hills.error());
    struct Case {
        const char* name;
        FrameSettings settings;
        uint32_t views;
    };
    Case cases[] = {{"fine", {}, 24}, {"coarse", {}, 24}, {"every triangle", {}, 20}};
    cases[0].settings.sample_distance_px = 0.7f;
    cases[1].settings.sample_distance_px = 3.0f;
    cases[2].settings.level_of_detail = false;
    for (const Case& test : cases) {
        uint64_t tiles_hidden = 0, plants_hidden = 0, kept_vertices = 0, all_vertices = 0;
        uint64_t clouds = 0, points = 0, lines = 0, triangles = 0;
        for (uint32_t view = 0; view < test.views; ++view) {
            const float on = float(view) / float(test.views);
            const Camera camera =
                (*hills)->camera_at(-250.0f + 500.0f * on, 200.0f - 330.0f * on, view % 3 == 0 ? 12.0f : 1.6f,
                                    2.4f * float(view), view % 4 == 0 ? -0.3f : 0.02f);
            FrameSettings settings = test.settings;
            std::vector<uint64_t> words[2];
            std::vector<uint32_t> colors[2];
            for (bool occlusion : {false, true}) {
                settings.occlusion = occlusion;
                auto drawn = (*hills)->draw(camera, settings);
                ASSERT_TRUE(drawn) << to_string(drawn.error());
                auto seen = (*hills)->read<uint64_t>((*hills)->vegetation->visibility());
                auto shown = (*hills)->read<uint32_t>((*hills)->vegetation->color());
                ASSERT_TRUE(seen && shown);
                words[occlusion] = std::move(*seen);
                colors[occlusion] = std::move(*shown);
                const FrameReport& report = (*hills)->vegetation->report();
                (occlusion ? kept_vertices : all_vertices) += report.vertices;
                if (!occlusion) {
                    EXPECT_EQ(report.tiles_hidden + report.plants_hidden, 0u);
                    continue;
                }
                tiles_hidden += report.tiles_hidden;
                plants_hidden += report.plants_hidden;
                clouds += report.clouds;
                points += report.points;
                lines += report.lines;
                triangles += report.triangles;
            }
            size_t other = 0;
            for (size_t i = 0; i < words[0].size(); ++i)
                other += words[0][i] != words[1][i] || colors[0][i] != colors[1][i];
            EXPECT_EQ(other, 0u) << test.name << ", view " << view;
        }
        std::printf("%s: %llu tiles and %llu plants hidden, %.0f %% of the vertices left\n", test.name,
                    (unsigned long long)tiles_hidden, (unsigned long long)plants_hidden,
                    100.0 * double(kept_vertices) / double(all_vertices));
        EXPECT_GT(tiles_hidden, 0u) << test.name;
        EXPECT_GT(plants_hidden, 0u) << test.name;
        EXPECT_LT(kept_vertices, all_vertices) << test.name;
        EXPECT_GT(triangles, 0u);
        if (!test.settings.level_of_detail) continue;
        EXPECT_GT(clouds, 0u) << test.name;
        EXPECT_GT(points, 0u);
        EXPECT_GT(lines, 0u);
    }
    EXPECT_EQ((*hills)->validation_messages(), 0u);
}

}  // namespace
}  // namespace coppice
