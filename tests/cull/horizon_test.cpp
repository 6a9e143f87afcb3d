// What the horizon hides is looked for with rays against the triangles that are drawn.
#include "plugins/vegetation/cull/horizon.h"

#include <gtest/gtest.h>
#include "plugins/terrain/build_patches.h"
#include "plugins/terrain/grow_heights.h"
#include "plugins/shared/noise.h"
#include "plugins/vegetation/cull/ground_level.h"
#include "runtime/core/random.h"
#include "tests/count_allocations.h"

namespace coppice {
namespace {

class FieldTerrain final : public Terrain {
  public:
    explicit FieldTerrain(HeightField field, dvec3 origin_world = dvec3(0.0))
        : field_(std::move(field)),
          mesh_(build_patches(field_)),
          words_(mesh_.word_count),
          vertices_(mesh_.vertex_count),
          bounds_(mesh_.bounds()),
          origin_world_(origin_world) {
        write_vertices(vertices_);
    }
    dvec3 origin_world() const override { return origin_world_; }
    Box bounds_local() const override { return bounds_; }
    float height_at(float x, float z) const override { return field_.height_at(x, z); }
    vec3 normal_at(float, float) const override { return vec3(0, 1, 0); }
    std::span<const TerrainPatch> patches() const override { return mesh_.patches; }
    std::span<const TerrainLevel> levels() const override { return mesh_.levels; }
    std::span<const PackedVertex> vertices() const override { return vertices_; }
    uint32_t vertex_count() const override { return mesh_.vertex_count; }
    void write_vertices(std::span<PackedVertex> all) const override {
        coppice::write_vertices(field_, mesh_, words_, all);
    }
    void write_level(uint32_t level, std::span<PackedVertex> of_level) const override {
        coppice::write_level(field_, mesh_, level, words_, of_level);
    }
    void shade(float, float, float, float) override {}
    TerrainLayout layout() const override {
        return {vec2(field_.x_of(0), field_.z_of(0)), field_.cell_m, field_.columns - 1, field_.rows - 1};
    }
    std::span<const float> least_heights() const override { return mesh_.least_heights; }
    const HeightField& field() const { return field_; }

  private:
    HeightField field_;
    TerrainMesh mesh_;
    std::vector<uint32_t> words_;
    std::vector<PackedVertex> vertices_;
    Box bounds_;
    dvec3 origin_world_;
};

HeightField make_field(uint32_t columns, uint32_t rows, float cell_m, auto&& height) {
    HeightField field;
    field.columns = columns;
    field.rows = rows;
    field.cell_m = cell_m;
    for (uint32_t row = 0; row < rows; ++row)
        for (uint32_t column = 0; column < columns; ++column)
            field.heights_m.push_back(height(field.x_of(column), field.z_of(row)));
    return field;
}

// Hills, crests, cliffs and bare chance, of any size and shape.
HeightField some_field(Random& random) {
    const uint32_t seed = uint32_t(random.next_bits());
    const float cell_m = std::exp(random.next_in(-1.5f, 2.5f));
    const float size_m = cell_m * 80.0f, wave_m = size_m * random.next_in(0.1f, 0.7f);
    const float height_m = size_m * random.next_in(0.0f, 0.25f), cliff = random.next_in(0.0f, 0.1f);
    const float chance_m = random.next_below(3) == 0 ? 2.0f * cell_m : 0.0f;
    return make_field(4 + random.next_below(110), 4 + random.next_below(110), cell_m, [&](float x, float z) {
        const float noise = fractal_noise(x / wave_m, z / wave_m, 4, 0.5f, seed);
        const float step = std::floor(noise * 6.0f) * cliff;
        return height_m * (noise + step) + chance_m * random.next_unit();
    });
}

struct Shot {
    Camera camera;
    uint32_t width = 320, height = 240;
    float error_px = 1.0f;
    Frustum frustum() const { return make_frustum(camera, width, height); }
};

// The triangles of a frame's ground, relative to the camera.
class DrawnGround {
  public:
    DrawnGround(const Terrain& terrain, const Shot& shot) : frustum_(shot.frustum()) {
        const vec3 origin = vec3(terrain.origin_world() - shot.camera.position_world);
        for (const TerrainPatch& patch : terrain.patches()) {
            const Box bounds{patch.bounds_local.min + origin, patch.bounds_local.max + origin};
            if (see_box(frustum_, bounds) == Visibility::outside) continue;
            const uint32_t level =
                choose_ground_level(patch, terrain.levels(), bounds, frustum_, shot.error_px);
            deepest_level = std::max(deepest_level, level);
            const TerrainLevel& drawn = terrain.levels()[patch.first_level + level];
            Piece piece{bounds, {}};
            for (uint32_t v = drawn.first_vertex; v < drawn.first_vertex + drawn.vertex_count; v += 3) {
                dvec3 corner[3];
                for (int c = 0; c < 3; ++c) {
                    const PackedVertex& vertex = terrain.vertices()[v + uint32_t(c)];
                    corner[c] = dvec3(vec3(vertex.x_plant, vertex.y_plant, vertex.z_plant)) + dvec3(origin);
                }
                piece.triangles.push_back({corner[0], corner[1] - corner[0], corner[2] - corner[0]});
            }
            pieces_.push_back(std::move(piece));
        }
    }

