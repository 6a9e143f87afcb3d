#include "plugins/terrain/color_ground.h"

#include <algorithm>
#include "plugins/shared/noise.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

// Where noise of standard deviation 0.25 exceeds a threshold on about `share` of the ground, softly.
float patches(float noise, float share) {
    float threshold = 0.65f * (1.0f - 2.0f * share);
    return share > 0.0f ? smooth_step(threshold - 0.15f, threshold + 0.15f, noise) : 0.0f;
}

vec3 mix_colors(vec3 a, vec3 b, float t) { return a + (b - a) * t; }

}  // namespace

std::vector<vec3> color_ground(const HeightField& field, const std::vector<vec3>& normals,
                               const GroundSettings& ground, dvec3 origin_world) {
    std::vector<vec3> colors(field.heights_m.size());
    const double period =
        field.periodic ? double(field.columns - 1) * double(field.cell_m) / double(ground.patch_m) : 0.0;
    float rock_up = portable_cos(ground.rock_slope_deg * (k_pi / 180.0f));
    parallel_for(field.rows, 8, [&](size_t first, size_t last) {
        for (uint32_t row = uint32_t(first); row < last; ++row)
            for (uint32_t column = 0; column < field.columns; ++column) {
                size_t index = size_t(row) * field.columns + column;
                double x = double(field.x_of(column)), z = double(field.z_of(row));
                double u = x / double(ground.patch_m), v = z / double(ground.patch_m);
                float wide = fractal_noise(u, v, 5, 0.6f, ground.seed * 3u + 11u, period);
                float other = fractal_noise(u * 1.7, v * 1.7, 5, 0.65f, ground.seed * 3u + 12u, period * 1.7);
                float fine = fractal_noise(u * 5.0, v * 5.0, 3, 0.8f, ground.seed * 3u + 13u, period * 5.0);
                vec3 color = mix_colors(ground.meadow, ground.dry, patches(wide, ground.dry_share));
                color = mix_colors(color, ground.soil, patches(other, ground.soil_share));
                // Rock starts where the slope says so, ragged by the noise.
                float steep = smooth_step(-0.04f, 0.04f, rock_up - normals[index].y + 0.05f * other);
                color = mix_colors(color, ground.rock, steep);
                color *= std::max(0.2f, 1.0f + ground.variation * (0.9f * fine + 0.6f * wide));
                dvec2 place(x + origin_world.x, z + origin_world.z);
                for (const GroundPaint& paint : ground.paint) {
                    float away = float(paint.region.distance_m(place)) + 0.6f * paint.edge_m * fine;
                    float cover =
                        paint.strength * (1.0f - smooth_step(-0.3f * paint.edge_m, paint.edge_m, away));
                    color = mix_colors(color, paint.color_linear * (1.0f + 0.5f * ground.variation * fine),
                                       cover);
                }
                colors[index] = glm::clamp(color, vec3(0.0f), vec3(1.0f));
            }
    });
    repeat_border(field, colors);
    return colors;
}

}  // namespace coppice
