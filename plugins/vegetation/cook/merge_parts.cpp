#include "plugins/vegetation/cook/merge_parts.h"

#include <algorithm>
#include <array>
#include <cassert>
#include "plugins/vegetation/cook/oklab.h"

namespace coppice {
namespace {

constexpr uint32_t k_class_count = 16;
constexpr float k_octave = 0.1f;  // twice as thick or as important is as far as this distance in OKLab

// Parts of different classes never join: they are drawn by other rules.
uint32_t class_of(const CookPart& part) {
    const PartDescription& mesh = part.shape.part;
    return (mesh.kind == PartKind::lines ? 8u : 0u) | (mesh.leaf ? 4u : 0u) | (part.closed ? 2u : 0u) |
           (mesh.importance > 0.0f ? 1u : 0u);
}

float octaves(double value) { return k_octave * portable_log2(float(std::clamp(value, 1e-6, 1e6))); }

// What is compared: the distance between two of these says how unlike their parts are.
struct Looks {
    vec3 color_oklab;
    float thickness = 0.0f, importance = 0.0f;
};

Looks looks_of(const CookPart& part) {
    Looks looks{to_oklab(part.mean_color_linear)};
    double length_m = 0.0;
    for (const SkeletonSegment& segment : part.shape.skeleton.segments) {
        vec3 along = segment.end_plant - segment.begin_plant;
        length_m += double(std::sqrt(glm::dot(along, along)));
    }
    if (length_m > 0.0) looks.thickness = octaves(part.area_m2 / length_m);
    if (part.shape.part.importance > 0.0f) looks.importance = octaves(double(part.shape.part.importance));
    return looks;
}

float square_between(const Looks& a, const Looks& b) {
    vec3 color = a.color_oklab - b.color_oklab;
    float thickness = a.thickness - b.thickness, importance = a.importance - b.importance;
    return glm::dot(color, color) + thickness * thickness + importance * importance;
}

// For each part the part it joins; those that stand join themselves.
std::vector<uint32_t> choose_hosts(const std::vector<CookPart>& parts, uint32_t part_limit) {
    std::vector<Looks> looks;
    std::vector<uint32_t> classes;
    for (const CookPart& part : parts) {
        looks.push_back(looks_of(part));
        classes.push_back(class_of(part));
    }
    std::vector<float> nearest(parts.size(), INFINITY);  // squared distance to its host
    std::vector<uint32_t> host(parts.size(), 0);
    auto stand = [&](uint32_t chosen) {
        for (uint32_t i = 0; i < parts.size(); ++i) {
            if (classes[i] != classes[chosen]) continue;
            float square = i == chosen ? -1.0f : square_between(looks[i], looks[chosen]);
            if (square < nearest[i]) {
                nearest[i] = square;
                host[i] = chosen;
            }
        }
    };
    uint32_t standing_count = 0;
    std::array<int64_t, k_class_count> largest;
    largest.fill(-1);
    for (uint32_t i = 0; i < parts.size(); ++i) {
        int64_t& best = largest[classes[i]];
        if (best < 0 || parts[i].area_m2 > parts[size_t(best)].area_m2) best = i;
    }
    for (int64_t best : largest)
        if (best >= 0) {
            stand(uint32_t(best));
            ++standing_count;
        }
    // Then whoever would lose most by joining: its area by how unlike its host it is.
    for (; standing_count < part_limit; ++standing_count) {
        double most = 0.0;
        uint32_t chosen = 0;
        for (uint32_t i = 0; i < parts.size(); ++i)
            if (double loss = parts[i].area_m2 * double(nearest[i]); loss > most) {
                most = loss;
                chosen = i;
            }
        if (!(most > 0.0)) break;
        stand(chosen);
    }
    return host;
}

void join(CookPart& into, CookPart& from) {
    PartDescription &mesh = into.shape.part, &more = from.shape.part;
    TracedSkeleton &skeleton = into.shape.skeleton, &more_skeleton = from.shape.skeleton;
    double area_m2 = into.area_m2 + from.area_m2;
    auto mean = [&](auto a, auto b) { return (a * into.area_m2 + b * from.area_m2) * (1.0 / area_m2); };
    into.mean_color_linear = vec3(mean(dvec3(into.mean_color_linear), dvec3(from.mean_color_linear)));
    mesh.importance = float(mean(double(mesh.importance), double(more.importance)));
    into.area_m2 = area_m2;

    uint32_t first_vertex = uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
    for (uint32_t index : more.indices) mesh.indices.push_back(first_vertex + index);
    mesh.element_first_triangle.clear();

    uint32_t first_segment = uint32_t(skeleton.segments.size());
    uint32_t first_stem = skeleton.segments.empty() ? 0 : skeleton.segments.back().stem + 1;
    uint32_t own_first_stem = more_skeleton.segments.empty() ? 0 : more_skeleton.segments.front().stem;
    for (SkeletonSegment segment : more_skeleton.segments) {
        segment.stem += first_stem - own_first_stem;  // the first one differs from the last one before it
        skeleton.segments.push_back(segment);
    }
    for (uint32_t segment : more_skeleton.triangle_segment)
        skeleton.triangle_segment.push_back(first_segment + segment);
    from = CookPart();
}

}  // namespace

std::vector<CookPart> merge_parts(std::vector<CookPart> parts, uint32_t part_limit) {
    assert(part_limit >= k_class_count && "each class keeps a part");
    if (parts.size() <= part_limit) return parts;
    std::vector<uint32_t> host = choose_hosts(parts, part_limit);
    for (uint32_t i = 0; i < parts.size(); ++i)
        if (host[i] != i) join(parts[host[i]], parts[i]);
    std::vector<CookPart> merged;
    for (uint32_t i = 0; i < parts.size(); ++i)
        if (host[i] == i) merged.push_back(std::move(parts[i]));
    return merged;
}

}  // namespace coppice
