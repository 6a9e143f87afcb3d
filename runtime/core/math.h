// Vectors (glm) and the few functions whose value may decide something: sine, cosine, powers. Those are ours, made of
// additions and multiplications only, so that every compiler and machine gives the same bits (DESIGN section 5).
// Metres, radians, y up, right-handed.
#pragma once
#include <cmath>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/geometric.hpp>

namespace coppice {

using glm::dvec3;
using glm::ivec2;
using glm::mat3;
using glm::mat4;
using glm::uvec2;
using glm::vec2;
using glm::vec3;
using glm::vec4;

inline constexpr float k_pi = 3.14159265358979323846f;

// Error under 2e-7 for |x| <= 1e4 rad; not finite in, 0 (sine) or 1 (cosine) out.
float portable_sin(float angle_rad);
float portable_cos(float angle_rad);
// exp2 and log2 with relative error under 3e-7. log2 of x <= 0 is -126. exp2 saturates at 2^+-126.
float portable_exp2(float x);
float portable_log2(float x);
inline float portable_exp(float x) { return portable_exp2(x * 1.44269504088896341f); }
inline float portable_log(float x) { return portable_log2(x) * 0.69314718055994531f; }
// base^exponent for base >= 0; 0^0 = 1.
float portable_pow(float base, float exponent);
// Angle of (x, y) in (-pi, pi], error under 1e-6; (0, 0) gives 0.
float portable_atan2(float y, float x);
// In [0, pi]; x is clamped to [-1, 1].
float portable_acos(float x);

// v / |v|, or `otherwise` where |v| is zero or not finite.
vec3 normalize_or(vec3 v, vec3 otherwise);
// Any unit vector at right angles to unit n.
vec3 perpendicular_to(vec3 n);
// v turned by angle_rad about unit axis.
vec3 rotate_about(vec3 v, vec3 axis, float angle_rad);
inline bool is_finite(vec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// sRGB transfer function of one channel, [0, 1] to [0, 1].
float srgb_to_linear(float s);
float linear_to_srgb(float l);

struct Box {
    vec3 min{INFINITY, INFINITY, INFINITY};
    vec3 max{-INFINITY, -INFINITY, -INFINITY};
    void include(vec3 p) {
        min = glm::min(min, p);
        max = glm::max(max, p);
    }
    void include(const Box& b) {
        min = glm::min(min, b.min);
        max = glm::max(max, b.max);
    }
    bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    vec3 center() const { return (min + max) * 0.5f; }
    vec3 size() const { return max - min; }
};

}  // namespace coppice
