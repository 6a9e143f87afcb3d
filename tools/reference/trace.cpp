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

#ifndef REF_PACKET
#define REF_PACKET 16
#endif
constexpr uint32_t k_packet = REF_PACKET;  // rays that travel together
constexpr uint32_t k_block_px = 16;        // side of what one job traces
constexpr uint32_t k_samples_side_limit = 256;
// A shadow ray starts this share of the viewing distance off the surface: far over what rounding moves a place by, and
// a hundredth of a pixel.
constexpr float k_shadow_offset = 1e-5f, k_shadow_offset_near_m = 4.0f;

#if REF_PACKET == 16
using RayHits = RTCRayHit16;
using Rays = RTCRay16;
constexpr auto k_intersect = &rtcIntersect16;
constexpr auto k_occluded = &rtcOccluded16;
#elif REF_PACKET == 8
using RayHits = RTCRayHit8;
using Rays = RTCRay8;
constexpr auto k_intersect = &rtcIntersect8;
constexpr auto k_occluded = &rtcOccluded8;
#else
using RayHits = RTCRayHitNt<REF_PACKET>;
using Rays = RTCRayNt<REF_PACKET>;
#endif

// From places on the picture to rays from the origin, one metre along the view axis for each unit of length.
struct Lens {
    vec3 right, up, forward;  // of one pixel, of one pixel, of one metre
    float middle_column, middle_row;

    Lens(const Camera& camera, uint32_t width, uint32_t height)
        : forward(camera.forward()), middle_column(0.5f * float(width)), middle_row(0.5f * float(height)) {
        const float half = 0.5f * std::clamp(camera.vertical_fov_rad, 0.001f, 3.1f);
        const float meters_a_pixel = portable_sin(half) / portable_cos(half) / middle_row;
        right = camera.right() * meters_a_pixel;
        up = camera.up() * meters_a_pixel;
    }
    vec3 direction(float column, float row) const {
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
    ReferencePicture& picture;
};

struct PixelSums {
    dvec3 shadowed{0.0}, unshadowed{0.0};
    uint32_t plants = 0, ground = 0;
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

// Traces one block of pixels: rays gather in a packet, which is traced when full; what the sun may reach sends a ray
// into a second packet. Everything happens in an order that depends on the block only.
class BlockTracer {
  public:
    explicit BlockTracer(const Shot& shot) : shot_(shot), light_(shot.geometry.light()) {
        rtcInitIntersectContext(&coherent_);
        coherent_.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }

    void trace(uint32_t first_column, uint32_t first_row) {
        const uint32_t width = shot_.picture.shadowed.width, height = shot_.picture.shadowed.height;
        const uint32_t last_column = std::min(first_column + k_block_px, width);
        const uint32_t last_row = std::min(first_row + k_block_px, height);
        sums_.fill({});
        for (uint32_t row = first_row; row < last_row; ++row)
            for (uint32_t column = first_column; column < last_column; ++column)
                sample_pixel(column, row, (row - first_row) * k_block_px + (column - first_column));
        trace_rays();
        trace_shadows();
        for (uint32_t row = first_row; row < last_row; ++row)
            for (uint32_t column = first_column; column < last_column; ++column)
                write_pixel(size_t(row) * width + column,
                            sums_[(row - first_row) * k_block_px + (column - first_column)]);
    }

  private:
    void sample_pixel(uint32_t column, uint32_t row, uint32_t sum) {
        const uint32_t side = shot_.samples_side, pixel_bits = mix_bits(row << 16 | column);
        const float cell = 1.0f / float(side);
        for (uint32_t s = 0; s < side * side; ++s) {
            const uint32_t chance = mix_bits(pixel_bits + s * 0x9e3779b9u);
            const float x = (float(s % side) + float(chance >> 16) * 0x1p-16f) * cell;
            const float y = (float(s / side) + float(chance & 0xffffu) * 0x1p-16f) * cell;
            add_ray(shot_.lens.direction(float(column) + x, float(row) + y), sum);
        }
    }

    void add_ray(vec3 direction, uint32_t sum) {
        const uint32_t i = ray_count_++;
        RTCRayHitNt<k_packet>& packet = rays_;
        packet.ray.org_x[i] = packet.ray.org_y[i] = packet.ray.org_z[i] = 0.0f;
        packet.ray.dir_x[i] = direction.x;
        packet.ray.dir_y[i] = direction.y;
        packet.ray.dir_z[i] = direction.z;
        packet.ray.tnear[i] = shot_.near_m;
        packet.ray.tfar[i] = INFINITY;
        packet.ray.time[i] = 0.0f;
        packet.ray.mask[i] = UINT32_MAX;
        packet.ray.id[i] = packet.ray.flags[i] = 0;
        packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        ray_sums_[i] = sum;
        if (ray_count_ == k_packet) trace_rays();
    }