    // Whether the front of a triangle lies before the point on the ray to it, beyond the near plane.
    bool covers(dvec3 point) const {
        const double near = double(frustum_.near_m) / glm::dot(dvec3(frustum_.forward), point);
        for (const Piece& piece : pieces_) {
            if (!meets(piece.bounds, point)) continue;
            for (const Triangle& t : piece.triangles) {
                const dvec3 p = glm::cross(point, t.to_c);
                const double area = glm::dot(t.to_b, p);
                if (!(area > 0.0)) continue;  // seen from behind
                const double u = -glm::dot(t.corner, p) / area;
                if (u < -1e-9 || u > 1.0 + 1e-9) continue;
                const dvec3 q = glm::cross(-t.corner, t.to_b);
                const double v = glm::dot(point, q) / area;
                if (v < -1e-9 || u + v > 1.0 + 1e-9) continue;
                const double along = glm::dot(t.to_c, q) / area;
                if (along >= near && along < 1.0 - 1e-5) return true;
            }
        }
        return false;
    }

    bool on_picture(dvec3 point) const {
        for (uint32_t i = 0; i < frustum_.plane_count; ++i)
            if (glm::dot(dvec3(frustum_.planes[i]), point) + double(frustum_.planes[i].w) < 0.0) return false;
        return true;
    }

    uint32_t deepest_level = 0;

