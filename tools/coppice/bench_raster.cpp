#include "tools/coppice/bench_raster.h"

#include <algorithm>
#include <bit>
#include <vector>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/draw/rasteriser.h"
#include "runtime/core/random.h"
#include "tools/coppice/figure.h"

namespace coppice {
namespace {

constexpr uint32_t k_width = 1280, k_height = 720;
constexpr int k_warm_frames = 3, k_frames = 21;

struct Case {
    const char* name;
    const char* pass;  // whose time counts; big triangles are added to triangles
    WorkKind kind;
    uint32_t count;
    float size_px;       // length of a line, side of an equilateral triangle or of a square leaf
    double reach_per_s;  // 0: for information
};

// Primitives of the wanted size on the screen, everywhere in the picture, in no order, 5 to 200 m away.
std::vector<PackedVertex> make_vertices(const Case& test, float focal_px) {
    std::vector<PackedVertex> vertices;
    Random random(1, uint64_t(test.kind) * 1000 + uint64_t(test.size_px * 10.0f));
    auto push = [&vertices, &random](vec3 p) {
        vertices.push_back({p.x, p.y, p.z, uint32_t(random.next_bits())});
    };
    for (uint32_t i = 0; i < test.count; ++i) {
        float z = random.next_in(5.0f, 200.0f);
        float to_m = z / focal_px;
        vec3 center(random.next_in(-0.5f, 0.5f) * float(k_width) * to_m,
                    random.next_in(-0.5f, 0.5f) * float(k_height) * to_m, -z);
        float turn = random.next_in(0.0f, 2.0f * k_pi);
        auto around = [&](float angle, float radius_px) {
            return center +
                   vec3(portable_cos(turn + angle), portable_sin(turn + angle), 0.0f) * (radius_px * to_m);
        };
        if (test.kind == WorkKind::lines) {
            push(around(0.0f, test.size_px * 0.5f));
            push(around(k_pi, test.size_px * 0.5f));
            vertices.back().surface = std::bit_cast<uint32_t>(1.0f);  // its width over the mean
        } else if (test.kind == WorkKind::triangles) {
            for (int v = 0; v < 3; ++v)
                push(around(float(v) * 2.0f * k_pi / 3.0f, test.size_px * 0.57735027f));
        } else {
            push(center);
        }
    }
    return vertices;
}

// Square leaves that face the viewer, as a packed plant has them: in steps of a grid, here of 1 / 65535 of a picture that
// lies at one distance.
std::vector<PackedVertex> make_leaves(const Case& test, float focal_px) {
    constexpr float k_distance_m = 50.0f;
    const float to_m = k_distance_m / focal_px, step_m = float(k_width) * to_m / 65535.0f;
    std::vector<PackedVertex> vertices{
        {-0.5f * float(k_width) * to_m, -0.5f * float(k_height) * to_m, -k_distance_m, 0},
        {step_m, step_m, step_m, 0}};
    Random random(1, uint64_t(test.kind) * 1000 + uint64_t(test.size_px * 10.0f));
    for (uint32_t i = 0; i < test.count; ++i) {
        const float turn = random.next_in(0.0f, 2.0f * k_pi);
        const vec2 center(random.next_in(20.0f, float(k_width) - 20.0f), random.next_in(20.0f, float(k_height) - 20.0f));
        PackedLeaf leaf{{}, uint32_t(random.next_bits()), 0};
        for (size_t k = 0; k < 4; ++k) {
            const float angle = turn + 0.5f * k_pi * float(k);
            const vec2 corner = center + vec2(portable_cos(angle), portable_sin(angle)) * (test.size_px * 0.70710678f);
            leaf.corners[3 * k] = uint16_t(corner.x * to_m / step_m);
            leaf.corners[3 * k + 1] = uint16_t(corner.y * to_m / step_m);
        }
        for (const PackedVertex& texel : std::bit_cast<std::array<PackedVertex, 2>>(leaf)) vertices.push_back(texel);
    }
    return vertices;
}

void add_entries(const Case& test, WorkPart& work) {
    const uint32_t index = work.add_instance({});
    PartChoice choice;
    choice.splat_px = choice.line_width_px = 1.0f;
    if (test.kind == WorkKind::points_2) choice.splat_px = 1.4f;
    (test.kind == WorkKind::lines       ? choice.lines
     : test.kind == WorkKind::triangles ? choice.triangles
     : test.kind == WorkKind::leaves    ? choice.leaves
                                        : choice.points) = test.count;
    PartGeometry geometry{};
    geometry.leaves = {test.count, test.count};
    work.add(geometry, choice, index);
}

double median(std::vector<double>& values) {
    std::nth_element(values.begin(), values.begin() + ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

}  // namespace

Result<nlohmann::json> bench_raster(const std::string& device_choice) {
    gpu::DeviceSettings settings;
    settings.choice = device_choice;
    COPPICE_TRY(auto device, gpu::Device::create(settings));
    FrameGraph graph;
    COPPICE_TRY(auto rasteriser, Rasteriser::create(*device, graph, 1, k_width, k_height));
    COPPICE_TRY(gpu::CommandRing ring, gpu::CommandRing::create(*device, 1));

    const float triangle_05 = 1.0745699f, triangle_4 = 3.0393427f, triangle_16 = 6.0786854f,
                triangle_65 = 12.2519f,
                triangle_900 = 45.590141f;  // sides in px
    const Case cases[] = {
        {"points of 1 px", "points 1 px", WorkKind::points_1, 1'000'000, 1.0f, 70.0e6},
        {"points of 1.4 px", "points 2 px", WorkKind::points_2, 1'000'000, 1.4f, 0.0},
        {"lines of 2 px", "lines", WorkKind::lines, 1'000'000, 2.0f, 25.0e6},
        {"lines of 6.6 px", "lines", WorkKind::lines, 1'000'000, 6.6f, 0.0},
        {"triangles of 0.5 px2", "triangles", WorkKind::triangles, 1'000'000, triangle_05, 25.0e6},
        {"triangles of 4 px2", "triangles", WorkKind::triangles, 1'000'000, triangle_4, 0.0},
        {"triangles of 16 px2", "triangles", WorkKind::triangles, 1'000'000, triangle_16, 0.0},
        {"triangles of 65 px2", "triangles", WorkKind::triangles, 200'000, triangle_65, 0.0},
        {"triangles of 900 px2", "triangles", WorkKind::triangles, 20'000, triangle_900, 0.0},
        {"leaves of 4 px2", "leaves", WorkKind::leaves, 1'000'000, 2.0f, 0.0},
        {"leaves of 16 px2", "leaves", WorkKind::leaves, 1'000'000, 4.0f, 0.0},
    };
    Camera camera;
    camera.position_world = dvec3(0.0);
    float focal_px = make_frustum(camera, k_width, k_height).focal_px;
    nlohmann::json figures = nlohmann::json::array();
    std::vector<double> clear_ms, resolve_ms;
    for (const Case& test : cases) {
        std::vector<PackedVertex> vertices = test.kind == WorkKind::leaves ? make_leaves(test, focal_px)
                                                                           : make_vertices(test, focal_px);
        COPPICE_CHECK(rasteriser->set_geometry({vertices, {}}));
        WorkList work;
        work.begin(1);
        add_entries(test, work.part(0));
        WorkList::Layout layout = work.gather(rasteriser->instances(0), rasteriser->entries(0));
        std::vector<double> pass_ms;
        for (int frame = 0; frame < k_warm_frames + k_frames; ++frame) {
            COPPICE_TRY(auto recording, ring.begin());
            rasteriser->set_frame(0, layout, camera, Light{}, {});
            graph.record(recording.commands, recording.timestamps);
            COPPICE_CHECK(ring.submit());
            COPPICE_CHECK(ring.wait(recording.serial));
            if (frame <= k_warm_frames) continue;  // begin() reports the frame before
            double ms = 0.0;
            for (const auto& section : recording.timestamps->sections()) {
                std::string_view name = section.name;
                if (name == test.pass || (test.kind == WorkKind::triangles && name == "big triangles"))
                    ms += section.ms;
                if (name == "clear") clear_ms.push_back(section.ms);
                if (name == "resolve") resolve_ms.push_back(section.ms);
            }
            pass_ms.push_back(ms);
        }
        double ms = median(pass_ms);
        double per_s = ms > 0.0 ? double(test.count) / (ms * 1.0e-3) : 0.0;
        std::optional<double> reach;
        if (test.reach_per_s > 0.0) reach = test.reach_per_s * 1.0e-6;
        figures.push_back(to_json(Figure{test.name, per_s * 1.0e-6, "M/s", reach}));
    }
    figures.push_back(to_json(Figure{"clear", median(clear_ms), "ms", {}}));
    figures.push_back(to_json(Figure{"resolve", median(resolve_ms), "ms", {}}));
    return nlohmann::json{{"name", "raster"},   {"device", device->name}, {"width", k_width},
                          {"height", k_height}, {"frames", k_frames},     {"figures", figures}};
}

}  // namespace coppice
