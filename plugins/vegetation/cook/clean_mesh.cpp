#include "plugins/vegetation/cook/clean_mesh.h"

#include <algorithm>
#include <fmt/format.h>

namespace coppice {
namespace {

constexpr double k_flatness = 1e-7;  // height of a triangle over its longest edge, under which it has no area

bool usable_position(vec3 p) {
    return std::fabs(p.x) <= k_position_limit_m && std::fabs(p.y) <= k_position_limit_m &&
           std::fabs(p.z) <= k_position_limit_m;  // false for NaN
}

float usable_color(float c) { return c == c ? std::clamp(c, 0.0f, 1.0f) : 0.5f; }

bool beyond_limit(vec3 p) { return is_finite(p) && !usable_position(p); }

bool has_area(vec3 a, vec3 b, vec3 c) {
    if (!usable_position(a) || !usable_position(b) || !usable_position(c)) return false;
    dvec3 n = doubled_area_vector(a, b, c);
    dvec3 ab = dvec3(b) - dvec3(a), bc = dvec3(c) - dvec3(b), ca = dvec3(a) - dvec3(c);
    double longest_square = std::max({glm::dot(ab, ab), glm::dot(bc, bc), glm::dot(ca, ca)});
    // Also not what a float cannot hold later: areas are stored as float.
    return glm::dot(n, n) > k_flatness * k_flatness * longest_square * longest_square &&
           glm::dot(n, n) > 1e-60;
}

}  // namespace

dvec3 doubled_area_vector(vec3 a, vec3 b, vec3 c) {
    dvec3 u = dvec3(b) - dvec3(a), v = dvec3(c) - dvec3(a);
    return dvec3(u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x);
}

Result<PartDescription> clean_mesh(const PartDescription& part, const std::string& plant_name,
                                   const std::string& place, CleanCounts& counts) {
    auto wrong = [&](std::string fault, std::string remedy) {
        return fail(ErrorId::value_out_of_range, plant_name, place, std::move(fault), std::move(remedy));
    };
    if (part.vertices.size() > UINT32_MAX / 4 || part.indices.size() > UINT32_MAX / 4)
        return fail(ErrorId::limit_exceeded, plant_name, place, "more than 2^30 vertices or indices",
                    "split the plant");
    if (part.indices.size() % 3 != 0)
        return wrong(fmt::format("{} indices", part.indices.size()), "three a triangle");
    for (size_t i = 0; i < part.indices.size(); ++i)
        if (part.indices[i] >= part.vertices.size())
            return wrong(fmt::format("index {} is {}", i, part.indices[i]),
                         fmt::format("the part has {} vertices", part.vertices.size()));
    uint32_t triangle_count = uint32_t(part.indices.size() / 3);
    const auto& elements = part.element_first_triangle;
    if (!elements.empty() && (elements.front() != 0 || elements.back() != triangle_count ||
                              !std::is_sorted(elements.begin(), elements.end())))
        return wrong("the ranges of elements do not cover its triangles",
                     "start with 0, never decrease, end with the number of triangles");
    if (!(part.importance >= 0.0f && part.importance <= 1e6f))
        return wrong("importance is not in [0, 10^6]", "0 lets the cook decide");

    PartDescription clean;
    clean.name = part.name;
    clean.kind = part.kind;
    clean.leaf = part.leaf;
    clean.importance = part.importance;
    clean.indices.reserve(part.indices.size());
    std::vector<uint32_t> kept_before(triangle_count + 1, 0);
    constexpr uint32_t k_unused = UINT32_MAX;
    std::vector<uint32_t> new_index(part.vertices.size(), k_unused);
    for (uint32_t t = 0; t < triangle_count; ++t) {
        const uint32_t* corner = &part.indices[3 * size_t(t)];
        for (int k = 0; k < 3; ++k)
            if (vec3 p = part.vertices[corner[k]].position_plant; beyond_limit(p))
                return wrong(
                    fmt::format("position {} is ({}, {}, {})", corner[k], p.x, p.y, p.z),
                    fmt::format("metres, at most {} km from the origin", k_position_limit_m * 1e-3f));
        bool keep = has_area(part.vertices[corner[0]].position_plant, part.vertices[corner[1]].position_plant,
                             part.vertices[corner[2]].position_plant);
        kept_before[t + 1] = kept_before[t] + keep;
        if (!keep) continue;
        for (int k = 0; k < 3; ++k) {
            clean.indices.push_back(corner[k]);
            new_index[corner[k]] = 0;
        }
    }
    clean.vertices.reserve(part.vertices.size());
    for (size_t v = 0; v < part.vertices.size(); ++v) {
        if (new_index[v] == k_unused) continue;
        new_index[v] = uint32_t(clean.vertices.size());
        DescriptionVertex vertex = part.vertices[v];
        vertex.normal_plant = normalize_or(vertex.normal_plant, vec3(0));
        vertex.color_linear = {usable_color(vertex.color_linear.x), usable_color(vertex.color_linear.y),
                               usable_color(vertex.color_linear.z)};
        clean.vertices.push_back(vertex);
    }
    for (uint32_t& index : clean.indices) index = new_index[index];
    for (size_t i = 0; i < clean.indices.size(); i += 3) {
        DescriptionVertex* corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = &clean.vertices[clean.indices[i + k]];
        vec3 face(0);
        for (DescriptionVertex* vertex : corner) {
            if (vertex->normal_plant != vec3(0)) continue;
            if (face == vec3(0)) {
                dvec3 n = doubled_area_vector(corner[0]->position_plant, corner[1]->position_plant,
                                              corner[2]->position_plant);
                face = normalize_or(vec3(n * (1.0 / std::sqrt(glm::dot(n, n)))), vec3(0, 1, 0));
            }
            vertex->normal_plant = face;
        }
    }
    for (uint32_t first : elements) clean.element_first_triangle.push_back(kept_before[first]);
    for (SkeletonSegment segment : part.skeleton) {
        if (!usable_position(segment.begin_plant) || !usable_position(segment.end_plant)) continue;
        if (segment.begin_plant == segment.end_plant) continue;
        auto usable_radius = [](float r) { return r >= 0.0f && r <= k_position_limit_m ? r : 0.0f; };
        segment.begin_radius_m = usable_radius(segment.begin_radius_m);
        segment.end_radius_m = usable_radius(segment.end_radius_m);
        for (int c = 0; c < 3; ++c) segment.color_linear[c] = usable_color(segment.color_linear[c]);
        clean.skeleton.push_back(segment);
    }
    counts.dropped_triangles += triangle_count - kept_before[triangle_count];
    counts.dropped_vertices += uint32_t(part.vertices.size() - clean.vertices.size());
    return clean;
}

}  // namespace coppice
