#include "tools/accuracy/plant_picture.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace coppice {
namespace {

using glm::dvec2;

struct Nearest {
    float depth_m = -std::numeric_limits<float>::infinity();  // towards the viewer
    uint32_t triangle = 0;
    float share_b = 0.0f, share_c = 0.0f;
};

double cross(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

// First sample whose centre is at or past x, in samples.
uint32_t first_sample(double x, uint32_t count) {
    return uint32_t(std::clamp(std::ceil(x - 0.5), 0.0, double(count)));
}

Surface mix_surfaces(const PackedVertex* corners, float share_b, float share_c) {
    const Surface a = decode_surface(corners[0].surface), b = decode_surface(corners[1].surface),
                  c = decode_surface(corners[2].surface);
    const float share_a = 1.0f - share_b - share_c;
    return {normalize_or(a.normal * share_a + b.normal * share_b + c.normal * share_c, a.normal),
            a.color_linear * share_a + b.color_linear * share_b + c.color_linear * share_c,
            a.openness * share_a + b.openness * share_b + c.openness * share_c, a.leaf};
}

}  // namespace

PlantPicture picture_plant(const Plant& plant, int axis, float sample_m) {
    const int across = (axis + 1) % 3, up = (axis + 2) % 3;
    const vec3 extent_m = plant.bounds_plant.size(), origin = plant.bounds_plant.min;
    auto samples = [&](int along) {
        const float count = std::ceil(extent_m[along] / sample_m);
        assert(count <= 8192.0f);
        return std::max(uint32_t(count), 1u);
    };
    PlantPicture picture{axis, sample_m, samples(across), samples(up), {}, {}};
    std::vector<Nearest> nearest(size_t(picture.columns) * picture.rows);
    const auto& vertices = plant.triangle_vertices;
    for (size_t i = 0; i + 2 < vertices.size(); i += 3) {
        dvec2 at[3];
        double depth_m[3];
        for (size_t k = 0; k < 3; ++k) {
            const PackedVertex& v = vertices[i + k];
            const vec3 p(v.x_plant, v.y_plant, v.z_plant);
            at[k] = dvec2(double(p[across]) - double(origin[across]), double(p[up]) - double(origin[up])) *
                    (1.0 / double(sample_m));
            depth_m[k] = double(p[axis]);
        }
        const dvec2 b = at[1] - at[0], c = at[2] - at[0];
        const double doubled_area = cross(b, c);
        if (doubled_area == 0.0) continue;
        const uint32_t row_end = first_sample(std::max({at[0].y, at[1].y, at[2].y}), picture.rows),
                       column_end = first_sample(std::max({at[0].x, at[1].x, at[2].x}), picture.columns),
                       column_first = first_sample(std::min({at[0].x, at[1].x, at[2].x}), picture.columns);
        for (uint32_t row = first_sample(std::min({at[0].y, at[1].y, at[2].y}), picture.rows); row < row_end;
             ++row)
            for (uint32_t column = column_first; column < column_end; ++column) {
                const dvec2 p = dvec2(double(column) + 0.5, double(row) + 0.5) - at[0];
                const double share_b = cross(p, c) / doubled_area, share_c = cross(b, p) / doubled_area;
                if (!(share_b >= 0.0 && share_c >= 0.0 && share_b + share_c <= 1.0)) continue;
                const float depth = float(depth_m[0] + share_b * (depth_m[1] - depth_m[0]) +
                                          share_c * (depth_m[2] - depth_m[0]));
                Nearest& sample = nearest[size_t(row) * picture.columns + column];
                if (depth > sample.depth_m) sample = {depth, uint32_t(i / 3), float(share_b), float(share_c)};
            }
    }
    picture.covered.resize(nearest.size());
    picture.surfaces.resize(nearest.size());
    for (size_t i = 0; i < nearest.size(); ++i) {
        if (!std::isfinite(nearest[i].depth_m)) continue;
        picture.covered[i] = 1;
        picture.surfaces[i] =
            mix_surfaces(&vertices[3 * size_t(nearest[i].triangle)], nearest[i].share_b, nearest[i].share_c);
    }
    return picture;
}

}  // namespace coppice
