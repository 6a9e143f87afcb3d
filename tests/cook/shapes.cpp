#include "tests/cook/shapes.h"

#include <map>

namespace coppice::shapes {

PartDescription skin_of(const std::function<float(vec3)>& inside_distance, Box box, float cell_m) {
    PartDescription part;
    part.name = "skin";
    glm::ivec3 side((box.size() * (1.0f / cell_m)) + vec3(1));
    auto corner_at = [&](glm::ivec3 c) { return box.min + vec3(c) * cell_m; };
    auto index_of = [&](glm::ivec3 c) { return (c.z * (side.y + 1) + c.y) * (side.x + 1) + c.x; };
    std::map<std::pair<int, int>, uint32_t> vertex_of_edge;
    auto vertex_between = [&](glm::ivec3 a, glm::ivec3 b) {
        int ia = index_of(a), ib = index_of(b);
        auto key = std::minmax(ia, ib);
        auto found = vertex_of_edge.find(key);
        if (found != vertex_of_edge.end()) return found->second;
        if (ia > ib) std::swap(a, b);
        float fa = inside_distance(corner_at(a)), fb = inside_distance(corner_at(b));
        vec3 p = corner_at(a) + (corner_at(b) - corner_at(a)) * (fa / (fa - fb));
        return vertex_of_edge[key] = add_vertex(part, p, vec3(0, 1, 0));
    };
    const glm::ivec3 walks[6][2] = {{{1, 0, 0}, {1, 1, 0}}, {{1, 0, 0}, {1, 0, 1}}, {{0, 1, 0}, {1, 1, 0}},
                                    {{0, 1, 0}, {0, 1, 1}}, {{0, 0, 1}, {1, 0, 1}}, {{0, 0, 1}, {0, 1, 1}}};
    for (int z = 0; z < side.z; ++z)
        for (int y = 0; y < side.y; ++y)
            for (int x = 0; x < side.x; ++x)
                for (const auto& walk : walks) {
                    glm::ivec3 base(x, y, z);
                    glm::ivec3 tet[4] = {base, base + walk[0], base + walk[1], base + glm::ivec3(1, 1, 1)};
                    std::vector<glm::ivec3> in, out;
                    for (glm::ivec3 c : tet) (inside_distance(corner_at(c)) > 0 ? in : out).push_back(c);
                    std::vector<uint32_t> polygon;
                    if (in.size() == 2)
                        polygon = {vertex_between(in[0], out[0]), vertex_between(in[0], out[1]),
                                   vertex_between(in[1], out[1]), vertex_between(in[1], out[0])};
                    else if (in.size() == 1 || in.size() == 3)
                        for (glm::ivec3 c : in.size() == 1 ? out : in)
                            polygon.push_back(vertex_between(c, in.size() == 1 ? in[0] : out[0]));
                    for (size_t i = 2; i < polygon.size(); ++i) {
                        uint32_t t[3] = {polygon[0], polygon[i - 1], polygon[i]};
                        vec3 a = part.vertices[t[0]].position_plant, b = part.vertices[t[1]].position_plant,
                             c = part.vertices[t[2]].position_plant;
                        vec3 outward = vec3(out[0] - in[0]);
                        if (glm::dot(glm::cross(b - a, c - a), outward) < 0) std::swap(t[1], t[2]);
                        for (uint32_t v : t) part.indices.push_back(v);
                    }
                }
    return part;
}

}  // namespace coppice::shapes
