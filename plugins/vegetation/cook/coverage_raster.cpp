#include "plugins/vegetation/cook/coverage_raster.h"

#include <algorithm>

namespace coppice {

void CoverageRaster::triangle(vec2 a, vec2 b, vec2 c) {
    int32_t row_last = pixel(std::max({a.y, b.y, c.y}));
    for (int32_t row = pixel(std::min({a.y, b.y, c.y})); row < row_last; ++row) {
        float y = float(row) + 0.5f, left = 1.0e30f, right = -1.0e30f;
        auto edge = [&](vec2 p, vec2 q) {
            if ((p.y <= y) == (q.y <= y)) return;
            float x = p.x + (y - p.y) * ((q.x - p.x) / (q.y - p.y));
            left = std::min(left, x);
            right = std::max(right, x);
        };
        edge(a, b);
        edge(b, c);
        edge(c, a);
        if (left > right) continue;
        int32_t column_last = pixel(right);
        for (int32_t column = pixel(left); column < column_last; ++column) cover(column, row);
    }
}

void CoverageRaster::square(vec2 center, float side) {
    float half = 0.5f * side;
    int32_t column_last = pixel(center.x + half), row_last = pixel(center.y + half);
    for (int32_t row = pixel(center.y - half); row < row_last; ++row)
        for (int32_t column = pixel(center.x - half); column < column_last; ++column) cover(column, row);
}

void CoverageRaster::line(vec2 a, vec2 b, float width) {
    bool steep = std::fabs(b.y - a.y) > std::fabs(b.x - a.x);
    if (steep) {
        std::swap(a.x, a.y);
        std::swap(b.x, b.y);
    }
    if (a.x > b.x) std::swap(a, b);
    float span = b.x - a.x, slope = span > 0.0f ? (b.y - a.y) / span : 0.0f;
    float half = 0.5f * width * std::sqrt(1.0f + slope * slope);
    int32_t last = pixel(b.x);
    for (int32_t along = pixel(a.x); along < last; ++along) {
        float across = a.y + slope * (float(along) + 0.5f - a.x);
        int32_t across_last = pixel(across + half);
        for (int32_t i = pixel(across - half); i < across_last; ++i)
            steep ? cover(i, along) : cover(along, i);
    }
}

}  // namespace coppice
