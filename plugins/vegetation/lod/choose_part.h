// Which primitives of a part are drawn this frame: the paper's rules for points, lines and their blending with
// triangles (Deussen et al. 2002, sections 5.1 to 5.3; DESIGN section 3: point_count, line_count, blend).
#pragma once
#include <cstdint>
#include <span>
#include "plugins/vegetation/lod/project.h"
#include "plugins/vegetation/plant/leaf_range.h"

namespace coppice {

// Prefixes of the part's triangles, points and lines.
struct PartChoice {
    uint32_t triangles = 0;
    uint32_t points = 0;
    uint32_t lines = 0;
    uint32_t leaves = 0;  // of the part's crown: its level with so many
    uint32_t point_owner_min = 0;  // only points whose triangle is at or past this one are drawn
    uint32_t skipped_points = 0;   // about how many of `points` that leaves out
    float splat_px = 0.0f;         // side of the square a point covers
    float line_width_px = 0.0f;
    // A line that stands for n leaves shows other normals than its own in 1 - 1 / sqrt(n) of its pixels, so that the
    // contrast of what it shows is that of n leaves' mean (ERRATA 12).
    float turned_share = 0.0f;
    // Splats are sized by |n . v|, whose mean this is; splat_px is of a point that faces the viewer. 0: all are of one
    // size.
    float mean_facing = 0.0f;
    // Of points that carry a density and a size (plant/line_points.h): drawn are those of `points` whose density T, times
    // the cube of their distance along the view in m over their distance, is at most this. 0: others, which are of one size.
    float density_limit_m2 = 0.0f;
    HeightGain height_gain;  // of those; each is looked at from a height of its own
};

// What a plant asks of one of its parts at the frame's d'.
struct PartDemand {
    float pixels_per_meter;
    float area_px2;     // that points or lines are to cover: A'_p times the gain
    float length_px;    // l'; only of lines
    float line_points;  // p of the points that may stand in the place of lines
    float side_gain;  // how many times as long the sides of points are, from that height; lines as its square
};
// The same of many plants of one model.
struct PartDemands {
    std::span<const float> pixels_per_meter;
    PlantColumn<float> area_px2, side_gain;
    PlantColumn<float> length_px, line_points;  // left alone for parts of points
    PartDemand operator[](size_t i) const {
        return {pixels_per_meter[i], area_px2[i], length_px[i], line_points[i], side_gain[i]};
    }
};

// From above and from the side other shares of a plant are hidden. How many points there are does not depend on it.
inline float side_gain_of(HeightGain gain, float height) { return std::sqrt(seen_gain(gain, height)); }

// The levels of a part's crown (plant/plant.h, PackedCrown); 0: it has none.
struct LeafLevels {
    uint32_t full_count = 0, least_count = 0;
};

// The rules for one part, with all that the plants of a frame have in common. What remains for each plant has no branches,
// so that compilers make vectors of loops over plants.
class PartRule {
  public:
    PartRule(const PackedPart& part, const FrameSettings& settings, LeafLevels leaves = {});

    // The gain was measured at d' = 1. Points of side d' overlap as points of one pixel do in a picture d' times coarser,
    // and what the triangles cover does not depend on the resolution: so d' is the unit of length here.
    PartDemand demand(const PartProjection& projected) const;
    void demand(const PackedPart& part, const PlantViews& views, const FrameSettings& settings,
                PartDemands& out) const;

    enum class Form : uint32_t {
        triangles,    // all
        points,       // the first of them
        blend,        // the first triangles and the points of the others
        lines,        // the first of them
        line_points,  // the first points that stand for lines (plant/line_points.h)
        leaves,       // the level of the crown with so many
    };
    struct Choice {
        Form form;
        uint32_t count;  // of what the form names, 0 for all triangles; of a blend the triangles
        float asked;     // of points and leaves p, of lines q, not rounded
    };
    // chance in [0, 1): rounds a fraction of a point or line up or down.
    Choice choose(const PartDemand& demand, float chance) const {
        return is_points_ ? choose_points(demand, chance) : choose_lines(demand, chance);
    }
    PartChoice expand(const Choice& choice, float side_gain) const;
    // Whether points or lines do not suffice.
    bool draws_triangles(const PartDemand& demand) const {
        const Form form = choose(demand, 0.0f).form;
        return form == Form::triangles || form == Form::blend;
    }

