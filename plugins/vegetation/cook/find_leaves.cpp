#include "plugins/vegetation/cook/find_leaves.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include "plugins/vegetation/cook/proxy_quad.h"

namespace coppice {
namespace {

using Corners = std::array<uint32_t, 3>;  // welded, ascending

std::vector<Corners> sorted_corners(const PartDescription& part, const std::vector<uint32_t>& welded) {
    std::vector<Corners> corners(part.indices.size() / 3);
    for (size_t t = 0; t < corners.size(); ++t) {
        for (size_t k = 0; k < 3; ++k) corners[t][k] = welded[part.indices[3 * t + k]];
        std::sort(corners[t].begin(), corners[t].end());
    }
    return corners;
}

// Whether each triangle is a repetition of an earlier one.
std::vector<bool> find_repeated(const std::vector<Corners>& corners) {
    std::vector<uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::tie(corners[a], a) < std::tie(corners[b], b); });
    std::vector<bool> repeated(corners.size(), false);
    for (size_t i = 1; i < order.size(); ++i) repeated[order[i]] = corners[order[i]] == corners[order[i - 1]];
    return repeated;
}

// For each triangle the first one of its leaf.
std::vector<uint32_t> find_groups(const PartDescription& part, const std::vector<Corners>& corners) {
    std::vector<uint32_t> group(corners.size());
    const std::vector<uint32_t>& elements = part.element_first_triangle;
    for (size_t i = 0; i + 1 < elements.size(); ++i)
        std::fill(group.begin() + elements[i], group.begin() + elements[i + 1], elements[i]);
    if (!elements.empty()) return group;

    std::vector<uint32_t> parents(part.vertices.size());
    std::iota(parents.begin(), parents.end(), 0u);
    auto root_of = [&parents](uint32_t i) {
        while (parents[i] != i) i = parents[i] = parents[parents[i]];
        return i;
    };
    for (const Corners& c : corners)
        for (size_t k = 1; k < 3; ++k) {
            const uint32_t a = root_of(c[0]), b = root_of(c[k]);
            parents[std::max(a, b)] = std::min(a, b);
        }
    constexpr uint32_t k_none = UINT32_MAX;
    std::vector<uint32_t> first_of_root(part.vertices.size(), k_none);
    for (uint32_t t = 0; t < corners.size(); ++t) {
        uint32_t& first = first_of_root[root_of(corners[t][0])];
        if (first == k_none) first = t;
        group[t] = first;
    }
    return group;
}

// No edge is the rim of a single triangle.
bool is_closed(const std::vector<Corners>& corners, std::span<const uint32_t> triangles) {
    std::vector<std::pair<uint32_t, uint32_t>> edges;
    for (uint32_t t : triangles)
        for (auto [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
            edges.emplace_back(corners[t][size_t(a)], corners[t][size_t(b)]);
    std::sort(edges.begin(), edges.end());
    for (size_t i = 0; i < edges.size(); ++i)
        if ((i == 0 || edges[i] != edges[i - 1]) && (i + 1 == edges.size() || edges[i] != edges[i + 1]))
            return false;
    return true;
}

}  // namespace

FoundLeaves find_leaves(const PartDescription& part, const std::vector<uint32_t>& welded) {
    const std::vector<Corners> corners = sorted_corners(part, welded);
    const std::vector<bool> repeated = find_repeated(corners);
    const std::vector<uint32_t> group = find_groups(part, corners);
    std::vector<uint32_t> order(corners.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::tie(group[a], a) < std::tie(group[b], b); });

    FoundLeaves found;
    std::vector<uint32_t> triangles;
    for (size_t first = 0, last; first < order.size(); first = last) {
        triangles.clear();
        for (last = first; last < order.size() && group[order[last]] == group[order[first]]; ++last)
            if (!repeated[order[last]]) triangles.push_back(order[last]);
        found.counts.repeated_triangles += uint32_t(last - first - triangles.size());
        if (triangles.empty()) {
            ++found.counts.repeated_leaves;
            continue;
        }
        const bool closed = is_closed(corners, triangles);
        const uint32_t count = uint32_t(triangles.size());
        const ProxyQuad proxy = fit_proxy_quad(part, welded, triangles, closed);
        ++(!proxy.exact ? found.counts.meshes : count == 1 ? found.counts.triangles : found.counts.quads);
        found.counts.closed += closed;
        found.counts.largest_leaf_triangles = std::max(found.counts.largest_leaf_triangles, count);
        found.leaves.push_back(proxy.leaf);
    }
    return found;
}

}  // namespace coppice
