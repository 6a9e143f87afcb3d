// A tuft of grass: curved tapering blades, and stalks with a seed head where asked for.
#include <algorithm>

#include "plugins/modeller/grow.h"
#include "plugins/modeller/part_builder.h"

namespace coppice::modeller {
namespace {

void grow_blade(PartBuilder& blades, const GrassParameters& p, uint32_t index, Random random) {
    // The tuft's middle stands, its rim leans outwards.
    float out = std::sqrt((float(index) + 0.5f) / float(p.blades));
    float around = 2.39996323f * float(index) + random.next_around(0.0f, 0.4f);
    Frame frame = roll(Frame{}, around);
    vec3 position = -frame.upper * (p.radius_m * out) + vec3(0, -0.004f, 0);
    frame = roll(frame, random.next_around(0.0f, 0.7f));
    frame = tilt(frame, random.next_around(p.lean.center, p.lean.spread) * (0.35f + 0.65f * out));
    float length_m =
        1.12f * p.height_m * (1.0f + p.height_variation * random.next_in(-1.0f, 0.35f)) * (1.0f - 0.2f * out);
    float curve = random.next_around(p.curve.center, p.curve.spread) / float(p.segments);
    bool dry = random.next_unit() < p.dry;
    vec3 color = vary_color(dry ? p.dry_color_linear : p.color_linear, p.variation, random);
    vec3 tip = vary_color(dry ? p.dry_color_linear : p.tip_color_linear, p.variation, random);
    float twist = random.next_around(0.0f, 0.5f) / float(p.segments);
    float half_width_m = 0.5f * p.width_m * random.next_in(0.7f, 1.2f);
    std::vector<BladeSection> sections;
    for (uint32_t i = 0; i <= p.segments; ++i) {
        float t = float(i) / float(p.segments);
        float width = (0.75f + 0.5f * t) * (1.0f - t * t);  // widest a little above the foot
        sections.push_back(
            {position, frame, half_width_m * width, glm::mix(color * (0.7f + 0.3f * t), tip, t * t)});
        position += frame.along * (length_m / float(p.segments));
        // Blades bend where they are thin.
        frame = roll(tilt(frame, curve * (0.4f + 1.2f * t)), twist);
    }
    add_blade(blades, sections, 0.0f, index, 0);
}

void grow_stalk(PartBuilder& stalks, const GrassParameters& p, uint32_t index, Random random) {
    Frame frame = roll(Frame{}, random.next_in(0.0f, 2.0f * k_pi));
    vec3 position = -frame.upper * (p.radius_m * 0.6f * random.next_unit());
    frame = tilt(frame, random.next_in(0.02f, 0.22f));
    float length_m = p.stalk_height_m * random.next_in(0.8f, 1.05f);
    vec3 color = vary_color(glm::mix(p.tip_color_linear, p.dry_color_linear, 0.5f), p.variation, random);
    float radius_m = 0.14f * p.width_m;
    std::vector<TubeRing> rings;
    // Five rings of stem, then a spindle of seeds.
    constexpr float k_at[] = {0.0f, 0.3f, 0.6f, 0.8f, 0.83f, 0.9f, 1.0f};
    constexpr float k_wide[] = {1.2f, 1.1f, 1.0f, 0.9f, 3.2f, 3.4f, 0.0f};
    float before = 0.0f;
    for (int i = 0; i < 7; ++i) {
        position += frame.along * ((k_at[i] - before) * length_m);
        before = k_at[i];
        vec3 ring_color = i >= 4 ? p.dry_color_linear : color;
        rings.push_back({position, frame, radius_m * k_wide[i], ring_color});
        frame = tilt(frame, i >= 3 ? 0.16f : 0.03f);
    }
    add_tube(stalks, rings, 3, false, p.blades + index, 0);
}

}  // namespace

PlantDescription grow_grass(const GrassParameters& p, Random random) {
    PartBuilder blades("blades", PartKind::automatic, true), stalks("stalks", PartKind::lines, false);
    for (uint32_t i = 0; i < p.blades; ++i) grow_blade(blades, p, i, random.fork(1).fork(i));
    for (uint32_t i = 0; i < p.stalks; ++i) grow_stalk(stalks, p, i, random.fork(2).fork(i));
    PlantDescription plant;
    plant.parts.push_back(blades.take());
    if (!stalks.empty()) plant.parts.push_back(stalks.take());
    return plant;
}

}  // namespace coppice::modeller
