#include "plugins/vegetation/cook/import/find_elements.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

namespace coppice {
namespace {

uint32_t find_root(std::vector<uint32_t>& parents, uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

void join(std::vector<uint32_t>& parents, uint32_t a, uint32_t b) {
    a = find_root(parents, a);
    b = find_root(parents, b);
    parents[std::max(a, b)] = std::min(a, b);
}

}  // namespace

void find_elements(ImportMesh& mesh) {
    const auto& p = mesh.positions_plant;
    std::vector<uint32_t> parents(p.size()), order(p.size());
    std::iota(parents.begin(), parents.end(), 0u);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&p](uint32_t a, uint32_t b) {
        return std::tie(p[a].x, p[a].y, p[a].z, a) < std::tie(p[b].x, p[b].y, p[b].z, b);
    });
    for (size_t i = 1; i < order.size(); ++i)
        if (p[order[i]] == p[order[i - 1]]) join(parents, order[i], order[i - 1]);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        join(parents, mesh.indices[i], mesh.indices[i + 1]);
        join(parents, mesh.indices[i], mesh.indices[i + 2]);
    }
    std::vector<uint32_t> number_of_root(p.size(), UINT32_MAX);
    mesh.elements.resize(mesh.triangle_count());
    mesh.element_count = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        uint32_t& number = number_of_root[find_root(parents, mesh.indices[t * 3])];
        if (number == UINT32_MAX) number = mesh.element_count++;
        mesh.elements[t] = number;
    }
}

}  // namespace coppice