  private:
    struct Triangle {
        dvec3 corner, to_b, to_c;
    };
    struct Piece {
        Box bounds;
        std::vector<Triangle> triangles;
    };
    static bool meets(const Box& bounds, dvec3 point) {
        double first = 0.0, last = 1.0;
        for (int axis = 0; axis < 3; ++axis) {
            const double slack = 1e-3 * (1.0 + double(std::fabs(bounds.min[axis])));
            const double low = double(bounds.min[axis]) - slack, high = double(bounds.max[axis]) + slack;
            if (std::fabs(point[axis]) < 1e-12) {
                if (low > 0.0 || high < 0.0) return false;
                continue;
            }
            const double a = low / point[axis], b = high / point[axis];
            first = std::max(first, std::min(a, b));
            last = std::min(last, std::max(a, b));
        }
        return first <= last;
    }
    Frustum frustum_;
    std::vector<Piece> pieces_;
};

// Corners, edges, faces and inside: a grid of `side` places each way.
std::vector<vec3> places_in(const Box& box, int side) {
    std::vector<vec3> places;
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z)
                places.push_back(box.min + box.size() * (vec3(x, y, z) / float(side - 1)));
    return places;
}

Shot some_shot(Random& random, const FieldTerrain& terrain) {
    Shot shot;
    const TerrainLayout layout = terrain.layout();
    const float x = -layout.corner_local.x * random.next_in(-1.02f, 1.02f);
    const float z = -layout.corner_local.y * random.next_in(-1.02f, 1.02f);
    const float above_m =
        random.next_below(8) == 0 ? random.next_in(-3.0f, 0.3f) : std::exp(random.next_in(-1.5f, 3.0f));
    shot.camera.position_world =
        terrain.origin_world() + dvec3(x, terrain.height_at(x, z) + above_m * layout.cell_m, z);
    shot.camera.yaw_rad = random.next_in(-4.0f, 4.0f);
    shot.camera.pitch_rad =
        random.next_below(4) == 0 ? random.next_in(-1.57f, 1.57f) : random.next_in(-0.4f, 0.3f);
    shot.camera.vertical_fov_rad = random.next_in(0.2f, 2.0f);
    shot.camera.near_m = random.next_in(0.02f, 0.4f) * layout.cell_m;
    shot.width = 20 + random.next_below(800);
    shot.height = 20 + random.next_below(600);
    constexpr float k_errors_px[] = {0.0f, 1.0f, 8.0f, 1e9f};
    shot.error_px = k_errors_px[random.next_below(4)];
    return shot;
}

Box some_box(Random& random, const FieldTerrain& terrain, const Shot& shot) {
    const TerrainLayout layout = terrain.layout();
    const float x = -layout.corner_local.x * random.next_in(-1.1f, 1.1f);
    const float z = -layout.corner_local.y * random.next_in(-1.1f, 1.1f);
    const float side_m = layout.cell_m * std::exp(random.next_in(-1.5f, 2.5f));
    const vec3 foot = vec3(terrain.origin_world() +
                           dvec3(x, terrain.height_at(x, z) + side_m * random.next_in(-1.0f, 0.6f), z) -
                           shot.camera.position_world);
    Box box;
    box.include(foot);
    box.include(foot +
                vec3(random.next_in(0.1f, 1), random.next_in(0.0f, 1), random.next_in(0.1f, 1)) * side_m);
    return box;
}

TEST(Horizon, NothingHiddenCanBeSeen) {
    Random random(1);
    size_t hidden = 0, rays = 0, deep_frames = 0, looking_down = 0;
    for (int round = 0; round < 1500; ++round) {
        const FieldTerrain terrain(some_field(random),
                                   round % 2 == 0 ? dvec3(0.0) : dvec3(1e7 - 0.5, 300.25, -5e6));
        Horizon horizon;
        for (int frame = 0; frame < 3; ++frame) {
            const Shot shot = some_shot(random, terrain);
            const Frustum frustum = shot.frustum();
            horizon.build(&terrain, shot.camera.position_world, frustum, shot.error_px);
            if (horizon.empty()) continue;
            const DrawnGround ground(terrain, shot);
            const size_t hidden_before = hidden;
            for (int b = 0; b < 60; ++b) {
                const Box box = some_box(random, terrain, shot);
                const float spread_px = random.next_below(2) * random.next_in(0.0f, 6.0f);
                if (!horizon.hidden(box, spread_px)) continue;
                ++hidden;
                for (vec3 place : places_in(box, 3)) {
                    const double to_m = double(spread_px / frustum.focal_px) *
                                        std::max(glm::dot(dvec3(frustum.forward), dvec3(place)), 0.0);
                    dvec3 point(place);
                    point += dvec3(frustum.right) * (to_m * double(random.next_in(-1, 1))) +
                             dvec3(frustum.up) *
                                 (to_m * double(random.next_below(2) ? 1.0f : random.next_in(-1, 1)));
                    if (!ground.on_picture(point)) continue;
                    ++rays;
                    ASSERT_TRUE(ground.covers(point))
                        << "round " << round << " frame " << frame << " box " << b << " at " << point.x << ' '
                        << point.y << ' ' << point.z;
                }
            }
            if (hidden == hidden_before) continue;
            deep_frames += ground.deepest_level >= 3;
            looking_down += shot.camera.pitch_rad < -1.2f;
        }
    }
    EXPECT_GT(hidden, 4000u);
    EXPECT_GT(rays, 40000u);
    EXPECT_GT(deep_frames, 50u);
    EXPECT_GT(looking_down, 20u);
}

bool hidden_by(const Terrain* terrain, const Shot& shot, const Box& box, float spread_px = 1.0f) {
    Horizon horizon;
    horizon.build(terrain, shot.camera.position_world, shot.frustum(), shot.error_px);
    return horizon.hidden(box, spread_px);
}

struct Found {
    size_t seen = 0, hidden = 0, found = 0;
};

// Of the boxes whose every place lies behind the ground, how many are found; and none of the others.
Found find_hidden(const FieldTerrain& terrain, const Shot& shot, const std::vector<Box>& boxes) {
    Horizon horizon;
    horizon.build(&terrain, shot.camera.position_world, shot.frustum(), shot.error_px);
    const DrawnGround ground(terrain, shot);
    Found count;
    for (const Box& box : boxes) {
        bool in_view = false, seen = false;
        for (vec3 place : places_in(box, 4)) {
            if (!ground.on_picture(dvec3(place))) continue;
            in_view = true;
            seen = seen || !ground.covers(dvec3(place));
        }
        const bool found = horizon.hidden(box, 1.0f);
        EXPECT_FALSE(found && seen);
        count.seen += seen;
        if (!in_view || seen) continue;
        ++count.hidden;
        count.found += found;
    }
    return count;
}

// side_m wide and deep, and standing on the ground.
std::vector<Box> stand_boxes(const FieldTerrain& terrain, const Shot& shot, float side_m, float height_m,
                             float x_begin, float x_end) {
    std::vector<Box> boxes;
    const float reach_m = -terrain.layout().corner_local.y - side_m;
    for (float x = x_begin; x < x_end; x += 1.3f * side_m)
        for (float z = -reach_m; z < reach_m; z += 1.3f * side_m) {
            Box box;
            for (float i : {0.0f, 0.5f, 1.0f})
                for (float j : {0.0f, 0.5f, 1.0f}) {
                    const vec3 foot(x + i * side_m, terrain.height_at(x + i * side_m, z + j * side_m),
                                    z + j * side_m);
                    box.include(foot);
                    box.include(foot + vec3(0, height_m, 0));
                }
            const vec3 camera = vec3(shot.camera.position_world);
            boxes.push_back({box.min - camera, box.max - camera});
        }
    return boxes;
}

Shot standing_at(const FieldTerrain& terrain, float x, float z, float yaw_rad, float above_m = 1.7f) {
    Shot shot;
    shot.camera.position_world = dvec3(x, terrain.height_at(x, z) + above_m, z);
    shot.camera.yaw_rad = yaw_rad;
    shot.width = 795;
    shot.height = 700;
    return shot;
}

TEST(Horizon, FindsMostOfWhatARidgeHides) {
    const FieldTerrain terrain(make_field(257, 257, 2.0f, [](float x, float z) {
        const float crest = 1.0f - std::fabs(x - 20.0f) / 70.0f;
        return 45.0f * std::max(crest, 0.0f) * (1.0f + 0.3f * fractal_noise(z / 60.0, x / 60.0, 4, 0.5f, 3)) +
               3.0f * fractal_noise(x / 40.0, z / 40.0, 4, 0.5f, 9);
    }));
    for (float above_m : {1.7f, 20.0f})
        for (float side_m : {7.0f, 12.0f, 32.0f}) {
            const Shot shot = standing_at(terrain, -120.0f, 10.0f, -0.5f * k_pi, above_m);
            const Found count =
                find_hidden(terrain, shot, stand_boxes(terrain, shot, side_m, 8.0f, 30.0f, 220.0f));
            EXPECT_GT(count.hidden, 10u);
            EXPECT_GE(double(count.found), 0.9 * double(count.hidden)) << above_m << ' ' << side_m;
        }
}

// Far away a column is wider than a block, and a gap in a wall narrower than a column.
TEST(Horizon, SeesThroughNarrowGaps) {
    const FieldTerrain terrain(make_field(385, 129, 1.0f, [](float x, float z) {
        const bool gap = std::fabs(z - 14.0f * std::round(z / 14.0f)) < 2.5f;
        return x > 150.0f && x < 160.0f && !gap ? 30.0f : 0.0f;
    }));
    size_t hidden = 0, seen = 0;
    for (float z : {-9.0f, 0.3f, 7.0f}) {
        Shot shot = standing_at(terrain, -180.0f, z, -0.5f * k_pi, 6.0f);
        shot.camera.vertical_fov_rad = 0.12f;  // pixels of millimetres
        shot.width = 8000;
        shot.height = 2000;
        const Found count =
            find_hidden(terrain, shot, stand_boxes(terrain, shot, 0.4f, 0.4f, 161.0f, 162.0f));
        const Found before =
            find_hidden(terrain, shot, stand_boxes(terrain, shot, 0.4f, 0.4f, 149.0f, 149.3f));
        hidden += count.found;
        seen += count.seen;
        EXPECT_EQ(before.found, 0u);
    }
    EXPECT_GT(hidden, 30u);
    EXPECT_GT(seen, 30u);
}

// Ground that rises and falls by a tree's height hides trees too.
TEST(Horizon, FindsMostOfWhatHillsHide) {
    GrowHeightsSettings hills;
    hills.size_m = 512.0f;
    hills.cell_m = 2.0f;
    hills.amplitude_m = 22.0f;
    hills.wavelength_m = 190.0f;
    hills.ridges = 0.3f;
    const FieldTerrain terrain(grow_heights(hills));
    Found sum;
    for (float yaw_rad : {-0.5f, 1.1f, 2.7f, 4.3f}) {
        const Shot shot = standing_at(terrain, 10.0f, -20.0f, yaw_rad);
        const Found count =
            find_hidden(terrain, shot, stand_boxes(terrain, shot, 6.0f, 6.0f, -240.0f, 230.0f));
        sum.hidden += count.hidden;
        sum.found += count.found;
    }
    EXPECT_GT(sum.hidden, 200u);
    EXPECT_GE(double(sum.found), 0.7 * double(sum.hidden));
}

FieldTerrain wall(dvec3 origin_world = dvec3(0.0)) {
    return FieldTerrain(
        make_field(129, 129, 1.0f, [](float x, float) { return x > 10.0f && x < 30.0f ? 40.0f : 0.0f; }),
        origin_world);
}

Shot towards_wall(dvec3 origin_world = dvec3(0.0)) {
    Shot shot;
    shot.camera.position_world = origin_world + dvec3(-20.0, 2.0, 0.5);
    shot.camera.yaw_rad = -0.5f * k_pi;  // along +x
    return shot;
}

constexpr Box k_behind_wall{vec3(55, -2, -6), vec3(62, 12, 6)};

// A ring of wall whose one gap begins at the picture's border: what shows in the outermost pixels counts as well.
TEST(Horizon, SeesTheBorderOfThePicture) {
    Random random(11);
    size_t shown = 0;
    for (int round = 0; round < 100; ++round) {
        Shot shot;
        shot.camera.position_world = dvec3(0.0, 2.0, 0.0);
        shot.camera.yaw_rad = random.next_in(-3.2f, 3.2f);
        shot.camera.pitch_rad = random.next_in(-0.25f, 0.05f);
        shot.camera.vertical_fov_rad = random.next_in(0.8f, 1.6f);
        const float side = round % 2 == 0 ? 1.0f : -1.0f;
        auto place_at = [&](float angle, float height_m) {
            const float azimuth = shot.camera.yaw_rad + side * angle;
            return vec3(-56.0f * portable_sin(azimuth), height_m, -56.0f * portable_cos(azimuth));
        };
        auto ring = [&](float gap_angle) {
            return FieldTerrain(make_field(121, 121, 1.0f, [&](float x, float z) {
                const float radius = std::sqrt(x * x + z * z);
                const float along =
                    glm::dot(vec2(x, z), vec2(place_at(gap_angle, 0).x, place_at(gap_angle, 0).z));
                const bool gap = along > 56.0f * radius * portable_cos(0.12f);
                return radius > 30.0f && radius < 42.0f && !gap ? 5.0f : 0.0f;
            }));
        };
        const FieldTerrain whole = ring(-k_pi);
        const DrawnGround whole_ground(whole, shot);
        float last = 0.0f;  // in the picture
        while (last < 2.0f && whole_ground.on_picture(dvec3(place_at(last + 0.002f, 0.0f)))) last += 0.002f;
        if (last < 0.2f) continue;
        const FieldTerrain terrain = ring(last + random.next_in(0.06f, 0.11f));
        Box box;
        for (float angle : {last, last - 0.15f})
            for (float height_m : {-2.5f, 0.0f}) box.include(place_at(angle, height_m));
        EXPECT_TRUE(hidden_by(&whole, shot, box));
        if (DrawnGround(terrain, shot).covers(dvec3(place_at(last, 0.0f)))) continue;
        ++shown;
        EXPECT_FALSE(hidden_by(&terrain, shot, box)) << round;
    }
    EXPECT_GT(shown, 20u);
}

TEST(Horizon, WhatStandsBeforeOrAboveIsNotHidden) {
    const FieldTerrain terrain = wall();
    const Shot shot = towards_wall();
    EXPECT_TRUE(hidden_by(&terrain, shot, k_behind_wall));
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(20, -2, -6), vec3(28, 12, 6)}));    // before it
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(20, -2, -6), vec3(62, 12, 6)}));    // on both sides
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(55, -2, -6), vec3(62, 90, 6)}));    // rises above
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(-62, -2, -6), vec3(-55, 12, 6)}));  // behind the viewer
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(-1, -1, -1), vec3(1, 1, 1)}));      // around the viewer
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(-70, -60, -70), vec3(70, 60, 70)}));
    EXPECT_FALSE(hidden_by(&terrain, shot, k_behind_wall, 400.0f));  // its splats reach over
}

