#include "plugins/vegetation/eco/camera_path.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include "plugins/shared/region.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "runtime/core/file.h"

namespace coppice {
namespace {

// What a path interpolates: x, y, z, yaw, pitch, field of view, near.
using Pose = std::array<double, 7>;

Pose pose_of(const Camera& camera) {
    return {camera.position_world.x, camera.position_world.y,  camera.position_world.z,
            double(camera.yaw_rad),  double(camera.pitch_rad), double(camera.vertical_fov_rad),
            double(camera.near_m)};
}

// Yaws follow each other by the shorter way round.
double unwind(double yaw, double before) {
    double turns = (yaw - before) / (2.0 * 3.14159265358979323846);
    return yaw - std::floor(turns + 0.5) * (2.0 * 3.14159265358979323846);
}

// Slope at a key between two secants: zero at a turning point, never so steep that the cubic leaves the range
// of its keys (Fritsch and Butland's weighted harmonic mean).
double key_slope(double secant_before, double secant_after, double span_before, double span_after) {
    if (secant_before * secant_after <= 0.0) return 0.0;
    double w1 = 2.0 * span_after + span_before, w2 = span_after + 2.0 * span_before;
    return (w1 + w2) / (w1 / secant_before + w2 / secant_after);
}

CameraKey read_key(JsonObject object, const GroundHeight& ground) {
    constexpr float k_radians = k_pi / 180.0f;
    CameraKey key{};
    key.time_s = object.number("time_s", 0.0, 1e6);
    Camera& camera = key.camera;
    auto read_place = [&](const char* at_name, const char* above_name, double above_otherwise) {
        const nlohmann::json* at = object.find(at_name);
        if (at && at->is_array() && at->size() == 2) {
            auto xz = object.numbers(at_name, 2, -k_farthest_m, k_farthest_m);
            return dvec3(xz[0], ground(xz[0], xz[1]) + object.number(above_name, -1e5, 1e5, above_otherwise),
                         xz[1]);
        }
        auto xyz = object.numbers(at_name, 3, -k_farthest_m, k_farthest_m);
        return dvec3(xyz[0], xyz[1], xyz[2]);
    };
    camera.position_world = read_place("at", "above_m", 1.7);
    camera.vertical_fov_rad = object.real("fov_deg", 1.0f, 170.0f, 60.0f) * k_radians;
    camera.near_m = object.real("near_m", 0.001f, 100.0f, 0.1f);
    if (object.has("look_at")) {
        vec3 way(read_place("look_at", "look_above_m", 1.7) - camera.position_world);
        camera.yaw_rad = portable_atan2(-way.x, -way.z);
        camera.pitch_rad = portable_atan2(way.y, std::sqrt(way.x * way.x + way.z * way.z));
    } else {
        camera.yaw_rad = object.real("yaw_deg", -36000.0f, 36000.0f, 0.0f) * k_radians;
        camera.pitch_rad = object.real("pitch_deg", -90.0f, 90.0f, 0.0f) * k_radians;
    }
    object.close();
    return key;
}

}  // namespace

Camera camera_at(const std::vector<CameraKey>& path, double time_s) {
    if (path.empty()) return {};
    if (!(time_s > path.front().time_s)) return path.front().camera;
    if (time_s >= path.back().time_s) return path.back().camera;
    auto after = std::upper_bound(path.begin(), path.end(), time_s,
                                  [](double time, const CameraKey& key) { return time < key.time_s; });
    size_t i = size_t(after - path.begin()) - 1;  // keys[i].time_s <= time_s < keys[i + 1].time_s

    // The keys i - 1 to i + 2, where there are such.
    size_t first = i > 0 ? i - 1 : 0, last = std::min(i + 2, path.size() - 1);
    std::array<Pose, 4> pose;
    std::array<double, 4> time;
    for (size_t k = first; k <= last; ++k) {
        pose[k - first] = pose_of(path[k].camera);
        time[k - first] = path[k].time_s;
        if (k > first) pose[k - first][3] = unwind(pose[k - first][3], pose[k - first - 1][3]);
    }
    size_t a = i - first, b = a + 1;
    double span = time[b] - time[a], t = (time_s - time[a]) / span;
    double h10 = t * (1.0 - t) * (1.0 - t), h11 = t * t * (t - 1.0), h01 = t * t * (3.0 - 2.0 * t);
    Pose out;
    for (size_t c = 0; c < out.size(); ++c) {
        double secant = (pose[b][c] - pose[a][c]) / span, slope_a = secant, slope_b = secant;
        if (a > 0) {
            double before = time[a] - time[a - 1];
            slope_a = key_slope((pose[a][c] - pose[a - 1][c]) / before, secant, before, span);
        }
        if (b < last - first) {
            double next = time[b + 1] - time[b];
            slope_b = key_slope(secant, (pose[b + 1][c] - pose[b][c]) / next, span, next);
        }
        out[c] = pose[a][c] + h01 * (pose[b][c] - pose[a][c]) + (h10 * slope_a + h11 * slope_b) * span;
    }
    Camera camera;
    camera.position_world = dvec3(out[0], out[1], out[2]);
    camera.yaw_rad = float(out[3]);
    camera.pitch_rad = float(out[4]);
    camera.vertical_fov_rad = float(out[5]);
    camera.near_m = float(out[6]);
    return camera;
}

std::vector<CameraKey> read_camera_keys(std::vector<JsonObject> objects, const GroundHeight& ground) {
    std::vector<CameraKey> keys;
    if (objects.empty()) return keys;
    JsonDocument& document = objects.front().document();
    for (size_t i = 0; i < std::min(objects.size(), k_key_limit); ++i) {
        keys.push_back(read_key(objects[i], ground));
        if (i > 0 && !(keys[i].time_s > keys[i - 1].time_s))
            document.report(ErrorId::value_out_of_range, objects[i].place_of("time_s"),
                            fmt::format("{:g} s after {:g} s", keys[i].time_s, keys[i - 1].time_s),
                            "times that grow from key to key");
    }
    if (objects.size() > k_key_limit)
        document.report(ErrorId::limit_exceeded, objects[k_key_limit].place_of("time_s"), "too many keys",
                        fmt::format("at most {}", k_key_limit));
    return keys;
}

Result<std::vector<CameraKey>> load_camera_path(const std::string& path, const GroundHeight& ground) {
    COPPICE_TRY(std::string text, read_text_file(path));
    COPPICE_TRY(JsonDocument document, JsonDocument::parse(text, path));
    JsonObject root(document, document.root(), "");
    std::vector<CameraKey> keys = read_camera_keys(root.objects("keys"), ground);
    root.close();
    if (keys.empty()) root.report(ErrorId::syntax, "keys", "no key", "write at least one key");
    COPPICE_CHECK(document.status());
    return keys;
}

std::string camera_path_text(const std::vector<CameraKey>& keys) {
    constexpr double k_degrees = 180.0 / 3.14159265358979323846;
    nlohmann::json list = nlohmann::json::array();
    for (const CameraKey& key : keys) {
        const Camera& camera = key.camera;
        const dvec3& at = camera.position_world;
        list.push_back({{"time_s", key.time_s},
                        {"at", {at.x, at.y, at.z}},
                        {"yaw_deg", std::remainder(camera.yaw_rad * k_degrees, 360.0)},
                        {"pitch_deg", std::clamp(camera.pitch_rad * k_degrees, -90.0, 90.0)},
                        {"fov_deg", camera.vertical_fov_rad * k_degrees},
                        {"near_m", camera.near_m}});
    }
    return nlohmann::json{{"keys", std::move(list)}}.dump(1) + "\n";
}

Result<std::vector<CameraKey>> read_camera_path(JsonObject& root, const std::filesystem::path& folder,
                                                const GroundHeight& ground) {
    const nlohmann::json* value = root.find("camera_path");
    if (value && value->is_string())
        return load_camera_path((folder / value->get<std::string>()).lexically_normal().string(), ground);
    std::vector<CameraKey> keys;
    if (value) keys = read_camera_keys(root.objects("camera_path"), ground);
    COPPICE_CHECK(root.document().status());
    if (keys.empty()) {
        Camera camera;
        camera.position_world.y += ground(0.0, 0.0);
        keys.push_back({0.0, camera});
    }
    return keys;
}

Result<std::vector<CameraKey>> load_camera_path(const std::string& path, const Terrain* terrain) {
    return load_camera_path(path, height_of(terrain));
}

}  // namespace coppice
