#include "plugins/vegetation/eco/group_places.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace coppice {
namespace {

constexpr size_t k_most_children = 8;
constexpr uint32_t k_key_bits = 24;  // along each axis

// Where a place lies along a Morton curve.
struct Key {
    uint64_t morton;
    uint32_t place;
    bool operator<(const Key& other) const {
        return morton != other.morton ? morton < other.morton : place < other.place;
    }
};

uint64_t spread_bits(uint64_t x) {
    uint64_t spread = 0;
    for (uint32_t bit = 0; bit < k_key_bits; ++bit) spread |= (x >> bit & 1u) << (2 * bit);
    return spread;
}

std::vector<Key> sort_along_curve(std::span<const dvec3> places) {
    dvec3 low(INFINITY), high(-INFINITY);
    for (const dvec3& at : places) {
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    const double side_m = std::max(high.x - low.x, high.z - low.z);
    auto step = [side_m](double away_m) {
        constexpr double k_steps = double(1u << k_key_bits);
        const double share = side_m > 0.0 ? away_m / side_m * k_steps : 0.0;
        return uint64_t(std::clamp(share == share ? share : 0.0, 0.0, k_steps - 1.0));
    };
    std::vector<Key> keys;
    for (const dvec3& at : places)
        keys.push_back(
            {spread_bits(step(at.x - low.x)) | spread_bits(step(at.z - low.z)) << 1, uint32_t(keys.size())});
    std::sort(keys.begin(), keys.end());
    return keys;
}

// Where to cut sorted keys [first, last): at the quarters of the smallest square that holds them, or, in one place, into
// equal shares. 2 to 8 ranges, by their ends. Requires two keys.
std::vector<size_t> cut_range(const std::vector<Key>& keys, size_t first, size_t last) {
    std::vector<size_t> ends;
    const uint64_t differing = keys[first].morton ^ keys[last - 1].morton;
    if (differing == 0) {
        const size_t count = std::min(last - first, k_most_children);
        for (size_t i = 1; i <= count; ++i) ends.push_back(first + (last - first) * i / count);
        return ends;
    }
    const uint32_t shift = uint32_t(std::bit_width(differing) - 1) & ~1u;
    for (size_t i = first + 1; i < last; ++i)
        if (keys[i].morton >> shift != keys[i - 1].morton >> shift) ends.push_back(i);
    ends.push_back(last);
    return ends;
}

dvec3 round_sixteenth(dvec3 p) {
    return dvec3(std::floor(p.x * 16.0 + 0.5), std::floor(p.y * 16.0 + 0.5), std::floor(p.z * 16.0 + 0.5)) *
           0.0625;
}

}  // namespace

Groups group_places(std::span<const dvec3> places) {
    Groups groups;
    const std::vector<Key> keys = sort_along_curve(places);
    if (keys.empty()) return groups;
    struct Range {
        size_t first, last;
    };
    std::vector<GroupNode>& nodes = groups.nodes;
    std::vector<Range> range_of_node{{0, keys.size()}};
    nodes.emplace_back();
    while (groups.level_begin.back() < nodes.size()) {
        const size_t level_end = nodes.size();
        for (size_t n = groups.level_begin.back(); n < level_end; ++n) {
            const Range range = range_of_node[n];
            if (range.last - range.first == 1) {
                nodes[n].place = keys[range.first].place;
                continue;
            }
            nodes[n].first_child = uint32_t(nodes.size());
            size_t first = range.first;
            for (size_t end : cut_range(keys, range.first, range.last)) {
                range_of_node.push_back({first, end});
                nodes.emplace_back();
                first = end;
            }
            nodes[n].child_count = uint32_t(nodes.size()) - nodes[n].first_child;
        }
        groups.level_begin.push_back(level_end);
    }
    return groups;
}

JoinedSpace join_spaces(std::span<const dvec3> origins, std::span<const Box> bounds) {
    assert(!origins.empty() && origins.size() == bounds.size());
    dvec3 low(INFINITY), high(-INFINITY);
    for (size_t i = 0; i < origins.size(); ++i) {
        low = glm::min(low, origins[i] + dvec3(bounds[i].min));
        high = glm::max(high, origins[i] + dvec3(bounds[i].max));
    }
    JoinedSpace space;
    space.origin = round_sixteenth((low + high) * 0.5);
    const vec3 reach = vec3(glm::max(high - space.origin, space.origin - low));
    const vec3 margin = reach * 0x1p-22f;
    space.bounds = {vec3(low - space.origin) - margin, vec3(high - space.origin) + margin};
    return space;
}

}  // namespace coppice