    // p < n_p: the first p points. n_p <= p < 1.5 n_p (2k <= p < 3k where n_p = 2k): the first share of the triangles and
    // the points of the others. Above: all triangles. The squares the points cover add up to c_p times the projected
    // area in every case, so that the mean coverage does not depend on the representation.
    Choice choose_points(const PartDemand& demand, float chance) const {
        const float p = point_count(demand.area_px2);
        const bool any = demand.area_px2 > 0.0f;
        const bool all = always_triangles_ | (any & (p >= triangles_from_));
        const bool blends = any & (p >= points_);
        const bool as_leaves = draws_leaves(p, chance);
        const float leaves = p * (1.0f / k_points_a_leaf) + chance;
        const float few = leaves > least_leaves_ ? leaves : least_leaves_;
        const float count = as_leaves ? (few < full_leaves_ ? few : full_leaves_)
                                      : (blends ? (p - points_) * blended_per_point_ : p) + chance;
        return {as_leaves ? Form::leaves
                : all     ? Form::triangles
                : blends  ? Form::blend
                          : Form::points,
                round_down(all & !as_leaves ? 0.0f : count, k_most_count), p};
    }
    // Leaves stand between points and triangles. Each plant changes to points at a p of its own within a quarter of that of
    // all; what stands for triangles, or for more points than leaves are worth, does so for all plants at once.
    bool draws_leaves(float p, float chance) const {
        const float turn = chance * 256.0f - float(int32_t(chance * 256.0f));
        return (p < leaves_to_) & (p * (0.75f + 0.5f * turn) >= leaves_from_);
    }
    // p; 0 where leaves are never drawn.
    float leaves_to() const { return leaves_to_; }
    // Whether they have other counts of vertices than what stands in their place without them.
    bool leaves_count_apart() const {
        return leaves_to_ > k_points_a_leaf * full_leaves_ || leaves_to_ > points_;
    }
    float full_leaves() const { return full_leaves_; }

    // eps_l on the screen >= d', or q = A'_l / (l' d') > 1: all triangles. Else the first q n_l lines, or points.
    Choice choose_lines(const PartDemand& demand, float chance) const {
        const float line_area_px2 = demand.length_px * line_d_px_;
        const bool any = demand.area_px2 > 0.0f;
        // importance makes more and thinner lines, and keeps triangles for longer
        const float asked = importance_ * demand.area_px2 / line_area_px2;
        const bool suffices = (lines_ > 0.0f) & (line_area_px2 > 0.0f) &
                              (line_error_m_ * demand.pixels_per_meter < line_d_px_) & (asked <= 1.0f);
        const bool all = always_triangles_ | (any & !suffices);
        const float q = any & suffices ? asked : 0.0f;
        const float turn = chance * 256.0f - float(int32_t(chance * 256.0f));
        const bool as_points = line_d_px_ * (0.75f + 0.5f * turn) >= line_points_from_px(demand);
        const float count = (as_points ? demand.line_points : q * lines_) + chance;
        return {all         ? Form::triangles
                : as_points ? Form::line_points
                            : Form::lines,
                round_down(all ? 0.0f : count, as_points ? line_points_ : lines_),
                as_points ? demand.line_points : q};
    }

