// Plants' tints on the screen: the same for every kind of primitive, and what eco/vary_color.h says.
#include "plugins/vegetation/eco/vary_color.h"
#include "plugins/vegetation/plant/surface.h"
#include "runtime/core/hash.h"
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

constexpr vec3 k_color(0.12f, 0.21f, 0.05f);

class TintTest : public RasterTest {
  protected:
    enum Kind { points, lines, triangles, big_triangles };
    static constexpr const char* k_names[] = {"points", "lines", "triangles", "big triangles"};

    static uint32_t surface(uint32_t i) { return encode_surface({vec3(0, 0, 1), k_color, 1.0f, false}, mix_bits(i)); }

    // Mean colour of the pixels that one plant covers with primitives of a kind.
    dvec3 mean_of(Kind kind, uint32_t tint, bool has_tints = true) {
        std::vector<PackedVertex> vertices;
        PartChoice choice;
        const float step = kind == big_triangles ? 100.0f : 4.0f;
        for (float y = 20.5f; y < 220.0f; y += step)
            for (float x = 20.5f; x < 220.0f; x += step) {
                auto add = [&](float dx, float dy) {
                    vertices.push_back(at(x + dx, y + dy, 20.0f, surface(uint32_t(vertices.size()))));
                };
                add(0.0f, 0.0f);
                if (kind == points) ++choice.points;
                if (kind == lines) {
                    vertices.push_back(at(x + 3.0f, y, 20.0f, std::bit_cast<uint32_t>(1.0f)));
                    ++choice.lines;
                } else if (kind != points) {
                    add(0.0f, 0.9f * step);
                    add(0.9f * step, 0.0f);
                    ++choice.triangles;
                }
            }
        choice.splat_px = choice.line_width_px = 2.0f;
        work_.begin(1);
        WorkInstance instance;
        if (has_tints) set_tint(instance, tint);
        work_.part(0).add({}, choice, work_.part(0).add_instance(instance));
        EXPECT_TRUE(rasteriser_->set_geometry({vertices, {}, 0, has_tints}));
        draw_work();
        dvec3 sum(0.0);
        for (uint64_t word : words_)
            if (word != 0) sum += dvec3(decode_surface(uint32_t(word)).color_linear);
        return sum / double(covered());
    }
};

TEST_F(TintTest, AllKindsShowThePlantsColour) {
    const ColorTints tints({0.4f, 20.0f, 0.3f});
    for (Kind kind : {points, lines, triangles, big_triangles}) {
        const dvec3 plain = mean_of(kind, 0, false), neutral = mean_of(kind, 0);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(neutral[c], plain[c], 0.01 * plain[c]) << k_names[kind];
        for (uint32_t seed = 1; seed < 9; ++seed) {
            const uint32_t tint = tints.tint_of(mix_bits(seed));
            const dvec3 expected(tint_color(tint, k_color)), shown = mean_of(kind, tint);
            // Big triangles have three colours each, which were rounded once.
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(shown[c], expected[c], (kind == big_triangles ? 0.12 : 0.03) * expected[c] + 0.001)
                    << k_names[kind] << " " << seed << " " << c;
        }
    }
}

// Carrying a tint moves nothing that can be seen.
TEST_F(TintTest, TintsMoveNothing) {
    const dvec3 plain = mean_of(triangles, 0, false);
    const std::vector<uint64_t> before = words_;
    const dvec3 tinted = mean_of(triangles, 0x123456u);
    EXPECT_NE(plain, tinted);
    size_t moved = 0;
    for (size_t i = 0; i < before.size(); ++i) moved += (before[i] == 0) != (words_[i] == 0);
    EXPECT_LE(moved, before.size() / 2000);
}

// Views that colours say something else in are not tinted.
TEST_F(TintTest, OtherViewsAreAsTheyWere) {
    picture_.view = RepresentationView::coverage;
    mean_of(points, 0x123456u);
    for (uint64_t word : words_)
        if (word != 0) ASSERT_EQ(uint32_t(word) & 0x0ffff000u, 0x0ffff000u);
}

}  // namespace
}  // namespace coppice