TEST(Horizon, WithoutGroundToGoByNothingIsHidden) {
    Shot shot = towards_wall();
    EXPECT_FALSE(hidden_by(nullptr, shot, k_behind_wall));
    const FieldTerrain terrain = wall();
    EXPECT_FALSE(hidden_by(&terrain, shot, Box{}));
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(55, NAN, -6), vec3(62, 12, 6)}));
    EXPECT_FALSE(hidden_by(&terrain, shot, {vec3(55, -2, -6), vec3(INFINITY, 12, 6)}));
    for (dvec3 moved : {dvec3(0, -2.5, 0), dvec3(0, -50, 0), dvec3(-200, 0, 0), dvec3(-200, 500, 0),
                        dvec3(-1e7, 0, 1e7), dvec3(NAN, 0, 0), dvec3(0, NAN, 0), dvec3(0, INFINITY, 0)}) {
        Shot elsewhere = shot;
        elsewhere.camera.position_world += moved;
        const vec3 back = vec3(moved);
        EXPECT_FALSE(hidden_by(&terrain, elsewhere, {k_behind_wall.min - back, k_behind_wall.max - back}))
            << moved.x << ' ' << moved.y << ' ' << moved.z;
    }
    shot.camera.near_m = 2.5f;  // cuts the ground at the viewer's feet
    EXPECT_FALSE(hidden_by(&terrain, shot, k_behind_wall));
}

