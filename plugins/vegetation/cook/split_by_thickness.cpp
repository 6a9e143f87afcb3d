#include "plugins/vegetation/cook/split_by_thickness.h"

#include <algorithm>
#include "plugins/vegetation/cook/trace_lines.h"
#include "plugins/vegetation/cook/triangle_areas.h"

namespace coppice {
namespace {

constexpr float k_least_range = 4.0f;
constexpr float k_class_range = 4.0f;  // of radii in one class
constexpr uint32_t k_class_limit = 3;
constexpr size_t k_least_triangles = 64;

float radius_of(const SkeletonSegment& s) { return 0.5f * (s.begin_radius_m + s.end_radius_m); }

// The triangles and segments of one class, without the vertices it does not use.
SlenderPart take_class(const SlenderPart& whole, const std::vector<uint32_t>& class_of_segment,
                       uint32_t thickness) {
    SlenderPart piece;
    piece.part.name =
        thickness == 0 ? whole.part.name : whole.part.name + "/" + std::to_string(1u << 2 * thickness);
    piece.part.kind = whole.part.kind;
    piece.part.leaf = whole.part.leaf;
    piece.part.importance = whole.part.importance;
    std::vector<uint32_t> new_segment(whole.skeleton.segments.size());
    for (size_t s = 0; s < new_segment.size(); ++s) {
        new_segment[s] = uint32_t(piece.skeleton.segments.size());
        if (class_of_segment[s] == thickness) piece.skeleton.segments.push_back(whole.skeleton.segments[s]);
    }
    constexpr uint32_t k_unused = UINT32_MAX;
    std::vector<uint32_t> new_vertex(whole.part.vertices.size(), k_unused);
    for (size_t t = 0; t < whole.skeleton.triangle_segment.size(); ++t) {
        uint32_t segment = whole.skeleton.triangle_segment[t];
        if (class_of_segment[segment] != thickness) continue;
        piece.skeleton.triangle_segment.push_back(new_segment[segment]);
        for (size_t k = 0; k < 3; ++k) {
            uint32_t v = whole.part.indices[3 * t + k];
            if (new_vertex[v] == k_unused) {
                new_vertex[v] = uint32_t(piece.part.vertices.size());
                piece.part.vertices.push_back(whole.part.vertices[v]);
            }
            piece.part.indices.push_back(new_vertex[v]);
        }
    }
    return piece;
}

}  // namespace

std::vector<SlenderPart> split_by_thickness(SlenderPart whole) {
    const auto& segments = whole.skeleton.segments;
    std::vector<double> areas = triangle_areas(whole.part);
    std::vector<std::pair<float, uint32_t>> radii;  // of triangles
    double total_area = 0.0;
    for (uint32_t t = 0; t < areas.size(); ++t) {
        radii.push_back({radius_of(segments[whole.skeleton.triangle_segment[t]]), t});
        total_area += areas[t];
    }
    std::sort(radii.begin(), radii.end());
    auto quantile = [&](double share) {
        double covered = 0.0;
        for (auto [radius, t] : radii) {
            covered += areas[t];
            if (covered >= share * total_area) return radius;
        }
        return radii.empty() ? 0.0f : radii.back().first;
    };
    float thinnest = quantile(0.01), thickest = quantile(0.99);
    std::vector<SlenderPart> pieces;
    if (!(thickest > k_least_range * thinnest) || !(thinnest > 0.0f)) {
        pieces.push_back(std::move(whole));
        return pieces;
    }

    std::vector<uint32_t> thickness(segments.size(), 0);
    for (size_t s = 0; s < segments.size(); ++s) {
        float limit = thickest / k_class_range;
        while (thickness[s] + 1 < k_class_limit && radius_of(segments[s]) <= limit) {
            ++thickness[s];
            limit /= k_class_range;
        }
    }
    // A stretch shorter than it is thick is a wobble of the measured radius: it follows what comes before it.
    for (const StemRange& stem : find_stems(segments)) {
        for (uint32_t first = stem.first, last; first < stem.last; first = last) {
            float length_m = 0.0f, radius_m = 0.0f;
            for (last = first; last < stem.last && thickness[last] == thickness[first]; ++last) {
                vec3 along = segments[last].end_plant - segments[last].begin_plant;
                length_m += std::sqrt(glm::dot(along, along));
                radius_m = std::max(radius_m, radius_of(segments[last]));
            }
            if (first > stem.first && length_m < 2.0f * radius_m)
                for (uint32_t s = first; s < last; ++s) thickness[s] = thickness[first - 1];
        }
    }
    // Few triangles are not worth a part of their own; they join the next thicker ones, whose lines come
    // later.
    uint32_t triangle_count[k_class_limit] = {};
    for (uint32_t segment : whole.skeleton.triangle_segment) ++triangle_count[thickness[segment]];
    size_t worth = std::max<size_t>(k_least_triangles, areas.size() / 20);
    uint32_t joined[k_class_limit];
    for (uint32_t o = 0; o < k_class_limit; ++o)
        joined[o] = o > 0 && triangle_count[o] < worth ? joined[o - 1] : o;
    for (uint32_t& o : thickness) o = joined[o];
    for (uint32_t o = 0; o < k_class_limit; ++o) {
        SlenderPart piece = take_class(whole, thickness, o);
        if (!piece.part.indices.empty()) pieces.push_back(std::move(piece));
    }
    return pieces;
}

}  // namespace coppice
