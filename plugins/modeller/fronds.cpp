// Palms and ferns: pinnate fronds, a bent rachis with leaflets on both sides; a palm has a ringed trunk below
// them.
#include <algorithm>

#include "plugins/modeller/grow.h"
#include "plugins/modeller/part_builder.h"

namespace coppice::modeller {
namespace {

struct RachisNode {
    vec3 position;
    Frame frame;
};

// The rachis bends more the further out it is, as a loaded cane does.
std::vector<RachisNode> grow_rachis(const FrondParameters& p, vec3 foot, Frame frame, float length_m,
                                    float arch_rad, Random& random) {
    std::vector<RachisNode> nodes{{foot, frame}};
    float n = float(p.segments);
    for (uint32_t i = 0; i < p.segments; ++i) {
        float weight = 2.0f * (float(i) + 0.5f) / n;
        frame = tilt(frame, arch_rad / n * weight);
        frame = roll(frame, random.next_around(0.0f, 0.12f / n * 4.0f));
        // Never past hanging straight down.
        if (frame.along.y < -0.97f) frame = tilt(frame, -arch_rad / n * weight);
        foot += frame.along * (length_m / n);
        nodes.push_back({foot, frame});
    }
    return nodes;
}

RachisNode rachis_at(const std::vector<RachisNode>& nodes, float fraction) {
    float x = std::clamp(fraction, 0.0f, 1.0f) * float(nodes.size() - 1);
    size_t i = std::min(size_t(x), nodes.size() - 2);
    float t = x - float(i);
    const RachisNode &a = nodes[i], &b = nodes[i + 1];
    return {glm::mix(a.position, b.position, t),
            frame_of(glm::mix(a.frame.along, b.frame.along, t), glm::mix(a.frame.side, b.frame.side, t))};
}

void grow_leaflet(PartBuilder& leaflets, const FrondParameters& p, const RachisNode& at, bool left,
                  float fraction, float size, vec3 color, vec3 tip_color, uint32_t stem, Random random) {
    // Longest at a third of the frond, short at the tip.
    float along = (fraction - p.stalk_fraction) / (1.0f - p.stalk_fraction);
    float outline =
        along < 0.3f ? 0.55f + 1.5f * along : 1.0f - 0.82f * portable_pow((along - 0.3f) / 0.7f, 1.7f);
    float length_m = p.leaflet_length_m * size * outline * random.next_around(1.0f, 0.08f);
    float half_width_m = 0.5f * p.leaflet_width_m * size * (0.45f + 0.55f * outline);
    // From the rachis sideways, lifted to a V, turned forwards more and more towards the tip.
    float angle = p.leaflet_angle_rad * (1.0f - 0.45f * along) + random.next_around(0.0f, 0.07f);
    float lift = p.leaflet_lift_rad + random.next_around(0.0f, 0.12f);
    vec3 side = at.frame.side * (left ? 1.0f : -1.0f);
    vec3 out = side * portable_cos(lift) + at.frame.upper * portable_sin(lift);
    vec3 direction = at.frame.along * portable_cos(angle) + out * portable_sin(angle);
    vec3 across = glm::cross(direction, at.frame.upper);
    Frame frame = frame_of(direction, across);
    if (glm::dot(frame.upper, at.frame.upper) < 0.0f) frame = roll(frame, k_pi);
    std::vector<BladeSection> sections;
    vec3 position = at.position;
    uint32_t n = p.leaflet_segments;
    for (uint32_t i = 0; i <= n; ++i) {
        float t = float(i) / float(n);
        float width = i == 0 ? 0.55f : 1.0f - 0.35f * t;
        sections.push_back({position, frame, half_width_m * width, glm::mix(color, tip_color, t * t)});
        vec3 axis = glm::cross(frame.along, vec3(0, -1, 0));
        float sine = glm::length(axis);
        if (sine > 1e-3f) {
            float droop = p.leaflet_droop_rad * sine / float(n) * (0.5f + t);
            frame = frame_of(rotate_about(frame.along, axis / sine, droop),
                             rotate_about(frame.side, axis / sine, droop));
        }
        position += frame.along * (length_m / float(n));
    }
    add_blade(leaflets, sections, 0.0f, stem, 1);
}

void grow_frond(PartBuilder& rachis, PartBuilder& leaflets, const FrondParameters& p, vec3 foot,
                const Frame& frame, float size, bool dry, uint32_t stem, Random random) {
    float length_m = p.length_m * size * random.next_around(1.0f, p.length_variation);
    float arch = p.arch_rad * random.next_around(1.0f, 0.2f);
    std::vector<RachisNode> nodes = grow_rachis(p, foot, frame, length_m, arch, random);
    vec3 color = vary_color(dry ? p.dry_color_linear : p.color_linear, p.variation, random);
    vec3 tip_color = glm::mix(color, dry ? p.dry_color_linear * 0.8f : p.tip_color_linear, 0.6f);
    vec3 rachis_color = dry ? p.dry_color_linear : p.rachis_color_linear;
    std::vector<TubeRing> rings;
    for (size_t i = 0; i < nodes.size(); ++i) {
        float t = float(i) / float(nodes.size() - 1);
        rings.push_back(
            {nodes[i].position, nodes[i].frame, p.radius_m * size * (1.0f - 0.85f * t), rachis_color});
    }
    add_tube(rachis, rings, 3, false, stem, 0);
    uint32_t pairs = p.leaflets / 2;
    for (uint32_t i = 0; i < pairs; ++i) {
        for (int left = 0; left < 2; ++left) {
            float fraction = p.stalk_fraction + (1.0f - p.stalk_fraction) *
                                                    (float(i) + 0.25f + 0.5f * float(left)) / float(pairs);
            Random own = random.fork(2 * i + uint32_t(left));
            vec3 own_color = vary_color(color, {0.06f, 0.04f}, own);
            grow_leaflet(leaflets, p, rachis_at(nodes, fraction), left, fraction, size, own_color, tip_color,
                         stem, own);
        }
    }
}

// Fronds around one point in golden-section order, the oldest lowest.
void grow_crown(PartBuilder& rachis, PartBuilder& leaflets, const FrondParameters& p, vec3 foot,
                const Frame& base, float foot_radius_m, Random random) {
    for (uint32_t i = 0; i < p.count; ++i) {
        Random own = random.fork(i);
        float age = p.count > 1 ? float(i) / float(p.count - 1) : 0.5f;  // 1: oldest
        Frame frame = roll(base, 2.39996323f * float(i) + own.next_around(0.0f, 0.15f));
        float down =
            p.down_angle.center + p.down_angle.spread * (2.0f * age - 1.0f) + own.next_around(0.0f, 0.08f);
        vec3 from = foot - frame.upper * foot_radius_m - base.along * (foot_radius_m * 1.2f * age);
        bool dry = p.dry > 0.0f && age > 1.0f - p.dry;
        float size = (0.75f + 0.25f * std::min(1.0f, 3.0f * age)) * (dry ? 0.85f : 1.0f);
        grow_frond(rachis, leaflets, p, from, tilt(frame, down), size, dry, i + 1, own);
    }
}

}  // namespace

PlantDescription grow_palm(const PalmParameters& p, Random random) {
    PartBuilder trunk("trunk", PartKind::automatic, false), rachis("rachis", PartKind::lines, false),
        leaflets("leaflets", PartKind::automatic, true);
    Random own = random.fork(1);
    Frame frame = roll(Frame{}, own.next_in(0.0f, 2.0f * k_pi));
    frame = tilt(frame, p.trunk_lean_rad * own.next_around(1.0f, 0.4f));
    // It leans at the foot and rights itself; each ring is the scar of a frond: a step outwards and back.
    std::vector<TubeRing> rings;
    vec3 position(0, -0.6f * p.trunk_radius_m, 0);
    float step_m = (p.trunk_height_m + 0.6f * p.trunk_radius_m) / float(p.trunk_rings);
    float right = -p.trunk_lean_rad * 0.9f / float(p.trunk_rings);
    for (uint32_t i = 0; i < p.trunk_rings; ++i) {
        float t = float(i) / float(p.trunk_rings);
        float radius = p.trunk_radius_m * (1.0f + 0.45f * portable_exp(-9.0f * t) - 0.18f * t) *
                       own.next_around(1.0f, 0.03f);
        vec3 light = vary_color(p.trunk_color_linear, {0.12f, 0.04f}, own);
        rings.push_back({position, frame, radius * 0.94f, p.ring_color_linear});
        rings.push_back({position + frame.along * (0.75f * step_m), frame, radius * 1.05f, light});
        position += frame.along * step_m;
        frame = tilt(frame, right);
    }
    // The heart: leaf bases close the top.
    rings.push_back({position, frame, 0.95f * p.trunk_radius_m, p.fronds.rachis_color_linear * 0.8f});
    rings.push_back({position + frame.along * (1.2f * p.trunk_radius_m), frame, 0.5f * p.trunk_radius_m,
                     p.fronds.rachis_color_linear});
    rings.push_back(
        {position + frame.along * (2.5f * p.trunk_radius_m), frame, 0.0f, p.fronds.rachis_color_linear});
    add_tube(trunk, rings, p.trunk_sides, true, 0, 0);
    grow_crown(rachis, leaflets, p.fronds, position + frame.along * (0.7f * p.trunk_radius_m), frame,
               0.5f * p.trunk_radius_m, random.fork(2));
    PlantDescription plant;
    plant.parts.push_back(trunk.take());
    plant.parts.push_back(rachis.take());
    plant.parts.push_back(leaflets.take());
    return plant;
}

PlantDescription grow_fern(const FrondParameters& p, Random random) {
    PartBuilder rachis("rachis", PartKind::lines, false), leaflets("leaflets", PartKind::automatic, true);
    grow_crown(rachis, leaflets, p, vec3(0), Frame{}, 2.0f * p.radius_m, random);
    PlantDescription plant;
    plant.parts.push_back(rachis.take());
    plant.parts.push_back(leaflets.take());
    return plant;
}

}  // namespace coppice::modeller
