// Nested maps: which are due, and where they lie.
#include "plugins/vegetation/shadow/clipmap.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "runtime/core/random.h"

namespace coppice {
namespace {

ClipmapFrame frame_at(dvec3 camera_world, dvec3 scene_world = dvec3(0.0)) {
    ClipmapFrame frame{};
    frame.camera_world = camera_world;
    frame.origin_world = dvec3(100, 0, -300);
    frame.to_sun = normalize_or(vec3(0.4f, 0.7f, -0.2f), vec3(0, 1, 0));
    frame.focal_px = 606.0f;
    frame.nearest_m = 0.5f;
    frame.far_m = 700.0f;
    const dvec3 scene_camera = scene_world - camera_world;
    frame.bounds_camera = {vec3(scene_camera + dvec3(-500, -30, -500)),
                           vec3(scene_camera + dvec3(500, 60, 500))};
    frame.side_texels = Clipmap::side_for(frame.focal_px, 1u << 27);
    return frame;
}

size_t commit(Clipmap& maps, Clipmap::Drawn drawn = Clipmap::Drawn::whole) {
    const size_t count = maps.due().size();
    maps.commit(std::vector<Clipmap::Drawn>(count, drawn));
    return count;
}

vec3 texel_of(const ShadowView& view, vec3 p) {
    return {glm::dot(view.row_x, vec4(p, 1)), glm::dot(view.row_y, vec4(p, 1)),
            glm::dot(view.row_z, vec4(p, 1))};
}

TEST(Clipmap, HasPlacesWithinWhatTheDeviceTakes) {
    for (float focal_px : {1.0f, 300.0f, 606.0f, 2000.0f, 1e9f})
        for (uint64_t most_bytes : {uint64_t(0), uint64_t(1) << 27, uint64_t(1) << 32}) {
            const uint64_t side = Clipmap::side_for(focal_px, most_bytes);
            EXPECT_EQ(side % 64, 0u);
            EXPECT_GE(side, 128u);
            EXPECT_LE(side, 4096u);
            if (most_bytes > 0) {
                EXPECT_LE(side * side * 4 * k_shadow_map_places, most_bytes);
            }
        }
    EXPECT_EQ(Clipmap::side_for(606.0f, 1u << 27), 768u);
}

// From the nearest that is seen to the farthest, as far as there are places.
TEST(Clipmap, ReachesFromTheNearestToTheFarthest) {
    for (float near_m : {0.0f, 1e-4f, 0.3f, 50.0f, INFINITY})
        for (float far_m : {0.0f, 1e-3f, 1.0f, 300.0f, 1e5f, INFINITY}) {
            Clipmap maps;
            ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
            frame.nearest_m = near_m;
            frame.far_m = far_m;
            maps.update(frame);
            ASSERT_LE(maps.first(), maps.last());
            ASSERT_LT(maps.last(), k_shadow_map_count);
            ASSERT_LE(maps.last() - maps.first(), k_shadow_map_places - 1);
            EXPECT_TRUE(maps.last() + 1 == k_shadow_map_count ||
                        Clipmap::reach_m(maps.last(), frame.side_texels) >= far_m);
            if (maps.last() - maps.first() < k_shadow_map_places - 1 && maps.first() > 0 && near_m <= far_m &&
                near_m < 1e5f) {
                EXPECT_LT(Clipmap::reach_m(maps.first() - 1, frame.side_texels), near_m);
                EXPECT_GE(Clipmap::reach_m(maps.first(), frame.side_texels), near_m);
            }
        }
}

// A map that takes another's place is made before it is seen.
TEST(Clipmap, PlacesAreOfOneMapAtATime) {
    Clipmap maps;
    ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    for (float scale : {1.0f, 1e-4f, 1e3f, 1.0f}) {
        frame.nearest_m = 0.5f * scale;
        frame.far_m = 700.0f * scale;
        maps.update(frame);
        EXPECT_FALSE(maps.due().empty());
        commit(maps);
        maps.update(frame);
        for (uint32_t map = maps.first(); map <= maps.last(); ++map) {
            const double texel_m = 1.0 / glm::length(dvec3(vec3(maps.view(map, frame.camera_world).row_x)));
            EXPECT_NEAR(texel_m, Clipmap::texel_m(map), 1e-5 * texel_m);
        }
        EXPECT_TRUE(maps.due().empty());
    }
}

TEST(Clipmap, AllNeededAreDueAtOnceAndThenNone) {
    Clipmap maps;
    ClipmapFrame frame = frame_at(dvec3(1e6, 20, -3e5));
    maps.update(frame);
    EXPECT_EQ(maps.due().size(), maps.last() - maps.first() + 1);
    // Asked again before they are drawn, the same.
    const size_t due = maps.due().size();
    maps.update(frame);
    EXPECT_EQ(maps.due().size(), due);
    EXPECT_EQ(commit(maps), due);
    maps.update(frame);
    EXPECT_TRUE(maps.due().empty());
    maps.forget();
    maps.update(frame);
    EXPECT_EQ(maps.due().size(), due);
    // From far above no place is near enough for the first ones.
    const uint32_t first = maps.first();
    frame.nearest_m = 100.0f;
    maps.update(frame);
    EXPECT_GT(maps.first(), first + 3);
    frame.side_texels += 64;
    commit(maps);
    maps.update(frame);
    EXPECT_EQ(maps.due().size(), maps.last() - maps.first() + 1);
}

// Wherever the viewer goes and turns, every place within a map's reach lies inside it, and stays on its texel however often the map
// is made anew.
TEST(Clipmap, PlacesWithinReachAreInsideAndStayOnTheirTexels) {
    Random random(3);
    for (double away_m : {0.0, 1e5, 1e7}) {
        Clipmap maps;
        const dvec3 scene(away_m, 0.0, -away_m);
        dvec3 camera = scene + dvec3(0.0, 5.0, 0.0);
        dvec3 before = camera;
        for (int step = 0; step < 200; ++step) {
            camera += dvec3(random.next_in(-1, 2), random.next_in(-0.2f, 0.2f), random.next_in(-1, 1)) * 0.3;
            ClipmapFrame frame = frame_at(camera, scene);
            frame.motion_m = vec3(camera - before) * 30.0f;
            before = camera;
            maps.update(frame);
            commit(maps);
            ASSERT_LE(maps.first(), maps.last());
            const float side = float(frame.side_texels);
            for (uint32_t map = maps.first(); map <= maps.last(); ++map) {
                const ShadowView view = maps.view(map, camera);
                const float reach = Clipmap::reach_m(map, frame.side_texels);
                for (int i = 0; i < 4; ++i) {
                    const vec3 direction = normalize_or(
                        vec3(random.next_in(-1, 1), random.next_in(-1, 1), random.next_in(-1, 1)),
                        vec3(0, 1, 0));
                    const vec3 at = texel_of(view, direction * reach);
                    ASSERT_TRUE(at.x >= 1 && at.y >= 1 && at.x <= side - 1 && at.y <= side - 1)
                        << map << ": " << at.x << ' ' << at.y << " of " << side;
                }
                // The texel's corners lie at whole multiples of its size from the origin.
                const vec3 axis_x = vec3(view.row_x) * Clipmap::texel_m(map);
                const double world =
                    glm::dot(dvec3(axis_x), camera - dvec3(100, 0, -300)) / Clipmap::texel_m(map);
                const double offset = double(view.row_x.w) - world;
                if (away_m == 0.0) {
                    EXPECT_NEAR(offset, std::round(offset), 0.02) << map;
                }
            }
        }
    }
}

// In flight maps are made one by one, before places lack them; a fast viewer does without the finest.
TEST(Clipmap, FlightsMakeMapsOneByOne) {
    for (double speed_m : {0.02, 0.3, 5.0, 100.0}) {
        Clipmap maps;
        dvec3 camera(0.0, 2.0, 0.0);
        size_t made = 0, most = 0;
        for (int step = 0; step < 600; ++step) {
            ClipmapFrame frame = frame_at(camera);
            frame.motion_m = vec3(float(speed_m) * 30.0f, 0, 0);
            maps.update(frame);
            const size_t now = commit(maps);
            if (step > 0) {
                made += now;
                most = std::max(most, now);
            }
            camera.x += speed_m;
        }
        EXPECT_LE(most, 2u) << speed_m;
        EXPECT_LE(made, 200u) << speed_m;
        EXPECT_GT(made, 2u) << speed_m;
    }
}

TEST(Clipmap, AMovingSunMakesMapsOneByOneAndAJumpAll) {
    Clipmap maps;
    ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    maps.update(frame);
    const size_t all = commit(maps);
    // A day in 20 minutes at 60 Hz.
    float angle = 0.5f;
    for (int step = 0; step < 300; ++step) {
        angle += 2.0f * 3.14159265f / (20 * 60 * 60);
        frame.to_sun = vec3(std::cos(angle), std::sin(angle), 0);
        maps.update(frame);
        if (step == 0) {
            EXPECT_EQ(maps.due().size(), all);  // it was elsewhere
        } else {
            EXPECT_LE(maps.due().size(), 1u);
        }
        commit(maps);
        for (uint32_t map = maps.first(); map <= maps.last(); ++map) {
            const vec3 axis = vec3(maps.view(map, frame.camera_world).row_z);
            EXPECT_LT(glm::length(axis / glm::length(axis) - frame.to_sun), 0.01f);
        }
    }
    frame.to_sun = vec3(0, 1, 0);
    maps.update(frame);
    EXPECT_EQ(maps.due().size(), all);
}

TEST(Clipmap, WhatLackedTilesIsMadeAgainWhenSomeHaveBeenRead) {
    Clipmap maps;
    const ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    maps.update(frame);
    const size_t all = commit(maps, Clipmap::Drawn::lacking_tiles);
    maps.update(frame);
    EXPECT_TRUE(maps.due().empty());
    maps.note_arrivals();
    for (size_t i = 0; i < all; ++i) {
        maps.update(frame);
        EXPECT_EQ(commit(maps), 1u);
    }
    maps.note_arrivals();
    maps.update(frame);
    EXPECT_TRUE(maps.due().empty());
}

// While plants are changed in every frame each map has its turn.
TEST(Clipmap, ChangesReachEveryMapOneByOne) {
    Clipmap maps;
    const ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    maps.update(frame);
    const size_t all = commit(maps);
    std::vector<int> made(k_shadow_map_count);
    for (size_t i = 0; i < 3 * all; ++i) {
        maps.note_changes();
        maps.update(frame);
        ASSERT_EQ(maps.due().size(), 1u);
        ++made[maps.due()[0]];
        commit(maps);
    }
    for (uint32_t map = maps.first(); map <= maps.last(); ++map) EXPECT_EQ(made[map], 3) << map;
}

// Of changes that reach all of them the nearest are made first: they are what is looked at.
TEST(Clipmap, OfMapsAsOldTheNearestIsMadeFirst) {
    Clipmap maps;
    const ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    maps.update(frame);
    commit(maps);
    maps.note_changes();
    for (uint32_t map = maps.first(); map <= maps.last(); ++map) {
        maps.update(frame);
        ASSERT_EQ(maps.due().size(), 1u);
        EXPECT_EQ(maps.due()[0], map);
        commit(maps);
    }
}

// Where the lists have no room for all maps, those that found some are made, the others next, and no frame is stuck with all.
TEST(Clipmap, MapsThatFoundNoRoomStayDue) {
    Clipmap maps;
    const ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    maps.update(frame);
    const size_t all = maps.due().size();
    const std::vector<uint32_t> due(maps.due().begin(), maps.due().end());
    const std::vector<Clipmap::Drawn> whole(2, Clipmap::Drawn::whole);
    maps.commit(whole);
    maps.update(frame);
    ASSERT_EQ(maps.due().size(), all - 2);
    EXPECT_TRUE(std::equal(maps.due().begin(), maps.due().end(), due.begin() + 2));
    // One that was cut short is made once more, by and by.
    commit(maps, Clipmap::Drawn::cut);
    for (size_t i = 0; i < 2 * all; ++i) {
        maps.update(frame);
        EXPECT_EQ(maps.due().size(), 1u);
        EXPECT_TRUE(i > 0 || maps.due()[0] == due[2]);
        commit(maps, Clipmap::Drawn::cut);
    }
    for (size_t i = 0; i < all; ++i) {
        maps.update(frame);
        commit(maps);
    }
    maps.update(frame);
    EXPECT_TRUE(maps.due().empty());
}

// A first plant, or one that is higher than all before, lies beyond what depths there are.
TEST(Clipmap, WhatLeavesTheMapsDepthsMakesAllAnew) {
    Clipmap maps;
    ClipmapFrame frame = frame_at(dvec3(0, 2, 0));
    const Box all = frame.bounds_camera;
    frame.bounds_camera = {};
    maps.update(frame);
    commit(maps);
    maps.update(frame);
    EXPECT_TRUE(maps.due().empty());
    for (const Box& box :
         {all, Box{all.min, all.max + vec3(0, 50, 0)}, Box{all.min - vec3(0, 50, 0), all.max}}) {
        frame.bounds_camera = box;
        maps.update(frame);
        EXPECT_EQ(maps.due().size(), maps.last() - maps.first() + 1);
        commit(maps);
        for (uint32_t map = maps.first(); map <= maps.last(); ++map)
            for (vec3 corner : {box.min, box.max}) {
                const float depth = texel_of(maps.view(map, frame.camera_world), corner).z;
                EXPECT_TRUE(depth > 0.0f && depth < 0.5f) << depth;
            }
        frame.bounds_camera = {};
        maps.update(frame);
        EXPECT_TRUE(maps.due().empty());
        commit(maps);
    }
}

// A caster that shadows a place of the map lies in its column, however high it stands.
TEST(Clipmap, CastersOfAMapLieInItsColumn) {
    Clipmap maps;
    const ClipmapFrame frame = frame_at(dvec3(50, 2, 70));
    maps.update(frame);
    Random random(9);
    const Frustum view = make_frustum(Camera{}, 800, 700);
    for (uint32_t map : maps.due()) {
        const Frustum column = maps.casters(map, view, frame.camera_world, 3.0f);
        EXPECT_EQ(column.near_m, 3.0f);
        const ShadowView rows = maps.view(map, frame.camera_world);
        const float half_m = 0.5f * float(frame.side_texels) * Clipmap::texel_m(map);
        for (int i = 0; i < 200; ++i) {
            const vec3 p =
                vec3(random.next_in(-2, 2), random.next_in(-2, 2), random.next_in(-2, 2)) * half_m +
                frame.to_sun * random.next_in(0.0f, 100.0f);
            const vec3 at = texel_of(rows, p);
            const float side = float(frame.side_texels);
            const bool inside = at.x > 0 && at.y > 0 && at.x < side && at.y < side;
            if (inside) {
                EXPECT_TRUE(sees_sphere(column, p, 1e-3f * half_m));
            } else if (at.x < -2 || at.y < -2 || at.x > side + 2 || at.y > side + 2) {
                EXPECT_FALSE(sees_sphere(column, p, 1e-3f * half_m));
            }
        }
    }
}

// Whatever a host says, rows are finite.
TEST(Clipmap, AnyFrameGivesFiniteRows) {
    for (float far_m : {0.0f, 1e-6f, 1e9f, INFINITY})
        for (double away_m : {0.0, 1e12})
            for (vec3 to_sun : {vec3(0, 1, 0), vec3(0, -1, 0), vec3(1, 0, 0), vec3(0)}) {
                Clipmap maps;
                ClipmapFrame frame = frame_at(dvec3(away_m));
                frame.far_m = far_m;
                frame.nearest_m = far_m;
                frame.to_sun = to_sun;
                frame.motion_m = vec3(far_m < 1e10f ? far_m : 0.0f);
                frame.bounds_camera = {};
                maps.update(frame);
                commit(maps);
                for (uint32_t map = maps.first(); map <= maps.last(); ++map) {
                    const ShadowView view = maps.view(map, frame.camera_world);
                    for (const vec4& row : {view.row_x, view.row_y, view.row_z, view.row_w})
                        EXPECT_TRUE(std::isfinite(row.x + row.y + row.z + row.w));
                }
            }
}

}  // namespace
}  // namespace coppice
