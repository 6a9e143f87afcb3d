#include "plugins/vegetation/cook/importance.h"

#include <algorithm>
#include "plugins/vegetation/cook/oklab.h"

namespace coppice {
namespace {

constexpr float k_same_color = 0.10f;  // OKLab distance within which colours make one group
constexpr float k_unnoticed = 0.15f;   // up to here importance is 1: leaves of one plant, leaf and bark
constexpr float k_striking = 0.33f;    // from here it is the largest
constexpr float k_largest = 4.0f;
constexpr float k_lightness_weight = 0.6f;

vec3 to_color(vec3 color_linear) { return to_oklab(color_linear) * vec3(k_lightness_weight, 1.0f, 1.0f); }

float distance_of(vec3 a, vec3 b) { return std::sqrt(glm::dot(a - b, a - b)); }

}  // namespace

std::vector<float> choose_importance(std::span<const ColoredArea> parts) {
    std::vector<vec3> colors;
    for (const ColoredArea& part : parts) colors.push_back(to_color(part.mean_color_linear));
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
