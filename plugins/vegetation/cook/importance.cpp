#include "plugins/vegetation/cook/importance.h"

#include <algorithm>

namespace coppice {
namespace {

constexpr float k_same_color = 0.10f;  // OKLab distance within which colours make one group
constexpr float k_unnoticed = 0.15f;   // up to here importance is 1: leaves of one plant, leaf and bark
constexpr float k_striking = 0.33f;    // from here it is the largest
constexpr float k_largest = 4.0f;
constexpr float k_lightness_weight = 0.6f;

// B. Ottosson, A perceptual color space for image processing, 2020; lightness already weighted.
vec3 to_oklab(vec3 c) {
    float l = portable_pow(0.4122214708f * c.x + 0.5363325363f * c.y + 0.0514459929f * c.z, 1.0f / 3.0f);
    float m = portable_pow(0.2119034982f * c.x + 0.6806995451f * c.y + 0.1073969566f * c.z, 1.0f / 3.0f);
    float s = portable_pow(0.0883024619f * c.x + 0.2817188376f * c.y + 0.6299787005f * c.z, 1.0f / 3.0f);
    return {k_lightness_weight * (0.2104542553f * l + 0.7936177850f * m - 0.0040720468f * s),
            1.9779984951f * l - 2.4285922050f * m + 0.4505937099f * s,
            0.0259040371f * l + 0.7827717662f * m - 0.8086757660f * s};
}

float distance_of(vec3 a, vec3 b) { return std::sqrt(glm::dot(a - b, a - b)); }

}  // namespace

std::vector<float> choose_importance(std::span<const ColoredArea> parts) {
    std::vector<vec3> colors;
    for (const ColoredArea& part : parts) colors.push_back(to_oklab(part.mean_color_linear));
    double largest_area = -1.0;
    vec3 majority(0);
    for (vec3 center : colors) {
        double area = 0.0;
        dvec3 sum(0);
        for (size_t i = 0; i < parts.size(); ++i) {
            if (distance_of(colors[i], center) > k_same_color) continue;
            area += parts[i].area_m2;
            sum += dvec3(colors[i]) * parts[i].area_m2;
        }
        if (area > largest_area) {
            largest_area = area;
            majority = area > 0.0 ? vec3(sum * (1.0 / area)) : center;
        }
    }
    std::vector<float> importance;
    for (size_t i = 0; i < parts.size(); ++i) {
        float striking = (distance_of(colors[i], majority) - k_unnoticed) / (k_striking - k_unnoticed);
        importance.push_back(parts[i].given > 0.0f
                                 ? parts[i].given
                                 : 1.0f + (k_largest - 1.0f) * std::clamp(striking, 0.0f, 1.0f));
    }
    return importance;
}

}  // namespace coppice
