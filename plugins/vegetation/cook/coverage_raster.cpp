#include "plugins/vegetation/cook/coverage_raster.h"

#include <algorithm>

namespace coppice {

void CoverageRaster::triangle(vec3 a, vec3 b, vec3 c) {
    const vec3 normal = glm::cross(b - a, c - a);
    const bool on_edge = std::fabs(normal.z) < 1.0e-12f;  // then hardly a pixel's centre lies inside
    const float distance_x = on_edge ? 0.0f : -normal.x / normal.z,
                distance_y = on_edge ? 0.0f : -normal.y / normal.z;
    int32_t row_last = pixel(std::max({a.y, b.y, c.y}));
    for (int32_t row = pixel(std::min({a.y, b.y, c.y})); row < row_last; ++row) {
        float y = float(row) + 0.5f, left = 1.0e30f, right = -1.0e30f;
        auto edge = [&](vec3 p, vec3 q) {
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
        for (int32_t column = pixel(left); column < column_last; ++column)
            cover(column, row, a.z + distance_x * (float(column) + 0.5f - a.x) + distance_y * (y - a.y));
    }
}

void CoverageRaster::square(vec3 center, float side) {
    float half = 0.5f * side;
    int32_t column_last = pixel(center.x + half), row_last = pixel(center.y + half);
    for (int32_t row = pixel(center.y - half); row < row_last; ++row)
        for (int32_t column = pixel(center.x - half); column < column_last; ++column)
            cover(column, row, center.z);
}

void CoverageRaster::line(vec3 a, vec3 b, float width) {
    bool steep = std::fabs(b.y - a.y) > std::fabs(b.x - a.x);
    if (steep) {
        std::swap(a.x, a.y);
        std::swap(b.x, b.y);
    }
    if (a.x > b.x) std::swap(a, b);
    float span = b.x - a.x, slope = span > 0.0f ? (b.y - a.y) / span : 0.0f;
    const float distance_slope = span > 0.0f ? (b.z - a.z) / span : 0.0f;
    float half = 0.5f * width * std::sqrt(1.0f + slope * slope);
    int32_t last = pixel(b.x);
    for (int32_t along = pixel(a.x); along < last; ++along) {
        const float far_along = float(along) + 0.5f - a.x;
        const float across = a.y + slope * far_along, distance = a.z + distance_slope * far_along;
        int32_t across_last = pixel(across + half);
        for (int32_t i = pixel(across - half); i < across_last; ++i)
            steep ? cover(i, along, distance) : cover(along, i, distance);
    }
}

}  // namespace coppice
