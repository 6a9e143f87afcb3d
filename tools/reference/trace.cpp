// Rays go one by one. Embree's packets of 16 are a fifth faster, but only with vectors of 512 bits, whose arithmetic gives
// other bytes than that of 256. Packets that it is told are coherent are faster yet, but find others where triangles
// touch, and rtcOccluded16 was seen never to return (3.13.5).
#include "tools/reference/trace.h"

#include <algorithm>
#include <array>
#include <new>
#include <optional>
#include <string>
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/progress.h"
#include "tools/reference/light.h"

namespace coppice {
namespace {

constexpr uint32_t k_block_px = 16;  // side of what one job traces: rays that lie close meet the same boxes
constexpr uint32_t k_samples_limit = 1u << 16;
// A shadow ray starts this share of the viewing distance off the surface: far more than rounding moves a place by, and
// a hundredth of a pixel.
constexpr float k_shadow_offset = 1e-5f, k_shadow_offset_near_m = 4.0f;

// From places on the picture to rays, one metre along the view axis for each unit of their length.
struct Lens {
    vec3 right, up, forward;  // for a pixel, for a pixel, for a metre
    float middle_column, middle_row;

    Lens(const Camera& camera, uint32_t width, uint32_t height)
        : forward(camera.forward()), middle_column(0.5f * float(width)), middle_row(0.5f * float(height)) {
        const float half_rad = 0.5f * std::clamp(camera.vertical_fov_rad, 0.001f, 3.1f);
        const float meters_a_pixel = portable_sin(half_rad) / portable_cos(half_rad) / middle_row;
        right = camera.right() * meters_a_pixel;
        up = camera.up() * meters_a_pixel;
    }
    vec3 along(float column, float row) const {
        return forward + right * (column - middle_column) + up * (middle_row - row);
    }
};

// One picture in the making.
struct Shot {
    const RayGeometry& geometry;
    const RayView& view;
    Lens lens;
    float near_m;
    uint32_t samples_side;
};

// What samples of a pixel saw, in sum.
struct Samples {
    dvec3 shadowed{0.0}, unshadowed{0.0}, coverage{0.0};
};

// The mean of three corners' surfaces, weighed, in world space.
Surface blend_surfaces(const std::array<uint32_t, 3>& words, const std::array<float, 3>& weights,
                       const mat3& turn, vec3 face_normal) {
    Surface mean{vec3(0.0f), vec3(0.0f), 0.0f, false};
    for (int i = 0; i < 3; ++i) {
        const Surface corner = decode_surface(words[i]);
        mean.normal += corner.normal * weights[i];
        mean.color_linear += corner.color_linear * weights[i];
        mean.openness += corner.openness * weights[i];
        mean.leaf = corner.leaf;
    }
    mean.normal = normalize_or(turn * mean.normal, face_normal);
    return mean;
}

bool sees_sun(const Shot& shot, vec3 place, vec3 face, float distance_m) {
    const vec3 to_sun = shot.geometry.light().direction_to_sun;
    // From the sunny side of the surface: what is thin lets light through and must not shade itself.
    const float offset_m = k_shadow_offset * std::max(distance_m, k_shadow_offset_near_m);
    place += face * (glm::dot(face, to_sun) < 0.0f ? -offset_m : offset_m);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray{place.x,  place.y, place.z,  0.0f,       to_sun.x, to_sun.y,
               to_sun.z, 0.0f,    INFINITY, UINT32_MAX, 0,        0};
    rtcOccluded1(shot.view.tree.get(), &context, &ray);
    return ray.tfar >= 0.0f;
}

void add_surface(const Shot& shot, const RTCHit& hit, vec3 direction, Samples& samples) {
    const Light& light = shot.geometry.light();
    const RayInstance& instance = shot.view.instances[hit.instID[0]];
    const RayModel& model = shot.geometry.models()[instance.model];
    const size_t first = size_t(hit.primID) * 3;
    const float u = std::clamp(hit.u, 0.0f, 1.0f), v = std::clamp(hit.v, 0.0f, 1.0f - u);
    const std::array<float, 3> weights{1.0f - u - v, u, v};
    std::array<vec3, 3> corners;
    std::array<uint32_t, 3> words;
    vec3 place(0.0f);
    for (int i = 0; i < 3; ++i) {
        const PackedVertex& vertex = model.vertices[first + i];
        corners[i] = vec3(vertex.x_plant, vertex.y_plant, vertex.z_plant);
        words[i] = vertex.surface;
        place += corners[i] * weights[i];
    }
    place = instance.to_world(place);
    const vec3 face = normalize_or(
        instance.turn * glm::cross(corners[1] - corners[0], corners[2] - corners[0]), -direction);
    const float distance_m = glm::length(place);

    const Surface surface = blend_surfaces(words, weights, instance.turn, face);
    const Shade lit = shade(light, surface, -direction);
    const bool sunny = lit.sun != vec3(0.0f) && sees_sun(shot, place, face, distance_m);
    samples.shadowed += dvec3(apply_haze(light, sunny ? lit.sun + lit.sky : lit.sky, distance_m));

    Shade drawn = lit;
    float drawn_openness = surface.openness;
    if (model.is_ground()) {
        const uint32_t* drawn_words = &model.drawn_surfaces[first];
        const Surface drawn_surface =
            blend_surfaces({drawn_words[0], drawn_words[1], drawn_words[2]}, weights, instance.turn, face);
        drawn = shade(light, drawn_surface, -direction);
        drawn_openness = drawn_surface.openness;
    }
    samples.unshadowed +=
        dvec3(apply_haze(light, drawn.sun * stand_in_sun(drawn_openness) + drawn.sky, distance_m));
    samples.coverage += model.is_ground() ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
}

void add_sample(const Shot& shot, vec3 along, Samples& samples) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit found;
    found.ray = {0.0f, 0.0f, 0.0f, shot.near_m, along.x, along.y, along.z, 0.0f, INFINITY, UINT32_MAX, 0, 0};
    found.hit.geomID = found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(shot.view.tree.get(), &context, &found);
    const vec3 direction = along * (1.0f / glm::length(along));
    if (found.hit.geomID != RTC_INVALID_GEOMETRY_ID) return add_surface(shot, found.hit, direction, samples);
    const dvec3 sky(sky_radiance(shot.geometry.light(), direction));
    samples.shadowed += sky;
    samples.unshadowed += sky;
    samples.coverage.z += 1.0;
}

// One ray a cell of the pixel, at a place that is a function of pixel and cell.
Samples sample_pixel(const Shot& shot, uint32_t column, uint32_t row) {
    const uint32_t side = shot.samples_side, pixel_bits = mix_bits(row << 16 | column);
    const float cell = 1.0f / float(side);
    Samples samples;
    for (uint32_t s = 0; s < side * side; ++s) {
        const uint32_t chance = mix_bits(pixel_bits + s * 0x9e3779b9u);
        const float x = (float(s % side) + float(chance >> 16) * 0x1p-16f) * cell;
        const float y = (float(s / side) + float(chance & 0xffffu) * 0x1p-16f) * cell;
        add_sample(shot, shot.lens.along(float(column) + x, float(row) + y), samples);
    }
    return samples;
}

Status check(const Camera& camera, const ReferenceSettings& settings) {
    auto wrong = [](std::string place, std::string fault, std::string remedy) {
        return fail(ErrorId::value_out_of_range, "", std::move(place), std::move(fault), std::move(remedy));
    };
    if (settings.width == 0 || settings.height == 0 || settings.width > k_picture_side_limit ||
        settings.height > k_picture_side_limit)
        return wrong("picture size", std::to_string(settings.width) + "x" + std::to_string(settings.height),
                     "sides from 1 to " + std::to_string(k_picture_side_limit));
    if (settings.samples_per_pixel == 0 || settings.samples_per_pixel > k_samples_limit)
        return wrong("samples per pixel", std::to_string(settings.samples_per_pixel),
                     "from 1 to " + std::to_string(k_samples_limit));
    if (!is_finite(vec3(camera.yaw_rad, camera.pitch_rad, camera.vertical_fov_rad)))
        return wrong("camera", "an angle that is not finite", "radians");
    if (!(camera.near_m > 0.0f) || !std::isfinite(camera.near_m))
        return wrong("camera", "near distance " + std::to_string(camera.near_m), "metres, over 0");
    return {};
}

auto no_memory(const char* place) {
    return fail(ErrorId::limit_exceeded, "", place, "there is no memory for it",
                "a smaller one, or more memory");
}

class EmbreeRayScene final : public RayScene {
  public:
    explicit EmbreeRayScene(RayGeometry geometry) : geometry_(std::move(geometry)) {}
    Result<ReferencePicture> trace(const Camera& camera, const ReferenceSettings& settings) const override {
        return coppice::trace(geometry_, camera, settings);
    }
    uint64_t triangle_count() const override { return geometry_.triangle_count(); }

