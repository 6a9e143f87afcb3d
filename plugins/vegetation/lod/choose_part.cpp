#include "plugins/vegetation/lod/choose_part.h"

#include <algorithm>
#include "plugins/vegetation/plant/line_points.h"

namespace coppice {
namespace {

uint32_t round_by_chance(float count, float chance, uint32_t limit) {
    float rounded = std::floor(count + chance);
    return rounded >= float(limit) ? limit : uint32_t(std::max(rounded, 0.0f));
}

// Seen this much on edge, nothing is left to weigh.
constexpr float k_least_facing = 0.02f;
constexpr float k_widest_line_px = 64.0f;  // raster_lines.comp

float sample_distance(const FrameSettings& settings) {
    return std::max(settings.sample_distance_px, 1.0e-3f);
}

float line_sample_distance(const FrameSettings& settings) {
    return settings.line_sample_distance_px > 0.0f ? std::max(settings.line_sample_distance_px, 1.0e-3f)
                                                   : sample_distance(settings);
}

// |n . v| in the mean over the part's surface; of a closed one the half that turns away has the same.
float mean_facing(const PackedPart& part, float area_px2, float pixels_per_meter) {
    const float sides = part.flags & k_part_closed ? 2.0f : 1.0f;
    const float surface_px2 = part.area_m2 * pixels_per_meter * pixels_per_meter;
    return surface_px2 > 0.0f ? std::min(sides * area_px2 / surface_px2, 1.0f) : 0.0f;
}

void weigh_by_facing(PartChoice& choice, float facing, const FrameSettings& settings) {
    if (!settings.weigh_by_facing || facing <= k_least_facing) return;
    choice.mean_facing = facing;
    choice.splat_px /= std::sqrt(facing);
}

// From above and from the side other shares of a plant are hidden. How many points there are does not depend on it.
void weigh_by_height(PartChoice& choice, HeightGain height_gain, float height) {
    const float gain = seen_gain(height_gain, height);
    choice.splat_px *= std::sqrt(gain);
    choice.line_width_px *= gain;
}

PartChoice all_triangles(const PackedPart& part) {
    PartChoice choice;
    choice.triangles = part.triangle_count;
    return choice;
}

}  // namespace

float point_count(float projected_area_px2, float importance, const FrameSettings& settings) {
    const float d = sample_distance(settings);
    return std::min(settings.splat_factor * importance * projected_area_px2 / (d * d), 4.0e9f);
}

PartChoice choose_points(const PackedPart& part, float projected_area_px2, const FrameSettings& settings,
                         float chance) {
    PartChoice choice;
    if (part.triangle_count == 0 || !(projected_area_px2 > 0.0f)) return choice;
    float p = point_count(projected_area_px2, part.importance, settings);
    float stored = float(part.point_count);
    if (part.point_count == 0 || p >= 1.5f * stored || (!settings.blend && p >= stored))
        return all_triangles(part);
    choice.splat_px = std::sqrt(settings.splat_factor * projected_area_px2 / std::min(p, stored));
    if (p < stored) {
        choice.points = round_by_chance(p, chance, part.point_count);
    } else {
        choice.points = part.point_count;
        choice.triangles = round_by_chance((p - stored) / (0.5f * stored) * float(part.triangle_count),
                                           chance, part.triangle_count);
        choice.point_owner_min = choice.triangles;
        choice.skipped_points =
            uint32_t(uint64_t(part.point_count) * choice.triangles / std::max(part.triangle_count, 1u));
    }
    return choice;
}

PartChoice choose_lines(const PackedPart& part, float projected_area_px2, float projected_length_px,
                        float pixels_per_meter, const FrameSettings& settings, float chance) {
    PartChoice choice;
    if (part.triangle_count == 0 || !(projected_area_px2 > 0.0f)) return choice;
    const float d = line_sample_distance(settings);
    float line_area_px2 = projected_length_px * d;
    // importance makes more and thinner lines, and keeps triangles for longer
    float q = part.importance * projected_area_px2 / line_area_px2;
    if (part.line_count == 0 || !(line_area_px2 > 0.0f) || part.line_error_m * pixels_per_meter >= d ||
        !(q <= 1.0f))
        return all_triangles(part);
    choice.lines = round_by_chance(q * float(part.line_count), chance, part.line_count);
    choice.line_width_px = d / part.importance;
    choice.turned_share = 1.0f - std::sqrt(q);
    return choice;
}

float line_points_at_1px(const PackedPart& part, float pixels_per_meter, const FrameSettings& settings) {
    if (settings.projection != ProjectionMode::measured || !settings.weigh_by_facing) return 0.0f;
    const float area_px2 = mean_projected_area_m2(part) * pixels_per_meter * pixels_per_meter;
    const float length_px = mean_projected_length_m(part) * pixels_per_meter;
    if (!(area_px2 > 0.0f) || !(length_px > 0.0f)) return 0.0f;
    return settings.splat_factor * part.importance * area_px2 *
           gain_at(part, area_px2 / (length_px * sample_distance(settings)));
}

float line_points_from_px(const PackedPart& part, float points_at_1px, float pixels_per_meter) {
    constexpr float k_few_points = 8.0f;
    if (part.line_count == 0 || !(points_at_1px > 0.0f)) return INFINITY;
    return std::min(part.line_length_m / float(part.line_count) * pixels_per_meter,
                    std::sqrt(points_at_1px / k_few_points));
}

PartChoice choose_line_points(const PackedPart& part, float points_at_1px, const FrameSettings& settings,
                              float chance) {
    PartChoice choice;
    const float d = sample_distance(settings);
    choice.points = round_by_chance(points_at_1px / (d * d), chance, line_point_count(part));
    choice.splat_px = d / std::sqrt(part.importance);
    choice.density_limit_m2 = INFINITY;
    weigh_by_facing(choice, 0.5f, settings);
    return choice;
}

PartChoice choose_cloud(const PackedPart& part, std::span<const float> densities, float pixels_per_meter,
                        float distance_m, float depth_m, float nearest_pixels_per_meter,
                        const FrameSettings& settings) {
    PartChoice choice;
    const float d = sample_distance(settings);
    auto density_at = [&](float per_meter_px) {
        return settings.splat_factor * (per_meter_px / d) * (per_meter_px / d);
    };
    auto count_up_to = [densities](float density) {
        return uint32_t(std::upper_bound(densities.begin(), densities.end(), density) - densities.begin());
    };
    const float density = density_at(pixels_per_meter);
    choice.points = count_up_to(density_at(nearest_pixels_per_meter));
    choice.skipped_points = choice.points - std::min(choice.points, count_up_to(density));
    choice.density_limit_m2 =
        depth_m > 0.0f ? density * depth_m * depth_m * (depth_m / distance_m) : INFINITY;
    choice.splat_px = d;  // the squares of p = c_p A' / d'^2 points add up to c_p A'
    weigh_by_facing(choice, 0.5f, settings);
    if (settings.projection == ProjectionMode::measured && part.point_count > 0)
        choice.height_gain =
            height_gain_at(part, density * mean_projected_area_m2(part) / float(part.point_count));
    return choice;
}

namespace {

// By which gains are looked up; 0: there are none. They were measured at d' = 1. Points of side d' overlap as points of one
// pixel do in a picture d' times coarser, and what the triangles cover does not depend on the resolution: so d' is the
// unit of length here.
float fill_of(const PackedPart& part, const PartProjection& projected, const FrameSettings& settings) {
    if (settings.projection != ProjectionMode::measured) return 0.0f;
    float fill_px2;  // that of a point or line
    if (part.kind == PackedPartKind::points) {
        const float d = sample_distance(settings);
        fill_px2 = float(part.point_count) * d * d;
    } else {
        fill_px2 = projected.length_px * line_sample_distance(settings);
    }
    return fill_px2 > 0.0f ? projected.area_px2 / fill_px2 : 0.0f;
}

// The area that points or lines are to cover.
float gained_area_px2(const PackedPart& part, const PartProjection& projected,
                      const FrameSettings& settings) {
    const float fill = fill_of(part, projected, settings);
    return fill > 0.0f ? projected.area_px2 * gain_at(part, fill) : projected.area_px2;
}

}  // namespace

PartChoice choose_part(const PackedPart& part, const PartProjection& projected, const FrameSettings& settings,
                       float chance) {
    if (!settings.level_of_detail) return all_triangles(part);
    const float fill = fill_of(part, projected, settings);
    const float area_px2 = fill > 0.0f ? projected.area_px2 * gain_at(part, fill) : projected.area_px2;
    const HeightGain height_gain = fill > 0.0f ? height_gain_at(part, fill) : HeightGain{};
    if (part.kind == PackedPartKind::lines) {
        PartChoice choice =
            choose_lines(part, area_px2, projected.length_px, projected.pixels_per_meter, settings, chance);
        if (choice.triangles > 0) return choice;
        // Each plant goes over at a d' of its own.
        const float turn = chance * 256.0f - std::floor(chance * 256.0f);
        const float points_at_1px = line_points_at_1px(part, projected.pixels_per_meter, settings);
        const float from_px = line_points_from_px(part, points_at_1px, projected.pixels_per_meter);
        if (line_sample_distance(settings) * (0.75f + 0.5f * turn) >= from_px)
            choice = choose_line_points(part, points_at_1px, settings, chance);
        weigh_by_height(choice, height_gain, projected.height);
        return choice;
    }
    PartChoice choice = choose_points(part, area_px2, settings, chance);
    weigh_by_facing(choice, mean_facing(part, projected.area_px2, projected.pixels_per_meter), settings);
    weigh_by_height(choice, height_gain, projected.height);
    return choice;
}

bool draws_triangles(const PackedPart& part, const PartProjection& projected, const FrameSettings& settings) {
    const float area_px2 = gained_area_px2(part, projected, settings);
    if (part.kind == PackedPartKind::points)
        return point_count(area_px2, part.importance, settings) >= float(part.point_count);
    return choose_lines(part, area_px2, projected.length_px, projected.pixels_per_meter, settings, 0.0f)
               .triangles > 0;
}

float widest_spread_px(float least_importance, float most_line_width, const FrameSettings& settings) {
    if (!settings.level_of_detail) return 0.0f;
    // choose_points: a part's last points cover up to 1.5 times the square of d' over importance; those of lines are as
    // large as these are wide. Half of that is seen in the mean over directions. From above they may be larger.
    const float share =
        std::max(1.5f, most_line_width) * (settings.weigh_by_facing ? 2.0f : 1.0f) * k_largest_seen_gain;
    const float splat_px = sample_distance(settings) * std::sqrt(share / least_importance);
    const float line_px = std::min(
        1.4143f * line_sample_distance(settings) / least_importance * most_line_width * k_largest_seen_gain,
        k_widest_line_px);
    return 0.5f * std::max(splat_px, line_px);
}

}  // namespace coppice
