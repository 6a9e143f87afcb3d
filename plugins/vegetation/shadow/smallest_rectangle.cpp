#include "plugins/vegetation/shadow/smallest_rectangle.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/geometric.hpp>

namespace coppice {
namespace {

constexpr size_t k_most_places = 128;

double cross(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

// Corners of the convex hull, counter-clockwise (Andrew 1979); returns how many.
size_t hull_of(std::span<const dvec2> places, std::array<dvec2, 2 * k_most_places>& hull) {
    std::array<dvec2, k_most_places> sorted;
    size_t count = 0;
    for (const dvec2& p : places)
        if (std::isfinite(p.x + p.y)) sorted[count++] = p;
    std::sort(sorted.begin(), sorted.begin() + count,
              [](dvec2 a, dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
    size_t size = 0;
    auto add = [&](dvec2 p, size_t first) {
        while (size >= first + 2 && cross(hull[size - 1] - hull[size - 2], p - hull[size - 2]) <= 0.0) --size;
        hull[size++] = p;
    };
    for (size_t i = 0; i < count; ++i) add(sorted[i], 0);
    const size_t upper = size > 0 ? size - 1 : 0;
    for (size_t i = count; i-- > 0;) add(sorted[i], upper);
    return size > 1 ? size - 1 : size;  // the last is the first
}

Rectangle rectangle_along(dvec2 axis, std::span<const dvec2> corners, double least_width) {
    Rectangle box{axis, dvec2(INFINITY), dvec2(-INFINITY)};
    for (const dvec2& p : corners) {
        const dvec2 at(glm::dot(axis, p), cross(axis, p));
        box.low = {std::min(box.low.x, at.x), std::min(box.low.y, at.y)};
        box.high = {std::max(box.high.x, at.x), std::max(box.high.y, at.y)};
    }
    for (int i = 0; i < 2; ++i) {
        const double missing = least_width - (box.high[i] - box.low[i]);
        if (missing <= 0.0) continue;
        box.low[i] -= 0.5 * missing;
        box.high[i] += 0.5 * missing;
    }
    return box;
}

}  // namespace

Rectangle smallest_rectangle(std::span<const dvec2> places, double least_width) {
    assert(places.size() <= k_most_places);
    std::array<dvec2, 2 * k_most_places> hull;
    const size_t count = hull_of(places, hull);
    const std::span<const dvec2> corners(hull.data(), count);
    if (count == 0) return {dvec2(1.0, 0.0), dvec2(-0.5 * least_width), dvec2(0.5 * least_width)};
    Rectangle best = rectangle_along({1.0, 0.0}, corners, least_width);
    auto area = [](const Rectangle& box) { return (box.high.x - box.low.x) * (box.high.y - box.low.y); };
    for (size_t i = 0; i < count; ++i) {
        const dvec2 side = corners[(i + 1) % count] - corners[i];
        const double length = glm::length(side);
        if (!(length > 0.0)) continue;
        const Rectangle box = rectangle_along(side / length, corners, least_width);
        if (area(box) < area(best)) best = box;
    }
    return best;
}

}  // namespace coppice
