#include "plugins/vegetation/eco/camera_path.h"

#include "runtime/core/random.h"
#include "tests/eco/scratch.h"

namespace coppice {
namespace {

std::vector<CameraKey> random_path(uint64_t seed) {
    Random random(seed);
    std::vector<CameraKey> path;
    double time = 0.0;
    for (int i = 0; i < 9; ++i) {
        CameraKey key{};
        key.time_s = time;
        time += double(random.next_in(0.5f, 5.0f));
        key.camera.position_world.x = double(random.next_in(-100, 100));
        key.camera.position_world.y = double(random.next_in(1, 20));
        key.camera.position_world.z = double(random.next_in(-100, 100));
        key.camera.yaw_rad = random.next_in(-9, 9);
        key.camera.pitch_rad = random.next_in(-1, 1);
        path.push_back(key);
    }
    return path;
}

TEST(CameraPathText, IsReadBackAsItWas) {
    std::vector<CameraKey> path = random_path(4);
    path[3].camera.vertical_fov_rad = 0.5f;
    path[3].camera.near_m = 0.25f;
    path[5].camera.pitch_rad = k_pi / 2.0f;
    path[6].camera.yaw_rad = 4000.0f;  // someone who turned round and round
    const ScratchFile file("path.json", camera_path_text(path));
    const auto again = load_camera_path(file.path());
    ASSERT_TRUE(again) << to_string(again.error());
    ASSERT_EQ(again->size(), path.size());
    for (size_t i = 0; i < path.size(); ++i) {
        const Camera &a = (*again)[i].camera, &b = path[i].camera;
        EXPECT_EQ((*again)[i].time_s, path[i].time_s);
        EXPECT_EQ(a.position_world, b.position_world);
        EXPECT_LT(glm::length(a.forward() - b.forward()), 1e-3f) << i;
        EXPECT_NEAR(a.vertical_fov_rad, b.vertical_fov_rad, 1e-6f);
        EXPECT_EQ(a.near_m, b.near_m);
    }
}

TEST(CameraAt, PassesTheKeysAndHoldsTheEnds) {
    auto path = random_path(1);
    for (const CameraKey& key : path) {
        Camera camera = camera_at(path, key.time_s);
        EXPECT_LT(glm::length(camera.position_world - key.camera.position_world), 1e-9);
        EXPECT_NEAR(portable_sin(camera.yaw_rad), portable_sin(key.camera.yaw_rad), 1e-5f);
        EXPECT_NEAR(portable_cos(camera.yaw_rad), portable_cos(key.camera.yaw_rad), 1e-5f);
        EXPECT_FLOAT_EQ(camera.pitch_rad, key.camera.pitch_rad);
    }
    EXPECT_EQ(camera_at(path, -5.0).position_world, path.front().camera.position_world);
    EXPECT_EQ(camera_at(path, 1e9).position_world, path.back().camera.position_world);
    EXPECT_EQ(camera_at(path, NAN).position_world, path.front().camera.position_world);
}

TEST(CameraAt, SpeedHasNoSteps) {
    for (uint64_t seed = 1; seed < 20; ++seed) {
        auto path = random_path(seed);
        double h = 1e-5;
        for (size_t k = 1; k + 1 < path.size(); ++k) {
            double t = path[k].time_s;
            dvec3 before = (camera_at(path, t).position_world - camera_at(path, t - h).position_world) / h;
            dvec3 after = (camera_at(path, t + h).position_world - camera_at(path, t).position_world) / h;
            ASSERT_LT(glm::length(after - before), 0.02);
        }
    }
}

TEST(CameraAt, StaysBetweenItsKeysAndTurnsTheShortWay) {
    for (uint64_t seed = 1; seed < 20; ++seed) {
        auto path = random_path(seed);
        for (size_t k = 0; k + 1 < path.size(); ++k) {
            double low = std::min(path[k].camera.position_world.y, path[k + 1].camera.position_world.y);
            double high = std::max(path[k].camera.position_world.y, path[k + 1].camera.position_world.y);
            float last = camera_at(path, path[k].time_s).yaw_rad, turned = 0.0f;
            for (int i = 1; i < 50; ++i) {
                Camera camera =
                    camera_at(path, path[k].time_s + (path[k + 1].time_s - path[k].time_s) * i / 50.0);
                ASSERT_TRUE(camera.position_world.y >= low - 1e-9 && camera.position_world.y <= high + 1e-9);
                turned += std::fabs(camera.yaw_rad - last);
                last = camera.yaw_rad;
            }
            ASSERT_LE(turned, k_pi + 1e-3f);
        }
    }
}

TEST(LoadCameraPath, ReadsPlacesAnglesAndTargets) {
    ScratchFile file("path.json", R"({"keys": [
        {"time_s": 0, "at": [1, 2, 3], "yaw_deg": 90, "pitch_deg": -45, "fov_deg": 90},
        {"time_s": 2, "at": [10, 20], "above_m": 5, "look_at": [10, 5, -80]}]})");
    auto path = load_camera_path(file.path());
    ASSERT_TRUE(path) << to_string(path.error());
    ASSERT_EQ(path->size(), 2u);
    EXPECT_EQ((*path)[0].camera.position_world, dvec3(1, 2, 3));
    EXPECT_NEAR((*path)[0].camera.forward().x, -portable_cos(k_pi / 4), 1e-5f);
    EXPECT_NEAR((*path)[0].camera.vertical_fov_rad, k_pi / 2, 1e-5f);
    EXPECT_EQ((*path)[1].camera.position_world, dvec3(10, 5, 20));
    EXPECT_NEAR((*path)[1].camera.forward().z, -1.0f, 1e-5f);
}

TEST(LoadCameraPath, EveryFaultOnce) {
    struct Case {
        const char* text;
        ErrorId id;
        const char* place;
    };
    for (const Case& bad : std::initializer_list<Case>{
             {"{", ErrorId::syntax, "line 1, column 2"},
             {"{}", ErrorId::syntax, "keys"},
             {R"({"keys": []})", ErrorId::syntax, "keys"},
             {R"({"keys": [{"at": [0, 0]}]})", ErrorId::syntax, "keys[0].time_s"},
             {R"({"keys": [{"time_s": 0}]})", ErrorId::syntax, "keys[0].at"},
             {R"({"keys": [{"time_s": 0, "at": [0, 0], "yaw": 3}]})", ErrorId::name_unknown, "keys[0]"},
             {R"({"keys": [{"time_s": 0, "at": [0, 0], "fov_deg": 0}]})", ErrorId::value_out_of_range,
              "keys[0].fov_deg"},
             {R"({"keys": [{"time_s": 1, "at": [0, 0]}, {"time_s": 1, "at": [0, 0]}]})",
              ErrorId::value_out_of_range, "keys[1].time_s"},
         }) {
        ScratchFile file("bad.json", bad.text);
        auto path = load_camera_path(file.path());
        ASSERT_FALSE(path) << bad.text;
        EXPECT_EQ(path.error().id, bad.id) << bad.text << to_string(path.error());
        EXPECT_EQ(path.error().place, bad.place) << bad.text << to_string(path.error());
    }
    EXPECT_EQ(load_camera_path("nowhere.json").error().id, ErrorId::file_missing);
}

}  // namespace
}  // namespace coppice
