#include "plugins/vegetation/lod/choose_part.h"

#include <algorithm>

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

PartChoice choose_cloud(const PackedPart& cloud, std::span<const float> densities, float mean_area_m2,
                        const PlantView& view, float depth_m, float nearest_pixels_per_meter,
                        const FrameSettings& settings) {
    PartChoice choice;
    const float area_px2 = projected_area_px2(cloud, view, settings.projection);
    const float mean_px2 = mean_area_m2 * view.pixels_per_meter * view.pixels_per_meter;
    if (!(area_px2 > 0.0f) || !(mean_px2 > 0.0f)) return choice;
    const float d = sample_distance(settings);
    const float per_meter = view.pixels_per_meter / d, nearest_per_meter = nearest_pixels_per_meter / d;
    const float from_here = settings.splat_factor * area_px2 / mean_px2;  // from this side, over the mean
    auto count_up_to = [densities](float density) {
        return uint32_t(std::upper_bound(densities.begin(), densities.end(), density) - densities.begin());
    };
    choice.points = count_up_to(nearest_per_meter * nearest_per_meter * from_here);
    choice.skipped_points =
        choice.points - std::min(choice.points, count_up_to(per_meter * per_meter * from_here));
    choice.density_limit_m2 = per_meter * per_meter * from_here * depth_m * depth_m;
    choice.splat_px = d;  // the squares of p = c_p A' / d'^2 points add up to c_p A'
    weigh_by_facing(choice, mean_facing(cloud, area_px2, view.pixels_per_meter), settings);
    return choice;
}

namespace {

// The area that points or lines are to cover. The gain was measured at d' = 1. Points of side d' overlap as points of one
// pixel do in a picture d' times coarser, and what the triangles cover does not depend on the resolution: so d' is the
// unit of length here.
float gained_area_px2(const PackedPart& part, const PartProjection& projected,
                      const FrameSettings& settings) {
    if (settings.projection != ProjectionMode::measured) return projected.area_px2;
    float fill_px2;  // that of a point or line
    if (part.kind == PackedPartKind::points) {
        const float d = sample_distance(settings);
        fill_px2 = float(part.point_count) * d * d;
    } else {
        fill_px2 = projected.length_px * line_sample_distance(settings);
    }
    return fill_px2 > 0.0f ? projected.area_px2 * gain_at(part, projected.area_px2 / fill_px2)
                           : projected.area_px2;
}

}  // namespace

PartChoice choose_part(const PackedPart& part, const PartProjection& projected, const FrameSettings& settings,
                       float chance) {
    if (!settings.level_of_detail) return all_triangles(part);
    const float area_px2 = gained_area_px2(part, projected, settings);
    if (part.kind == PackedPartKind::lines)
        return choose_lines(part, area_px2, projected.length_px, projected.pixels_per_meter, settings,
                            chance);
    PartChoice choice = choose_points(part, area_px2, settings, chance);
    weigh_by_facing(choice, mean_facing(part, projected.area_px2, projected.pixels_per_meter), settings);
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
    // choose_points: a part's last points cover up to 1.5 times the square of d' over importance.
    const float splat_px =
        sample_distance(settings) *
        std::sqrt(1.5f / (least_importance * (settings.weigh_by_facing ? k_least_facing : 1.0f)));
    const float line_px = std::min(
        1.4143f * line_sample_distance(settings) / least_importance * most_line_width, k_widest_line_px);
    return 0.5f * std::max(splat_px, line_px);
}

}  // namespace coppice