    void trace_rays() {
        mark_valid(ray_count_);
        if (ray_count_ > 0)
            k_intersect(valid_.data(), shot_.view.tree.get(), &coherent_, reinterpret_cast<RayHits*>(&rays_));
        for (uint32_t i = 0; i < ray_count_; ++i) {
            const vec3 along(rays_.ray.dir_x[i], rays_.ray.dir_y[i], rays_.ray.dir_z[i]);
            const vec3 direction = along * (1.0f / glm::length(along));
            PixelSums& sums = sums_[ray_sums_[i]];
            if (rays_.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
                const dvec3 sky(sky_radiance(light_, direction));
                sums.shadowed += sky;
                sums.unshadowed += sky;
            } else {
                light_hit(i, direction, sums);
            }
        }
        ray_count_ = 0;
    }

    void light_hit(uint32_t i, vec3 direction, PixelSums& sums) {
        const RayInstance& instance = shot_.view.instances[rays_.hit.instID[0][i]];
        const RayModel& model = shot_.geometry.models()[instance.model];
        const size_t first = size_t(rays_.hit.primID[i]) * 3;
        const PackedVertex* corners = &model.vertices[first];
        const float u = std::clamp(rays_.hit.u[i], 0.0f, 1.0f),
                    v = std::clamp(rays_.hit.v[i], 0.0f, 1.0f - u);
        const std::array<float, 3> weights{1.0f - u - v, u, v};
        std::array<vec3, 3> places;
        vec3 place(0.0f);
        for (int c = 0; c < 3; ++c) {
            places[c] = vec3(corners[c].x_plant, corners[c].y_plant, corners[c].z_plant);
            place += places[c] * weights[c];
        }
        place = instance.to_world(place);
        const vec3 face = normalize_or(
            instance.turn * glm::cross(places[1] - places[0], places[2] - places[0]), -direction);

        const Surface surface = blend_surfaces({corners[0].surface, corners[1].surface, corners[2].surface},
                                               weights, instance.turn, face);
        const float distance_m = glm::length(place), clear = clear_share(light_, distance_m);
        const Shade lit = shade(light_, surface, -direction);
        const vec3 hazed_sun = lit.sun * clear;
        const vec3 rest = lit.sky * clear + light_.haze_color * (1.0f - clear);
        sums.shadowed += dvec3(rest);
        if (hazed_sun != vec3(0.0f)) add_shadow_ray(place, face, distance_m, hazed_sun, sums);

        if (model.is_ground()) {
            ++sums.ground;
            const uint32_t* drawn = &model.drawn_surfaces[first];
            const Surface drawn_surface =
                blend_surfaces({drawn[0], drawn[1], drawn[2]}, weights, instance.turn, face);
            const Shade drawn_lit = shade(light_, drawn_surface, -direction);
            sums.unshadowed += dvec3(apply_haze(
                light_, drawn_lit.sun * stand_in_sun(drawn_surface.openness) + drawn_lit.sky, distance_m));
        } else {
            ++sums.plants;
            sums.unshadowed += dvec3(rest + hazed_sun * stand_in_sun(surface.openness));
        }
    }

    // From the sunny side of the surface: what is thin lets light through and must not shade itself.
    void add_shadow_ray(vec3 place, vec3 face, float distance_m, vec3 radiance, PixelSums& sums) {
        const vec3 to_sun = light_.direction_to_sun;
        const float offset_m = k_shadow_offset * std::max(distance_m, k_shadow_offset_near_m);
        place += face * (glm::dot(face, to_sun) < 0.0f ? -offset_m : offset_m);
        const uint32_t i = shadow_count_++;
        shadows_.org_x[i] = place.x;
        shadows_.org_y[i] = place.y;
        shadows_.org_z[i] = place.z;
        shadows_.dir_x[i] = to_sun.x;
        shadows_.dir_y[i] = to_sun.y;
        shadows_.dir_z[i] = to_sun.z;
        shadows_.tnear[i] = 0.0f;
        shadows_.tfar[i] = INFINITY;
        shadows_.time[i] = 0.0f;
        shadows_.mask[i] = UINT32_MAX;
        shadows_.id[i] = shadows_.flags[i] = 0;
        waiting_[i] = {radiance, &sums};
        if (shadow_count_ == k_packet) trace_shadows();
    }

