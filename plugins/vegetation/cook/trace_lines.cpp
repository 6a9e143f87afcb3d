#include "plugins/vegetation/cook/trace_lines.h"

#include <algorithm>
#include "plugins/vegetation/cook/triangle_areas.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr float k_error_share = 0.995f;      // of the surface, that eps_l covers
constexpr float k_bend_tolerance = 0.25f;    // of the radius
constexpr float k_bent_share = 0.05f;        // of the length may be off by more
constexpr float k_short_stem_share = 0.25f;  // of the length may be in stems shorter than a line
constexpr float k_facing_share = 0.3f;       // |sum of a n| / sum of a, from where a surface faces one way

float length_of(const SkeletonSegment& s) {
    vec3 along = s.end_plant - s.begin_plant;
    return std::sqrt(glm::dot(along, along));
}

// Points at equal distances along a stem: piece_count + 1.
std::vector<vec3> resample(const std::vector<SkeletonSegment>& segments, const StemRange& stem,
                           uint32_t piece_count) {
    std::vector<vec3> points{segments[stem.first].begin_plant};
    float before = 0.0f;
    uint32_t at = stem.first;
    for (uint32_t i = 1; i < piece_count; ++i) {
        float target = stem.length_m * float(i) / float(piece_count);
        while (at + 1 < stem.last && before + length_of(segments[at]) < target)
            before += length_of(segments[at++]);
        float share = std::clamp((target - before) / length_of(segments[at]), 0.0f, 1.0f);
        points.push_back(segments[at].begin_plant +
                         (segments[at].end_plant - segments[at].begin_plant) * share);
    }
    points.push_back(segments[stem.last - 1].end_plant);
    return points;
}

// Length of the stem's segments whose end lies further from the pieces than the tolerance.
double bent_length(const std::vector<SkeletonSegment>& segments, const StemRange& stem,
                   const std::vector<vec3>& points) {
    double bent = 0.0;
    float before = 0.0f;
    for (uint32_t s = stem.first; s < stem.last; ++s) {
        before += length_of(segments[s]);
        size_t piece = std::min(size_t(before / stem.length_m * float(points.size() - 1)), points.size() - 2);
        float off = distance_to_segment(segments[s].end_plant, points[piece], points[piece + 1]);
        if (off > k_bend_tolerance * segments[s].end_radius_m) bent += double(length_of(segments[s]));
    }
    return bent;
}

std::vector<uint32_t> choose_piece_counts(const std::vector<SkeletonSegment>& segments,
                                          const std::vector<StemRange>& stems, size_t line_limit) {
    std::vector<float> lengths;
    double total = 0.0;
    for (const StemRange& stem : stems) {
        lengths.push_back(stem.length_m);
        total += double(stem.length_m);
    }
    std::sort(lengths.begin(), lengths.end());
    float line_m = lengths.back();
    double shorter = 0.0;
    for (float length : lengths) {
        shorter += double(length);
        if (shorter >= double(k_short_stem_share) * total) {
            line_m = length;
            break;
        }
    }
    std::vector<uint32_t> counts(stems.size(), 1);
    for (int attempt = 0; attempt < 24; ++attempt, line_m *= 0.7f) {
        std::vector<uint32_t> wanted;
        size_t line_count = 0;
        for (const StemRange& stem : stems) {
            wanted.push_back(uint32_t(std::clamp(stem.length_m / line_m + 0.5f, 1.0f, 1e6f)));
            line_count += wanted.back();
        }
        if (line_count > line_limit) break;
        counts = std::move(wanted);
        double bent = 0.0;
        for (size_t i = 0; i < stems.size(); ++i)
            bent += bent_length(segments, stems[i], resample(segments, stems[i], counts[i]));
        if (bent <= double(k_bent_share) * total) break;
    }
    return counts;
}

// What the triangles around a segment look like.
struct Surroundings {
    double area = 0.0;
    dvec3 color{0}, normal{0};  // area-weighted sums
};

}  // namespace

std::vector<StemRange> find_stems(const std::vector<SkeletonSegment>& segments) {
    std::vector<StemRange> stems;
    for (uint32_t s = 0; s < segments.size(); ++s) {
        bool goes_on = s > 0 && segments[s].stem == segments[s - 1].stem &&
                       segments[s].begin_plant == segments[s - 1].end_plant;
        if (!goes_on) stems.push_back({s, s, 0.0f});
        stems.back().last = s + 1;
        stems.back().length_m += length_of(segments[s]);
    }
    return stems;
}

