#include "plugins/vegetation/lod/choose_part.h"

#include <algorithm>
#include "plugins/vegetation/plant/line_points.h"
#include "runtime/core/vector_clones.h"

namespace coppice {
namespace {

constexpr float k_latest_leaves = 1.0f / 0.75f;  // PartRule::draws_leaves
constexpr float k_widest_line_px = 64.0f;  // raster_lines.comp

float sample_distance(const FrameSettings& settings) {
    return std::max(settings.sample_distance_px, 1.0e-3f);
}

float line_sample_distance(const FrameSettings& settings) {
    return settings.line_sample_distance_px > 0.0f ? std::max(settings.line_sample_distance_px, 1.0e-3f)
                                                   : sample_distance(settings);
}

}  // namespace

PartRule::PartRule(const PackedPart& part, const FrameSettings& settings, LeafLevels leaves)
    : is_points_(part.kind == PackedPartKind::points),
      always_triangles_(!settings.level_of_detail || part.triangle_count == 0),
      d_px_(sample_distance(settings)),
      line_d_px_(line_sample_distance(settings)),
      importance_(part.importance),
      points_(float(part.point_count)),
      lines_(std::min(float(part.line_count), k_most_count)),
      line_points_(std::min(float(coppice::line_point_count(part)), k_most_count)),
      triangle_count_(part.triangle_count),
      point_count_(part.point_count),
      line_count_(part.line_count) {
    const bool measured = settings.projection == ProjectionMode::measured;
    gains_.fill(1.0f);
    if (measured) gains_ = part.coverage_gain;
    // Points of one size were not measured by height.
    if (measured && (!is_points_ || settings.weigh_by_facing)) {
        for (size_t level = 0; level < height_gains_.size(); ++level)
            height_gains_[level] = height_gain_of(part.height_gain[level]);
    }
    points_per_px2_ = settings.splat_factor * importance_ / (d_px_ * d_px_);
    per_fill_px2_ = 1.0f / (points_ * d_px_ * d_px_);
    triangles_from_ = settings.blend ? 1.5f * points_ : points_;
    blended_per_point_ = 2.0f * float(part.triangle_count) / points_;
    line_error_m_ = part.line_error_m;
    mean_line_length_m_ = part.line_length_m / lines_;
    const bool weighs = settings.weigh_by_facing;
    line_points_area_m2_ = measured && weighs ? mean_projected_area_m2(part) : 0.0f;
    const float length_m = mean_projected_length_m(part);
    if (!(length_m > 0.0f)) line_points_area_m2_ = 0.0f;
    line_points_fill_m_ = line_points_area_m2_ / (length_m * d_px_);
    // |n . v| in the mean over the surface that asks for points (project_part); of a closed one the half that turns away
    // has the same.
    if (weighs) mean_facing_ = is_points_ && !measured && part.flags & k_part_closed ? 1.0f : 0.5f;
    // The squares of p points add up to c_p A'.
    splat_px_ = d_px_ / std::sqrt(importance_ * (weighs ? mean_facing_ : 1.0f));
    line_width_px_ = line_d_px_ / importance_;
    if (leaves.full_count == 0 || !is_points_ || always_triangles_ || settings.foliage == FoliageMode::points)
        return;
    const LeafRange range = settings.foliage == FoliageMode::leaves || part.flags & k_part_prefers_leaves
                                ? whole_leaf_range(part, leaves.least_count)
                                : automatic_leaf_range(part, leaves.full_count, leaves.least_count);
    // Each plant's own beginning is within a quarter of it.
    if (range.to <= k_latest_leaves * range.from) return;
    full_leaves_ = float(leaves.full_count);
    least_leaves_ = float(leaves.least_count);
    leaves_from_ = range.from;
    leaves_to_ = range.to;
}

PartChoice PartRule::expand(const Choice& choice, float side_gain) const {
    PartChoice out;
    switch (choice.form) {
        case Form::triangles:
            out.triangles = triangle_count_;
            return out;
        case Form::leaves:
            out.leaves = choice.count;
            return out;
        case Form::lines:
            out.lines = std::min(choice.count, line_count_);
            out.line_width_px = line_width_px_ * (side_gain * side_gain);
            out.turned_share = 1.0f - std::sqrt(choice.asked);
            return out;
        case Form::line_points:
            out.points = choice.count;
            out.density_limit_m2 = INFINITY;
            out.splat_px = splat_px_ * side_gain;
            break;
        case Form::points:
            out.points = std::min(choice.count, point_count_);
            out.splat_px = splat_px_ * side_gain;
            break;
        case Form::blend:
            out.points = point_count_;
            out.triangles = out.point_owner_min = std::min(choice.count, triangle_count_);
            out.skipped_points =
                uint32_t(uint64_t(point_count_) * out.triangles / std::max(triangle_count_, 1u));
            out.splat_px = splat_px_ * side_gain * std::sqrt(choice.asked / points_);
            break;
    }
    out.mean_facing = mean_facing_;
    return out;
}

PartDemand PartRule::demand(const PartProjection& projected) const {
    const float per_meter_px = projected.pixels_per_meter, area_px2 = projected.area_px2;
    auto gain = [this](float fill) { return gain_at(gains_, gain_place(fill)); };
    const float fill = is_points_ ? area_px2 * per_fill_px2_ : area_px2 / (projected.length_px * line_d_px_);
    const float side_gain =
        side_gain_of(height_gain_at(height_gains_, height_gain_place(fill)), projected.height);
    if (is_points_) return {per_meter_px, area_px2 * gain(fill), 0.0f, 0.0f, side_gain};
    return {per_meter_px, area_px2 * gain(fill), projected.length_px,
            line_points(per_meter_px, gain(line_points_fill_m_ * per_meter_px)), side_gain};
}

namespace {

// Loops over columns, apart so that compilers make vectors of them.

COPPICE_VECTOR_CLONES
void gains_at(const std::array<float, k_gain_levels>& gains, const PlantColumn<float>& fill, size_t count,
              PlantColumn<float>& out) {
    PlantColumn<int32_t> level;
    PlantColumn<float> share;
    for (size_t i = 0; i < count; ++i) {
        const GainPlace place = gain_place(fill[i]);
        level[i] = place.level;
        share[i] = place.share;
    }
    for (size_t i = 0; i < count; ++i) out[i] = gain_at(gains, {level[i], share[i]});
}

COPPICE_VECTOR_CLONES
void side_gains_at(const std::array<HeightGain, k_height_gain_levels>& gains, const PlantColumn<float>& fill,
                   const float* height, size_t count, PlantColumn<float>& out) {
    PlantColumn<int32_t> level;
    PlantColumn<float> share, second, fourth;
    for (size_t i = 0; i < count; ++i) {
        const GainPlace place = height_gain_place(fill[i]);
        level[i] = place.level;
        share[i] = place.share;
    }
    for (size_t i = 0; i < count; ++i) {
        const HeightGain gain = height_gain_at(gains, {level[i], share[i]});
        second[i] = gain.second;
        fourth[i] = gain.fourth;
    }
    for (size_t i = 0; i < count; ++i) out[i] = side_gain_of({second[i], fourth[i]}, height[i]);
}

COPPICE_VECTOR_CLONES
void multiply(const float* a, const float* b, size_t count, float* out) {
    for (size_t i = 0; i < count; ++i) out[i] = a[i] * b[i];
}

COPPICE_VECTOR_CLONES
void multiply(const float* a, float b, size_t count, float* out) {
    for (size_t i = 0; i < count; ++i) out[i] = a[i] * b;
}

COPPICE_VECTOR_CLONES
void choose_all(const PartRule& rule, const PartDemands& demands, const float* chances, size_t count,
                PartRule::Form* forms, uint32_t* counts, float* asked) {
    const PartRule local = rule;  // which what is written cannot change
    const float *per_meter_px = demands.pixels_per_meter.data(), *area_px2 = demands.area_px2.data(),
                *length_px = demands.length_px.data(), *line_points = demands.line_points.data();
    if (local.is_points())
        for (size_t i = 0; i < count; ++i) {
            const PartRule::Choice choice =
                local.choose_points({per_meter_px[i], area_px2[i], 0.0f, 0.0f, 1.0f}, chances[i]);
            forms[i] = choice.form;
            counts[i] = choice.count;
            asked[i] = choice.asked;
        }
    else
        for (size_t i = 0; i < count; ++i) {
            const PartRule::Choice choice = local.choose_lines(
                {per_meter_px[i], area_px2[i], length_px[i], line_points[i], 1.0f}, chances[i]);
            forms[i] = choice.form;
            counts[i] = choice.count;
            asked[i] = choice.asked;
        }
}

}  // namespace

void PartRule::demand(const PackedPart& part, const PlantViews& views, const FrameSettings& settings,
                      PartDemands& out) const {
    const size_t count = views.size();
    out.pixels_per_meter = views.pixels_per_meter;
    PartColumns projected;
    PlantColumn<float> fill, gain;
    project_parts(part, views, settings, projected);
    if (is_points_) {
        multiply(projected.area_px2.data(), per_fill_px2_, count, fill.data());
    } else {
        for (size_t i = 0; i < count; ++i)
            fill[i] = projected.area_px2[i] / (projected.length_px[i] * line_d_px_);
    }
    gains_at(gains_, fill, count, gain);
    side_gains_at(height_gains_, fill, views.direction_y.data(), count, out.side_gain);
    multiply(projected.area_px2.data(), gain.data(), count, out.area_px2.data());
    if (is_points_) return;
    multiply(views.pixels_per_meter.data(), line_points_fill_m_, count, fill.data());
    gains_at(gains_, fill, count, gain);
    const PartRule local = *this;
    for (size_t i = 0; i < count; ++i) {
        out.length_px[i] = projected.length_px[i];
        out.line_points[i] = local.line_points(views.pixels_per_meter[i], gain[i]);
    }
}

void choose_parts(const PartRule& rule, const PartDemands& demands, std::span<const float> chances,
                  PartChoices& out) {
    choose_all(rule, demands, chances.data(), chances.size(), out.form.data(), out.count.data(),
               out.asked.data());
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
    if (settings.weigh_by_facing) {
        choice.mean_facing = 0.5f;
        choice.splat_px /= std::sqrt(choice.mean_facing);
    }
    if (settings.projection == ProjectionMode::measured && settings.weigh_by_facing && part.point_count > 0)
        choice.height_gain =
            height_gain_at(part, density * mean_projected_area_m2(part) / float(part.point_count));
    return choice;
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
