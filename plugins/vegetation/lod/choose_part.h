// Which primitives of a part are drawn this frame: the paper's rules for points, lines and their blending with
// triangles (Deussen et al. 2002, sections 5.1 to 5.3; DESIGN section 3: point_count, line_count, blend).
#pragma once
#include <cstdint>
#include <span>
#include "plugins/vegetation/lod/project.h"

namespace coppice {

// Prefixes of the part's triangles, points and lines.
struct PartChoice {
    uint32_t triangles = 0;
    uint32_t points = 0;
    uint32_t lines = 0;
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

// p = c_p A'_p / d'^2, times importance (ERRATA 1). Not rounded; finite and >= 0 for finite input.
float point_count(float projected_area_px2, float importance, const FrameSettings& settings);

// p < n_p: the first p points. n_p <= p < 1.5 n_p (2k <= p < 3k where n_p = 2k): the first share of the triangles and
// the points of the others. Above: all triangles. The squares the points cover add up to c_p times the projected
// area in every case, so that the mean coverage does not depend on the representation.
// chance in [0, 1): rounds a fraction of a point up or down.
PartChoice choose_points(const PackedPart& part, float projected_area_px2, const FrameSettings& settings,
                         float chance);

// eps_l on the screen >= d', or q = A'_l / (l' d') > 1: all triangles. Else the first q n_l lines.
PartChoice choose_lines(const PackedPart& part, float projected_area_px2, float projected_length_px,
                        float pixels_per_meter, const FrameSettings& settings, float chance);

// Points that stand for a part's lines (plant/line_points.h), where those are shorter than d', and so wider than long, or
// where few points would do: a whole trunk for every third plant is worse than a third of it for each. As many as a part of
// points would draw, times d'^2; 0 where splats are not sized by |n . v|.
float line_points_at_1px(const PackedPart& part, float pixels_per_meter, const FrameSettings& settings);
// The d' from which on they do; each plant has its own within a quarter of that.
float line_points_from_px(const PackedPart& part, float points_at_1px, float pixels_per_meter);
PartChoice choose_line_points(const PackedPart& part, float points_at_1px, const FrameSettings& settings,
                              float chance);

// Points that stand for a whole tile: at each place those whose density is at most what it asks for at its own distance,
// which are those the plants would draw there. densities: of the cloud's points, ascending (eco/make_cloud.h);
// pixels_per_meter: at the tile's centre, distance_m away, depth_m along the view; nearest_pixels_per_meter >= pixels_per_meter.
PartChoice choose_cloud(const PackedPart& part, std::span<const float> densities, float pixels_per_meter,
                        float distance_m, float depth_m, float nearest_pixels_per_meter,
                        const FrameSettings& settings);

// The whole decision for one part; projected with the settings.
PartChoice choose_part(const PackedPart& part, const PartProjection& projected, const FrameSettings& settings,
                       float chance);
inline PartChoice choose_part(const PackedPart& part, const PlantView& view, const FrameSettings& settings,
                              float chance) {
    return choose_part(part, project_part(part, view, settings), settings, chance);
}

// Whether the part's points or lines do not suffice, so that choose_part draws triangles. Not of one without levels of
// detail.
bool draws_triangles(const PackedPart& part, const PartProjection& projected, const FrameSettings& settings);

// How far beside their geometry points and lines cover pixels at most, along an axis of the picture.
// least_importance: of all parts; most_line_width: of all lines, over their part's mean.
float widest_spread_px(float least_importance, float most_line_width, const FrameSettings& settings);

}  // namespace coppice