TracedLines trace_lines(const PartDescription& part, const TracedSkeleton& skeleton) {
    const auto& segments = skeleton.segments;
    std::vector<double> areas = triangle_areas(part);
    std::vector<StemRange> stems = find_stems(segments);
    TracedLines traced;
    if (stems.empty()) return traced;
    std::vector<uint32_t> counts =
        choose_piece_counts(segments, stems, std::max(stems.size(), areas.size() / 2));

    std::vector<Surroundings> around(segments.size());
    for (size_t t = 0; t < areas.size(); ++t) {
        Surroundings& here = around[skeleton.triangle_segment[t]];
        here.area += areas[t];
        for (size_t k = 0; k < 3; ++k) {
            const DescriptionVertex& v = part.vertices[part.indices[3 * t + k]];
            here.color += dvec3(v.color_linear) * (areas[t] / 3.0);
            here.normal += dvec3(v.normal_plant) * (areas[t] / 3.0);
        }
    }
    std::vector<uint32_t> first_line{0}, stem_of_segment(segments.size());
    for (size_t i = 0; i < stems.size(); ++i) {
        const StemRange& stem = stems[i];
        std::vector<vec3> points = resample(segments, stem, counts[i]);
        uint32_t at = stem.first;
        float before = 0.0f;
        for (uint32_t piece = 0; piece < counts[i]; ++piece) {
            // All segments the piece touches.
            float end = stem.length_m * float(piece + 1) / float(counts[i]);
            Surroundings sum;
            dvec3 skeleton_color(0);
            double skeleton_length = 0.0;
            for (;;) {
                sum.area += around[at].area;
                sum.color += around[at].color;
                sum.normal += around[at].normal;
                skeleton_color += dvec3(segments[at].color_linear) * double(length_of(segments[at]));
                skeleton_length += double(length_of(segments[at]));
                if (at + 1 >= stem.last || before + length_of(segments[at]) > end) break;
                before += length_of(segments[at++]);
            }
            TracedLine line{points[piece], points[piece + 1], vec3(0), vec3(0)};
            if (line.begin_plant == line.end_plant) continue;
            line.color_linear = vec3(sum.area > 0.0 ? sum.color * (1.0 / sum.area)
                                                    : skeleton_color * (1.0 / skeleton_length));
            double facing = std::sqrt(glm::dot(sum.normal, sum.normal));
            if (facing > double(k_facing_share) * sum.area && sum.area > 0.0)
                line.normal_plant = normalize_or(vec3(sum.normal * (1.0 / facing)), vec3(0));
            traced.lines.push_back(line);
            vec3 along = line.end_plant - line.begin_plant;
            traced.length_m += std::sqrt(glm::dot(along, along));
        }
        first_line.push_back(uint32_t(traced.lines.size()));
        for (uint32_t s = stem.first; s < stem.last; ++s) stem_of_segment[s] = uint32_t(i);
    }

    std::vector<std::pair<float, uint32_t>> errors(areas.size());  // of each triangle: its farthest corner's
    parallel_for(areas.size(), 1 << 12, [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
            uint32_t stem = stem_of_segment[skeleton.triangle_segment[t]];
            float error = 0.0f;
            for (size_t k = 0; k < 3; ++k) {
                vec3 p = part.vertices[part.indices[3 * t + k]].position_plant;
                float nearest = INFINITY;
                for (uint32_t l = first_line[stem]; l < first_line[stem + 1]; ++l)
                    nearest = std::min(nearest, distance_to_segment(p, traced.lines[l].begin_plant,
                                                                    traced.lines[l].end_plant));
                if (nearest < INFINITY) error = std::max(error, nearest);
            }
            errors[t] = {error, uint32_t(t)};
        }
    });
    std::sort(errors.begin(), errors.end());
    double total_area = 0.0, covered = 0.0;
    for (double area : areas) total_area += area;
    for (auto [error, t] : errors) {
        traced.error_m = error;
        covered += areas[t];
        if (covered >= double(k_error_share) * total_area) break;
    }
    traced.largest_error_m = errors.empty() ? 0.0f : errors.back().first;
    return traced;
}

}  // namespace coppice
