#include "plugins/vegetation/cook/import/trace_outline.h"

namespace coppice {

double signed_area(const Ring& ring) {
    double twice = 0.0;
    for (size_t i = 0; i < ring.size(); ++i) twice += cross_at(ring[0], ring[i], ring[(i + 1) % ring.size()]);
    return twice * 0.5;
}

std::vector<Ring> trace_outline(const AlphaGrid& grid, float threshold) {
    uint32_t width = uint32_t(grid.xs.size()), height = uint32_t(grid.ys.size());
    // A crossing is named by the grid edge it lies on: 2 x node, + 0 towards x + 1, + 1 towards y + 1. Every
    // crossing is left by exactly one piece of outline.
    constexpr uint32_t k_none = UINT32_MAX;
    std::vector<uint32_t> next(size_t(width) * height * 2, k_none);
    auto value = [&](uint32_t x, uint32_t y) { return grid.values[size_t(y) * width + x]; };
    auto inside = [&](uint32_t x, uint32_t y) { return value(x, y) >= threshold; };
    for (uint32_t y = 0; y + 1 < height; ++y)
        for (uint32_t x = 0; x + 1 < width; ++x) {
            uint32_t corners = uint32_t(inside(x, y)) | uint32_t(inside(x + 1, y)) << 1 |
                               uint32_t(inside(x + 1, y + 1)) << 2 | uint32_t(inside(x, y + 1)) << 3;
            if (corners == 0 || corners == 15) continue;
            uint32_t node = (y * width + x) * 2;
            // The cell's edges, counter-clockwise from the lower one: between corners 0-1, 1-2, 2-3, 3-0.
            uint32_t edges[4] = {node, node + 3, node + 2 * width, node + 1};
            bool joined = false;
            if (corners == 5 || corners == 10)
                joined = (value(x, y) + value(x + 1, y) + value(x + 1, y + 1) + value(x, y + 1)) * 0.25f >=
                         threshold;
            // Counter-clockwise round the cell, the outline enters the cell where corner e is inside and e +
            // 1 is not (edge e) and leaves where it comes back inside. Separate corners close at once, joined
            // ones later.
            for (uint32_t e = 0; e < 4; ++e) {
                if (!(corners >> e & 1u) || (corners >> ((e + 1) % 4) & 1u)) continue;
                uint32_t back = (e + 1) % 4;
                while ((corners >> back & 1u) || !(corners >> ((back + 1) % 4) & 1u)) back = (back + 1) % 4;
                if (!joined && (corners == 5 || corners == 10)) back = (e + 3) % 4;
                next[edges[e]] = edges[back];
            }
        }
    auto position = [&](uint32_t edge) {
        uint32_t node = edge / 2, x0 = node % width, y0 = node / width;
        uint32_t x1 = x0 + (edge % 2 == 0), y1 = y0 + edge % 2;
        double a = value(x0, y0), b = value(x1, y1), t = (double(threshold) - a) / (b - a);
        return dvec2(grid.xs[x0] + (grid.xs[x1] - grid.xs[x0]) * t,
                     grid.ys[y0] + (grid.ys[y1] - grid.ys[y0]) * t);
    };
    std::vector<Ring> rings;
    for (uint32_t start = 0; start < next.size(); ++start) {
        if (next[start] == k_none) continue;
        Ring ring;
        for (uint32_t at = start; next[at] != k_none;) {
            dvec2 p = position(at);
            if (ring.empty() || ring.back() != p) ring.push_back(p);
            uint32_t to = next[at];
            next[at] = k_none;
            at = to;
        }
        while (ring.size() > 1 && ring.front() == ring.back()) ring.pop_back();
        if (ring.size() >= 3) rings.push_back(std::move(ring));
    }
    return rings;
}

}  // namespace coppice