    // p = c_p A'_p / d'^2, times importance (ERRATA 1). Finite and >= 0.
    float point_count(float area_px2) const {
        const float p = points_per_px2_ * area_px2;
        return area_px2 > 0.0f ? (p < k_most_points ? p : k_most_points) : 0.0f;
    }
    // A count of points as it would be at d' = 1.
    float at_1px(float points) const { return points * d_px_ * d_px_; }
    // The d' from which on points are drawn in the place of lines; each plant has its own within a quarter of that. Where
    // lines are shorter than d', and so wider than long, or where few points would do: a whole trunk for every third
    // plant is worse than a third of it for each.
    float line_points_from_px(const PartDemand& demand) const {
        constexpr float k_few_points = 8.0f;
        const float length_px = mean_line_length_m_ * demand.pixels_per_meter;
        const float few_px = std::sqrt(demand.line_points * (1.0f / k_few_points)) * d_px_;
        const float from_px = length_px < few_px ? length_px : few_px;
        return (demand.line_points > 0.0f) & (lines_ > 0.0f) ? from_px : INFINITY;
    }
    bool is_points() const { return is_points_; }

  private:
    static constexpr float k_most_points = 4.0e9f;
    static constexpr float k_most_count = 2147483520.0f;  // the last float below 2^31
    static uint32_t round_down(float count, float most) {
        return uint32_t(int32_t(count < most ? count : most));
    }
    // Points in the place of lines, not rounded: as many as a part of points would draw; 0 where splats are not sized by
    // |n . v|.
    float line_points(float per_meter_px, float gain) const {
        return point_count(line_points_area_m2_ * (per_meter_px * per_meter_px) * gain);
    }

    bool is_points_, always_triangles_;
    std::array<float, k_gain_levels> gains_;  // 1 where nothing was measured
    std::array<HeightGain, k_height_gain_levels> height_gains_{};
    float d_px_, line_d_px_;
    float importance_;
    float points_, lines_, line_points_;  // stored
    float points_per_px2_;
    float per_fill_px2_;       // of points: 1 over what squares of side d' cover, as many as are stored
    float triangles_from_;     // p
    float blended_per_point_;  // triangles drawn for a point more than stored
    float line_error_m_, mean_line_length_m_;
    float line_points_area_m2_;  // in the mean over directions; 0: no points in the place of lines
    float line_points_fill_m_;   // 1 m times that over the lines' mean length and d'
    float splat_px_, line_width_px_, mean_facing_ = 0.0f;
    float full_leaves_ = 0.0f, least_leaves_ = 0.0f;
    float leaves_from_ = INFINITY, leaves_to_ = 0.0f;  // p; none are drawn where there are none
    uint32_t triangle_count_, point_count_, line_count_;
};

// What rule.choose says of many plants.
struct PartChoices {
    PlantColumn<PartRule::Form> form;
    PlantColumn<uint32_t> count;
    PlantColumn<float> asked;
    PartRule::Choice operator[](size_t i) const { return {form[i], count[i], asked[i]}; }
};
// One choice for each of the chances, at most k_plants_a_batch.
void choose_parts(const PartRule& rule, const PartDemands& demands, std::span<const float> chances,
                  PartChoices& out);

// The whole decision for one part.
inline PartChoice choose_part(const PackedPart& part, const PlantView& view, const FrameSettings& settings,
                              float chance, LeafLevels leaves = {}) {
    const PartRule rule(part, settings, leaves);
    const PartDemand demand = rule.demand(project_part(part, view, settings));
    return rule.expand(rule.choose(demand, chance), demand.side_gain);
}

// Points that stand for a whole tile: at each place those whose density is at most what it asks for at its own distance,
// which are those the plants would draw there. densities: of the cloud's points, ascending (eco/make_cloud.h);
// pixels_per_meter: at the tile's centre, distance_m away, depth_m along the view; nearest_pixels_per_meter >= pixels_per_meter.
PartChoice choose_cloud(const PackedPart& part, std::span<const float> densities, float pixels_per_meter,
                        float distance_m, float depth_m, float nearest_pixels_per_meter,
                        const FrameSettings& settings);

// How far beside their geometry points and lines cover pixels at most, along an axis of the picture.
// least_importance: of all parts; most_line_width: of all lines, over their part's mean.
float widest_spread_px(float least_importance, float most_line_width, const FrameSettings& settings);

}  // namespace coppice
