#include "plugins/vegetation/eco/vary_color.h"

#include <algorithm>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/plant/surface.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

constexpr float k_radians = k_pi / 180.0f;
constexpr uint32_t k_color_bits = 0x0ffff000u;

float signed_byte(uint32_t tint, uint32_t shift) { return float(int8_t(tint >> shift & 255u)); }

uint32_t round_byte(float value, uint32_t shift) {
    const float rounded = std::floor(std::clamp(value, -127.0f, 127.0f) + 0.5f);
    return uint32_t(uint8_t(int8_t(rounded))) << shift;
}

}  // namespace

ColorVariation read_color_variation(JsonObject& object) {
    ColorVariation variation;
    variation.brightness = object.real("brightness", 0.0f, 0.9f, 0.0f);
    variation.hue_deg = object.real("hue_deg", 0.0f, 45.0f, 0.0f);
    variation.saturation = object.real("saturation", 0.0f, 0.7f, 0.0f);
    object.close();
    return variation;
}

ColorTints::ColorTints(const ColorVariation& variation)
    : any_(variation.any()), brightness_(variation.brightness), saturation_(variation.saturation) {
    const float half_rad = 0.5f * variation.hue_deg * k_radians;
    if (!(half_rad > 1e-3f)) return;
    half_turn_ = portable_sin(half_rad) / portable_cos(half_rad);
    // The mean of the cosine (1 - h h) / (1 + h h) over [-half_turn, half_turn].
    gain_ = 1.0f / (2.0f * half_rad / half_turn_ - 1.0f);
}

uint32_t ColorTints::tint_of(uint32_t seed) const {
    if (!any_) return 0;
    // Each of 21 bits, in [-1, 1).
    const uint64_t bits = uint64_t(mix_bits(seed ^ 0x5bf03635u)) << 32 | mix_bits(seed ^ 0x27d4eb2fu);
    auto chance = [bits](uint32_t shift) { return float(bits >> shift & 0x1fffffu) * 0x1p-20f - (1.0f - 0x1p-21f); };
    const float stretch = (1.0f + saturation_ * chance(21)) * gain_;
    const float h = half_turn_ * chance(42), cosine = (1.0f - h * h) / (1.0f + h * h), sine = 2.0f * h / (1.0f + h * h);
    return round_byte(128.0f * brightness_ * chance(0), 0) | round_byte(128.0f * (stretch * cosine - 1.0f), 8) |
           round_byte(64.0f * stretch * sine, 16);
}

vec3 tint_color(uint32_t tint, vec3 c) {
    const float b = 1.0f + signed_byte(tint, 0) / 128.0f, p = 1.0f + signed_byte(tint, 8) / 128.0f,
                q = signed_byte(tint, 16) / 64.0f;
    const float mean = (c.x + c.y + c.z) / 3.0f;
    const vec3 turned = vec3(c.z - c.y, c.x - c.z, c.y - c.x) * 0.57735027f;
    return glm::clamp((vec3(mean) + (c - vec3(mean)) * p + turned * q) * b, vec3(0.0f), vec3(1.0f));
}

uint32_t tint_surface(uint32_t tint, uint32_t surface_bits, uint32_t dither) {
    if (tint == 0) return surface_bits;
    Surface surface = decode_surface(surface_bits);
    surface.color_linear = tint_color(tint, surface.color_linear);
    return (surface_bits & ~k_color_bits) | (encode_surface(surface, dither) & k_color_bits);
}

}  // namespace coppice
