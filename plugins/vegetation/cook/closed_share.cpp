#include "plugins/vegetation/cook/closed_share.h"

#include <algorithm>

namespace coppice {

float closed_share(const PartDescription& part, const std::vector<uint32_t>& welded) {
    struct Edge {
        uint64_t key;      // lower corner, higher corner
        uint32_t forward;  // 1: the triangle walks it from the lower to the higher
    };
    std::vector<Edge> edges;
    edges.reserve(part.indices.size());
    for (size_t i = 0; i < part.indices.size(); ++i) {
        uint32_t a = welded[part.indices[i]], b = welded[part.indices[i % 3 == 2 ? i - 2 : i + 1]];
        edges.push_back({uint64_t(std::min(a, b)) << 32 | std::max(a, b), a < b});
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return a.key != b.key ? a.key < b.key : a.forward < b.forward;
    });
    double length_m = 0.0, closed_m = 0.0;
    for (size_t first = 0, last; first < edges.size(); first = last) {
        uint32_t forward = 0;
        for (last = first; last < edges.size() && edges[last].key == edges[first].key; ++last)
            forward += edges[last].forward;
        dvec3 along = dvec3(part.vertices[edges[first].key >> 32].position_plant) -
                      dvec3(part.vertices[uint32_t(edges[first].key)].position_plant);
        double edge_m = std::sqrt(glm::dot(along, along));
        length_m += edge_m;
        if (last - first == 2 && forward == 1) closed_m += edge_m;
    }
    return length_m > 0.0 ? float(closed_m / length_m) : 0.0f;
}

}  // namespace coppice
