// Crowns whose leaves sit on twigs, as real ones do: in clumps, and facing rather upwards.
#pragma once
#include <cmath>
#include <vector>
#include "plugins/vegetation/plant/leaf.h"
#include "runtime/core/random.h"

namespace coppice {

inline vec3 any_direction(Random& random) {
    const float y = random.next_in(-1, 1), around = random.next_in(0, 2 * k_pi), r = std::sqrt(1 - y * y);
    return {r * portable_cos(around), y, r * portable_sin(around)};
}

// leaf_count quads of 8 cm by 4.5 cm, twig_leaves a twig of 30 cm, the twigs in a ball so large that about `layers` leaves lie behind
// each other in its middle.
inline std::vector<Leaf> made_crown(uint32_t leaf_count, uint64_t seed, float layers = 4.0f,
                                    int twig_leaves = 9) {
    constexpr float k_length_m = 0.08f, k_width_m = 0.045f, k_twig_m = 0.3f;
    const float radius_m =
        std::sqrt(0.5f * float(leaf_count) * k_length_m * k_width_m / (k_pi * layers / 1.5f));
    std::vector<Leaf> crown;
    Random random(seed);
    while (crown.size() < leaf_count) {
        const vec3 outwards = any_direction(random);
        const vec3 foot =
            outwards * (radius_m * portable_pow(random.next_unit(), 1.0f / 3)) + vec3(0, radius_m, 0);
        const vec3 along = normalize_or(outwards + any_direction(random) * 0.8f, outwards);
        for (int i = 0; i < twig_leaves && crown.size() < leaf_count; ++i) {
            const vec3 stalk = foot + along * (k_twig_m * float(i) / float(twig_leaves));
            const vec3 normal = normalize_or(vec3(0, 0.7f, 0) + any_direction(random), vec3(0, 1, 0));
            const vec3 sideways = any_direction(random) + along * 0.5f;
            const vec3 u =
                normalize_or(sideways - normal * glm::dot(sideways, normal), perpendicular_to(normal));
            const vec3 tip = u * k_length_m, half = glm::cross(normal, u) * (0.5f * k_width_m);
            const float shade = random.next_in(0.7f, 1.3f);
            crown.push_back({{stalk - half, stalk + tip - half, stalk + tip + half, stalk + half},
                             normal,
                             vec3(0.06f, 0.13f, 0.03f) * shade});
            Leaf& leaf = crown.back();
            // Triangles (0, 1, 2) of a leaf turn as its normal says.
            if (glm::dot(glm::cross(tip, half), normal) < 0.0f)
                std::swap(leaf.corners_plant[1], leaf.corners_plant[3]);
        }
    }
    return crown;
}

}  // namespace coppice