    void trace_shadows() {
        mark_valid(shadow_count_);
        if (shadow_count_ > 0)
            k_occluded(valid_.data(), shot_.view.tree.get(), &coherent_, reinterpret_cast<Rays*>(&shadows_));
        for (uint32_t i = 0; i < shadow_count_; ++i)
            if (shadows_.tfar[i] >= 0.0f) waiting_[i].sums->shadowed += dvec3(waiting_[i].radiance);
        shadow_count_ = 0;
    }

    void mark_valid(uint32_t count) {
        for (uint32_t i = 0; i < k_packet; ++i) valid_[i] = i < count ? -1 : 0;
    }

    void write_pixel(size_t pixel, const PixelSums& sums) {
        const double samples = double(shot_.samples_side) * double(shot_.samples_side);
        const double hit = double(sums.plants) + double(sums.ground);
        const dvec3 coverage(double(sums.plants), double(sums.ground), samples - hit);
        for (int c = 0; c < 3; ++c) {
            shot_.picture.shadowed.rgb[pixel * 3 + c] = float(sums.shadowed[c] / samples);
            shot_.picture.unshadowed.rgb[pixel * 3 + c] = float(sums.unshadowed[c] / samples);
            shot_.picture.coverage.rgb[pixel * 3 + c] = float(coverage[c] / samples);
        }
    }

    struct Waiting {
        vec3 radiance;  // that arrives if the sun is seen
        PixelSums* sums;
    };

    const Shot& shot_;
    const Light& light_;
    RTCIntersectContext coherent_;
    alignas(64) RTCRayHitNt<k_packet> rays_;
    alignas(64) RTCRayNt<k_packet> shadows_;
    alignas(64) std::array<int, k_packet> valid_;
    uint32_t ray_count_ = 0, shadow_count_ = 0;
    std::array<uint32_t, k_packet> ray_sums_;
    std::array<Waiting, k_packet> waiting_;
    std::array<PixelSums, k_block_px * k_block_px> sums_;
};

Status check(const Camera& camera, const ReferenceSettings& settings) {
    auto wrong = [](std::string place, std::string fault, std::string remedy) {
        return fail(ErrorId::value_out_of_range, "", std::move(place), std::move(fault), std::move(remedy));
    };
    if (settings.width == 0 || settings.height == 0 || settings.width > k_picture_side_limit ||
        settings.height > k_picture_side_limit)
        return wrong("picture size", std::to_string(settings.width) + "x" + std::to_string(settings.height),
                     "sides from 1 to " + std::to_string(k_picture_side_limit));
    if (settings.samples_per_pixel == 0 ||
        settings.samples_per_pixel > k_samples_side_limit * k_samples_side_limit)
        return wrong("samples per pixel", std::to_string(settings.samples_per_pixel),
                     "from 1 to " + std::to_string(k_samples_side_limit * k_samples_side_limit));
    const dvec3& at = camera.position_world;
    for (double value : {at.x, at.y, at.z, double(camera.yaw_rad), double(camera.pitch_rad),
                         double(camera.vertical_fov_rad)})
        if (!std::isfinite(value))
            return wrong("camera", "a place or angle that is not finite", "metres, radians");
    if (!(camera.near_m > 0.0f) || !std::isfinite(camera.near_m))
        return wrong("camera", "near distance " + std::to_string(camera.near_m), "metres, over 0");
    return {};
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

auto no_memory(const char* what) {
    return fail(ErrorId::limit_exceeded, "", what, "no memory for it", "a smaller one, or more memory");
}

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
    const Shot shot{geometry,      view,         Lens(camera, settings.width, settings.height),
                    camera.near_m, samples_side, picture};
    const uint32_t across = (settings.width - 1) / k_block_px + 1,
                   down = (settings.height - 1) / k_block_px + 1;
    std::optional<Progress> progress;
    if (settings.show_progress) progress.emplace("tracing the reference", uint64_t(across) * down);
    parallel_for(size_t(across) * down, 1, [&](size_t first, size_t last) {
        BlockTracer tracer(shot);
        for (size_t block = first; block < last; ++block) {
            tracer.trace(uint32_t(block % across) * k_block_px, uint32_t(block / across) * k_block_px);
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
