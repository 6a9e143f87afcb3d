// What normals the pixels of a line show: of a stem the side that is seen, of leaves their own or several.
#include <set>
#include "plugins/vegetation/plant/surface.h"
#include "tests/draw/raster_fixture.h"

namespace coppice {
namespace {

class LineNormalsTest : public RasterTest {
  protected:
    // One line, 40 px wide, in a plant that `instance` turns, grows and moves.
    void draw_line(vec3 from, vec3 to, uint32_t surface, float turned_share, const WorkInstance& instance) {
        const std::vector<PackedVertex> ends{{from.x, from.y, from.z, surface},
                                             {to.x, to.y, to.z, std::bit_cast<uint32_t>(1.0f)}};
        PartChoice choice;
        choice.lines = 1;
        choice.line_width_px = 40.0f;
        choice.turned_share = turned_share;
        work_.begin(1);
        work_.part(0).add({}, choice, work_.part(0).add_instance(instance));
        ASSERT_TRUE(rasteriser_->set_geometry({ends, {}}));
        draw_work();
        ASSERT_GT(covered(), 2000u);
    }
    std::vector<vec3> shown_normals() const {
        std::vector<vec3> normals;
        for (uint64_t word : words_)
            if (word != 0) normals.push_back(decode_surface(uint32_t(word)).normal);
        return normals;
    }
    // By angle_rad about the vertical.
    static WorkInstance turned(float angle_rad, float scale, vec3 place) {
        return {place.x, place.y,
                place.z, scale,
                0.0f,    portable_sin(0.5f * angle_rad),
                0.0f,    portable_cos(0.5f * angle_rad)};
    }
    static vec3 apply(const WorkInstance& instance, vec3 v) {
        const vec3 axis(instance.turn_x, instance.turn_y, instance.turn_z), across = glm::cross(axis, v);
        return instance.scale * (v + 2.0f * (instance.turn_w * across + glm::cross(axis, across)));
    }
};

constexpr float k_encoding_error = 0.05f;  // of a normal in 12 bits, 2.6 degrees

TEST_F(LineNormalsTest, AStemIsLitOnTheSideThatIsSeen) {
    // The sun behind the viewer, and nothing else.
    light_ = {vec3(0, 0, 1), vec3(0.6f), vec3(0.0f), vec3(0.0f), vec3(0.0f), vec3(0.0f), 0.0f, 1.0f};
    picture_.filter_radius_px = 1.0f;
    for (vec3 stored : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(1, 0, 0), vec3(-0.6f, 0, -0.8f), vec3(0, 1, 0)})
        for (float turn : {0.0f, 1.1f, 3.0f}) {
            const vec3 place(0.3f, 0.0f, -10.0f);
            const WorkInstance instance = turned(turn, 2.0f, place);
            const uint32_t surface = encode_surface({stored, vec3(1.0f), 1.0f, false}, 0);
            draw_line(vec3(0, -2.5f, 0), vec3(0, 2.5f, 0), surface, 0.0f, instance);
            const vec3 front = normalize_or(-place, vec3(0, 0, 1));
            double facing = 0.0, beside = 0.0, seen = 0.0;
            std::set<uint32_t> kinds;
            for (uint64_t word : words_)
                if (word != 0) kinds.insert(uint32_t(word) & 0xfffu);
            for (vec3 normal : shown_normals()) {
                EXPECT_NEAR(normal.y, 0.0f, k_encoding_error);
                EXPECT_GT(glm::dot(normal, front), 0.5f);
                facing += glm::dot(normal, front);
                beside += glm::dot(normal, glm::cross(front, vec3(0, 1, 0)));
                seen += 1.0;
            }
            // The mean of a cylinder's normals over its width is pi / 4 towards the viewer, and nothing sideways.
            EXPECT_NEAR(facing / seen, 0.785, 0.06) << turn;
            EXPECT_NEAR(beside / seen, 0.0, 0.05) << turn;
            EXPECT_EQ(kinds.size(), 4u);  // not all of a pixel's width at once

            double red = 0.0;
            const std::vector<uint32_t> rgba = colors();
            for (size_t i = 0; i < rgba.size(); ++i)
                if (words_[i] != 0) red += double(rgba[i] & 255u);
            EXPECT_GT(red / seen, 128.0);
        }
    // From behind the same stem is dark.
    light_.direction_to_sun = vec3(0, 0, -1);
    draw_line(vec3(0, -2.5f, 0), vec3(0, 2.5f, 0),
              encode_surface({vec3(0, 0, -1), vec3(1.0f), 1.0f, false}, 0), 0.0f,
              turned(0.0f, 2.0f, vec3(0, 0, -10)));
    const std::vector<uint32_t> rgba = colors();
    for (size_t i = 0; i < rgba.size(); ++i)
        if (words_[i] != 0) {
            ASSERT_EQ(rgba[i] & 255u, 0u);
        }
}

TEST_F(LineNormalsTest, ALeafShowsItsOwnNormalUnlessItStandsForSeveral) {
    const WorkInstance instance = turned(0.7f, 1.5f, vec3(0, 0, -10));
    const vec3 from(-2.0f, -2.0f, 0.0f), to(2.0f, 2.0f, 0.5f);
    const vec3 along = normalize_or(apply(instance, to - from), vec3(1, 0, 0));
    const vec3 own_plant = normalize_or(glm::cross(to - from, vec3(0.3f, -0.2f, 1.0f)), vec3(0, 0, 1));
    const vec3 own = normalize_or(apply(instance, own_plant), vec3(0, 0, 1));
    const uint32_t surface = encode_surface({own_plant, vec3(0.2f, 0.4f, 0.1f), 1.0f, true}, 0);
    auto share_of_own = [&](float turned_share, size_t normals_wanted) {
        draw_line(from, to, surface, turned_share, instance);
        const std::vector<vec3> normals = shown_normals();
        std::set<uint32_t> kinds;
        double as_own = 0.0;
        for (uint64_t word : words_)
            if (word != 0) kinds.insert(uint32_t(word) & 0xfffu);
        for (vec3 normal : normals) {
            EXPECT_NEAR(glm::dot(normal, along), 0.0f,
                        2.0f * k_encoding_error);  // turned about the line's axis
            as_own += glm::length(normal - own) < 2.0f * k_encoding_error;
        }
        EXPECT_EQ(kinds.size(), normals_wanted) << turned_share;
        return as_own / double(normals.size());
    };
    EXPECT_EQ(share_of_own(0.0f, 1), 1.0);
    const double half = share_of_own(0.5f, 4), none = share_of_own(1.0f, 4);
    // Of four normals about the axis each is seen by its |n . v|.
    const vec3 view = normalize_or(apply(instance, from) + vec3(0, 0, -10), vec3(0, 0, -1));
    const vec3 beside = glm::cross(along, own);
    double seen = 0.0;
    for (vec3 normal : {own, (own + beside) * 0.7071f, beside, (beside - own) * 0.7071f})
        seen += std::fabs(double(glm::dot(normal, view)));
    const double own_seen = std::fabs(double(glm::dot(own, view))) / seen;
    EXPECT_NEAR(half, 0.5 + 0.5 * own_seen, 0.05);
    EXPECT_NEAR(none, own_seen, 0.05);
    // The rest of what is drawn stays: colour, openness and that it is a leaf.
    for (uint64_t word : words_)
        if (word != 0) {
            ASSERT_EQ(uint32_t(word) & ~0xfffu, surface & ~0xfffu);
        }
}

}  // namespace
}  // namespace coppice
