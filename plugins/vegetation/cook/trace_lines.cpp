#include "plugins/vegetation/cook/trace_lines.h"

#include <algorithm>
#include <span>
#include "plugins/vegetation/cook/triangle_areas.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr float k_error_share = 0.995f;   // of the surface, that eps_l covers
constexpr float k_bend_tolerance = 0.5f;  // of the radius; lines begin where that is a quarter of a pixel
constexpr float k_short_share = 0.25f;    // of the length may be in lines shorter than the others
constexpr float k_facing_share = 0.3f;    // |sum of a n| / sum of a, from where a surface faces one way

float length_of(const SkeletonSegment& s) {
    vec3 along = s.end_plant - s.begin_plant;
    return std::sqrt(glm::dot(along, along));
}

// A place on a stem where it is cut.
struct Cut {
    float along_m;  // from the stem's beginning
    vec3 position_plant;
};

// The stem's ends and the bends that lines must not leave out (Douglas and Peucker).
std::vector<Cut> find_bends(const std::vector<SkeletonSegment>& segments, const StemRange& stem) {
    uint32_t joint_count = stem.last - stem.first + 1;
    auto joint = [&](uint32_t i) {
        return i == 0 ? segments[stem.first].begin_plant : segments[stem.first + i - 1].end_plant;
    };
    std::vector<bool> kept(joint_count, false);
    kept.front() = kept.back() = true;
    std::vector<std::pair<uint32_t, uint32_t>> open{{0, joint_count - 1}};
    while (!open.empty()) {
        auto [first, last] = open.back();
        open.pop_back();
        uint32_t worst = first;
        float worst_excess = 0.0f;
        for (uint32_t i = first + 1; i < last; ++i) {
            float off = distance_to_segment(joint(i), joint(first), joint(last));
            float excess = off - k_bend_tolerance * segments[stem.first + i - 1].end_radius_m;
            if (excess > worst_excess) {
                worst_excess = excess;
                worst = i;
            }
        }
        if (worst == first) continue;
        kept[worst] = true;
        open.push_back({first, worst});
        open.push_back({worst, last});
    }
    std::vector<Cut> cuts;
    float along = 0.0f;
    for (uint32_t i = 0; i < joint_count; ++i) {
        if (i > 0) along += length_of(segments[stem.first + i - 1]);
        if (kept[i]) cuts.push_back({along, joint(i)});
    }
    return cuts;
}

uint32_t piece_count(float length_m, float line_m) {
    return uint32_t(std::clamp(length_m / line_m + 0.5f, 1.0f, 1e6f));
}

// More cuts, evenly between the bends, so that lines are about line_m long.
std::vector<Cut> add_cuts(const std::vector<SkeletonSegment>& segments, const StemRange& stem,
                          const std::vector<Cut>& bends, float line_m) {
    std::vector<Cut> cuts{bends.front()};
    float before = 0.0f;
    uint32_t at = stem.first;
    for (size_t b = 1; b < bends.size(); ++b) {
        float from = bends[b - 1].along_m, length = bends[b].along_m - from;
        uint32_t count = piece_count(length, line_m);
        for (uint32_t i = 1; i < count; ++i) {
            float along = from + length * float(i) / float(count);
            while (at + 1 < stem.last && before + length_of(segments[at]) < along)
                before += length_of(segments[at++]);
            float share = std::clamp((along - before) / length_of(segments[at]), 0.0f, 1.0f);
            cuts.push_back({along, segments[at].begin_plant +
                                       (segments[at].end_plant - segments[at].begin_plant) * share});
        }
        cuts.push_back(bends[b]);
    }
    return cuts;
}

// The length of line that a quarter of the whole length does not reach between its bends, or longer to stay
// within the limit on their number.
float choose_line_length(const std::vector<std::vector<Cut>>& bends, size_t line_limit) {
    std::vector<float> lengths;
    double total = 0.0;
    for (const std::vector<Cut>& stem : bends)
        for (size_t b = 1; b < stem.size(); ++b) {
            lengths.push_back(stem[b].along_m - stem[b - 1].along_m);
            total += double(lengths.back());
        }
    std::sort(lengths.begin(), lengths.end());
    float line_m = lengths.back();
    double shorter = 0.0;
    for (float length : lengths) {
        shorter += double(length);
        if (shorter >= double(k_short_share) * total) {
            line_m = length;
            break;
        }
    }
    for (;; line_m *= 1.25f) {
        size_t line_count = 0;
        for (float length : lengths) line_count += piece_count(length, line_m);
        if (line_count <= std::max(line_limit, lengths.size())) return line_m;
    }
}

// What the triangles around a segment look like.
struct Surroundings {
    double area = 0.0;
    dvec3 color{0}, normal{0};  // area-weighted sums
};

double stem_area(const std::vector<Surroundings>& around, const StemRange& stem) {
    double area_m2 = 0.0;
    for (uint32_t s = stem.first; s < stem.last; ++s) area_m2 += around[s].area;
    return area_m2;
}