TEST(Horizon, NoTreeOnAPlainIsHidden) {
    const FieldTerrain terrain(make_field(129, 97, 4.0f, [](float, float) { return 12.5f; }));
    for (float above_m : {0.5f, 2.0f, 100.0f}) {
        const Shot shot = standing_at(terrain, 3.0f, 5.0f, 0.7f, above_m);
        for (const Box& box : stand_boxes(terrain, shot, 7.0f, 1.0f, -240.0f, 230.0f))
            ASSERT_FALSE(hidden_by(&terrain, shot, box));
    }
    // What is buried is.
    const Shot shot = standing_at(terrain, 3.0f, 5.0f, 0.0f, 30.0f);
    EXPECT_TRUE(hidden_by(&terrain, shot, {vec3(-4, -70, -60), vec3(4, -50, -50)}));
}

TEST(Horizon, TheSameFarFromTheOrigin) {
    const dvec3 far(1e7, -4096.0, -1e7);
    const FieldTerrain here = wall(), there = wall(far);
    const Shot shot_here = towards_wall(), shot_there = towards_wall(far);
    Random random(5);
    size_t hidden = 0;
    for (int i = 0; i < 300; ++i) {
        const Box box = some_box(random, here, shot_here);
        const bool is_hidden = hidden_by(&here, shot_here, box);
        hidden += is_hidden;
        ASSERT_EQ(is_hidden, hidden_by(&there, shot_there, box));
    }
    EXPECT_GT(hidden, 20u);
}

TEST(Horizon, WarmFramesAllocateNothing) {
    const FieldTerrain terrain = wall();
    Horizon horizon;
    Shot shot = towards_wall();
    horizon.build(&terrain, shot.camera.position_world, shot.frustum(), 1.0f);
    const size_t before = test::g_allocation_count;
    bool any = false;
    for (int i = 0; i < 50; ++i) {
        shot.camera.position_world.x = -60.0 + i;
        shot.camera.yaw_rad += 0.13f;
        horizon.build(&terrain, shot.camera.position_world, shot.frustum(), 1.0f);
        const vec3 back(i - 40.0f, 0.0f, 0.0f);  // from where towards_wall stands
        any |= horizon.hidden({k_behind_wall.min - back, k_behind_wall.max - back}, 1.0f);
    }
    EXPECT_EQ(test::g_allocation_count, before);
    EXPECT_TRUE(any);
}

}  // namespace
}  // namespace coppice
