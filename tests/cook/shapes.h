// Meshes whose areas, projections and centre lines are known.
#pragma once
#include <functional>
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/random.h"

namespace coppice::shapes {

inline uint32_t add_vertex(PartDescription& part, vec3 position, vec3 normal,
                           vec3 color = vec3(0.1f, 0.3f, 0.05f)) {
    part.vertices.push_back({position, normal, color});
    return uint32_t(part.vertices.size() - 1);
}

inline void add_triangle(PartDescription& part, vec3 a, vec3 b, vec3 c,
                         vec3 color = vec3(0.1f, 0.3f, 0.05f)) {
    vec3 normal = normalize_or(glm::cross(b - a, c - a), vec3(0, 1, 0));
    for (vec3 p : {a, b, c}) part.indices.push_back(add_vertex(part, p, normal, color));
}

inline void add_quad(PartDescription& part, vec3 corner, vec3 u, vec3 v,
                     vec3 color = vec3(0.1f, 0.3f, 0.05f)) {
    add_triangle(part, corner, corner + u, corner + u + v, color);
    add_triangle(part, corner, corner + u + v, corner + v, color);
}

inline vec3 random_direction(Random& random) {
    float y = random.next_in(-1, 1), around = random.next_in(0, 2 * k_pi), r = std::sqrt(1 - y * y);
    return {r * portable_cos(around), y, r * portable_sin(around)};
}

// Square leaves of side_m, anywhere in a ball of radius_m about center, turned any way.
inline PartDescription leaf_cloud(uint32_t leaf_count, float radius_m, float side_m, uint64_t seed,
                                  vec3 center = vec3(0, 5, 0)) {
    PartDescription part;
    part.name = "leaf";
    part.leaf = true;
    Random random(seed);
    for (uint32_t i = 0; i < leaf_count; ++i) {
        vec3 outwards = random_direction(random);  // one after the other: operands have no order
        vec3 place = center + outwards * (radius_m * portable_pow(random.next_unit(), 1.0f / 3));
        vec3 normal = random_direction(random);
        vec3 u = rotate_about(perpendicular_to(normal), normal, random.next_in(0, 2 * k_pi));
        add_quad(part, place, u * side_m, glm::cross(normal, u) * side_m);
    }
    return part;
}

// A tube along the points of a polyline, radius by point, open at its ends. sides corners a ring.
inline void add_tube(PartDescription& part, const std::vector<vec3>& points, const std::vector<float>& radii,
                     uint32_t sides = 8, vec3 color = vec3(0.15f, 0.1f, 0.06f)) {
    std::vector<uint32_t> rings;
    vec3 across = perpendicular_to(normalize_or(points[1] - points[0], vec3(0, 1, 0)));
    for (size_t i = 0; i < points.size(); ++i) {
        vec3 along = normalize_or(points[std::min(i + 1, points.size() - 1)] - points[i > 0 ? i - 1 : 0],
                                  vec3(0, 1, 0));
        across = normalize_or(across - along * glm::dot(across, along), perpendicular_to(along));
        for (uint32_t s = 0; s < sides; ++s) {
            vec3 out = rotate_about(across, along, 2 * k_pi * float(s) / float(sides));
            rings.push_back(add_vertex(part, points[i] + out * radii[i], out, color));
        }
    }
    for (uint32_t i = 0; i + 1 < points.size(); ++i)
        for (uint32_t s = 0; s < sides; ++s) {
            uint32_t a = rings[i * sides + s], b = rings[i * sides + (s + 1) % sides];
            uint32_t c = rings[(i + 1) * sides + s], d = rings[(i + 1) * sides + (s + 1) % sides];
            for (uint32_t v : {a, b, d, a, d, c}) part.indices.push_back(v);
        }
}

inline std::vector<vec3> straight_path(vec3 from, vec3 to, uint32_t ring_count) {
    std::vector<vec3> path;
    for (uint32_t i = 0; i < ring_count; ++i)
        path.push_back(from + (to - from) * (float(i) / float(ring_count - 1)));
    return path;
}

inline PartDescription sphere(uint32_t rings, uint32_t sides, float radius_m) {
    PartDescription part;
    part.name = "fruit";
    auto at = [&](uint32_t ring, uint32_t side) {
        float tilt = k_pi * float(ring) / float(rings),
              around = 2 * k_pi * float(side % sides) / float(sides);
        float r = ring == 0 || ring == rings ? 0.0f : portable_sin(tilt);
        return vec3(r * portable_cos(around),
                    ring == 0       ? 1.0f
                    : ring == rings ? -1.0f
                                    : portable_cos(tilt),
                    r * portable_sin(around)) *
               radius_m;
    };
    for (uint32_t r = 0; r < rings; ++r)
        for (uint32_t s = 0; s < sides; ++s) {
            if (r + 1 < rings) add_triangle(part, at(r, s), at(r + 1, s + 1), at(r + 1, s));
            if (r > 0) add_triangle(part, at(r, s), at(r, s + 1), at(r + 1, s + 1));
        }
    return part;
}

// A closed tree-like skin: the smooth union of cones, as an implicit surface cut into triangles on a grid
// (marching tetrahedra), so that branches and trunk are one connected mesh with junctions.
PartDescription skin_of(const std::function<float(vec3)>& inside_distance, Box box, float cell_m);

}  // namespace coppice::shapes