// From radii to widths whose lines cover the stem's surface: the skeleton knows the taper, the mesh how much there is.
void widen_by_area(std::span<TracedLine> stem, double area_m2) {
    double covered = 0.0, length_m = 0.0;
    for (const TracedLine& line : stem) {
        vec3 along = line.end_plant - line.begin_plant;
        double line_m = double(std::sqrt(glm::dot(along, along)));
        covered += double(line.width_share) * line_m;
        length_m += line_m;
    }
    for (TracedLine& line : stem)
        line.width_share = covered > 0.0 ? float(double(line.width_share) * (area_m2 / covered))
                                         : float(area_m2 / std::max(length_m, 1e-30));
}

// From widths in m to shares of the mean, which stays 1 over the length after the clamp.
void share_widths(TracedLines& traced) {
    auto scale_to_mean = [&traced] {
        double sum = 0.0;
        for (const TracedLine& line : traced.lines) {
            vec3 along = line.end_plant - line.begin_plant;
            sum += double(line.width_share) * double(std::sqrt(glm::dot(along, along)));
        }
        double mean = sum / std::max(double(traced.length_m), 1e-30);
        for (TracedLine& line : traced.lines)
            line.width_share = mean > 0.0 ? float(line.width_share / mean) : 1.0f;
    };
    scale_to_mean();
    for (TracedLine& line : traced.lines) line.width_share = std::clamp(line.width_share, 0.1f, 6.0f);
    scale_to_mean();
}

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
    std::vector<std::vector<Cut>> bends;
    for (const StemRange& stem : stems) bends.push_back(find_bends(segments, stem));
    float line_m = choose_line_length(bends, areas.size() * 2 / 3);

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
        std::vector<Cut> cuts = add_cuts(segments, stem, bends[i], line_m);
        uint32_t at = stem.first;
        float before = 0.0f;
        for (size_t piece = 0; piece + 1 < cuts.size(); ++piece) {
            // All segments the piece touches.
            Surroundings sum;
            dvec3 skeleton_color(0);
            double skeleton_length = 0.0, radius_length = 0.0;
            for (;;) {
                float length = length_of(segments[at]);
                float shared = std::min(before + length, cuts[piece + 1].along_m) -
                               std::max(before, cuts[piece].along_m);
                float radius = 0.5f * (segments[at].begin_radius_m + segments[at].end_radius_m);
                radius_length += double(std::max(shared, 0.0f)) * double(radius);
                sum.area += around[at].area;
                sum.color += around[at].color;
                sum.normal += around[at].normal;
                skeleton_color += dvec3(segments[at].color_linear) * double(length_of(segments[at]));
                skeleton_length += double(length_of(segments[at]));
                if (at + 1 >= stem.last || before + length_of(segments[at]) > cuts[piece + 1].along_m) break;
                before += length_of(segments[at++]);
            }
            TracedLine line{cuts[piece].position_plant, cuts[piece + 1].position_plant, vec3(0), vec3(0),
                            0.0f};
            if (line.begin_plant == line.end_plant) continue;
            line.color_linear = vec3(sum.area > 0.0 ? sum.color * (1.0 / sum.area)
                                                    : skeleton_color * (1.0 / skeleton_length));
            double facing = std::sqrt(glm::dot(sum.normal, sum.normal));
            if (facing > double(k_facing_share) * sum.area && sum.area > 0.0)
                line.normal_plant = normalize_or(vec3(sum.normal * (1.0 / facing)), vec3(0));
            vec3 along = line.end_plant - line.begin_plant;
            float length_m = std::sqrt(glm::dot(along, along));
            line.width_share = float(radius_length) / length_m;
            traced.lines.push_back(line);
            traced.length_m += length_m;
        }
        widen_by_area(std::span(traced.lines).subspan(first_line.back()), stem_area(around, stem));
        first_line.push_back(uint32_t(traced.lines.size()));
        for (uint32_t s = stem.first; s < stem.last; ++s) stem_of_segment[s] = uint32_t(i);
    }

    share_widths(traced);

    traced.line_of_triangle.resize(traced.lines.empty() ? 0 : areas.size());
    std::vector<std::pair<float, uint32_t>> errors(areas.size());  // of each triangle: its farthest corner's
    parallel_for(areas.size(), 1 << 12, [&](size_t begin, size_t end) {
        for (size_t t = begin; t < end; ++t) {
            uint32_t stem = stem_of_segment[skeleton.triangle_segment[t]];
            float error = 0.0f;
            uint32_t nearest_line = std::min(first_line[stem], uint32_t(traced.lines.size()) - 1);
            for (size_t k = 0; k < 3; ++k) {
                vec3 p = part.vertices[part.indices[3 * t + k]].position_plant;
                float nearest = INFINITY;
                for (uint32_t l = first_line[stem]; l < first_line[stem + 1]; ++l) {
                    const float distance =
                        distance_to_segment(p, traced.lines[l].begin_plant, traced.lines[l].end_plant);
                    if (distance < nearest && k == 0) nearest_line = l;
                    nearest = std::min(nearest, distance);
                }
                if (nearest < INFINITY) error = std::max(error, nearest);
            }
            if (!traced.lines.empty()) traced.line_of_triangle[t] = nearest_line;
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