  private:
    RayGeometry geometry_;
};

}  // namespace

Result<ReferencePicture> trace(const RayGeometry& geometry, const Camera& camera,
                               const ReferenceSettings& settings) try {
    COPPICE_CHECK(check(camera, settings));
    COPPICE_TRY(const RayView view, geometry.view_from(camera.position_world));
    uint32_t samples_side = 1;
    while (samples_side * samples_side < settings.samples_per_pixel) ++samples_side;

    ReferencePicture picture;
    picture.samples_per_pixel = samples_side * samples_side;
    for (FloatPicture* one : {&picture.shadowed, &picture.unshadowed, &picture.coverage}) {
        one->width = settings.width;
        one->height = settings.height;
        one->rgb.resize(size_t(settings.width) * settings.height * 3);
    }
    const Shot shot{geometry, view, Lens(camera, settings.width, settings.height), camera.near_m,
                    samples_side};
    auto write = [&](uint32_t column, uint32_t row) {
        const Samples samples = sample_pixel(shot, column, row);
        const size_t pixel = size_t(row) * settings.width + column;
        for (int c = 0; c < 3; ++c) {
            const double count = picture.samples_per_pixel;
            picture.shadowed.rgb[pixel * 3 + c] = float(samples.shadowed[c] / count);
            picture.unshadowed.rgb[pixel * 3 + c] = float(samples.unshadowed[c] / count);
            picture.coverage.rgb[pixel * 3 + c] = float(samples.coverage[c] / count);
        }
    };
    const uint32_t across = (settings.width - 1) / k_block_px + 1;
    const uint32_t down = (settings.height - 1) / k_block_px + 1;
    std::optional<Progress> progress;
    if (settings.show_progress) progress.emplace("tracing the reference", uint64_t(across) * down);
    parallel_for(size_t(across) * down, 1, [&](size_t first, size_t last) {
        for (size_t block = first; block < last; ++block) {
            const uint32_t column = uint32_t(block % across) * k_block_px;
            const uint32_t row = uint32_t(block / across) * k_block_px;
            for (uint32_t y = row; y < std::min(row + k_block_px, settings.height); ++y)
                for (uint32_t x = column; x < std::min(column + k_block_px, settings.width); ++x) write(x, y);
            if (progress) progress->advance();
        }
    });
    return picture;
} catch (const std::bad_alloc&) {
    return no_memory("picture");
}

Result<std::unique_ptr<RayScene>> create_ray_scene(const Scene& scene, std::span<const Plant> plants,
                                                   const Terrain* bare_terrain) try {
    COPPICE_TRY(RayGeometry geometry, RayGeometry::create(scene, plants, bare_terrain));
    return std::make_unique<EmbreeRayScene>(std::move(geometry));
} catch (const std::bad_alloc&) {
    return no_memory("scene");
}

}  // namespace coppice
