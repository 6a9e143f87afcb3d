// Flowers with a head of ray petals around a disc: a daisy's rosette and a sunflower's leafy stem are the
// same plan.
#include <algorithm>

#include "plugins/modeller/grow.h"
#include "plugins/modeller/part_builder.h"

namespace coppice::modeller {
namespace {

constexpr float k_golden_rad = 2.39996323f;

struct Parts {
    PartBuilder stem{"stem", PartKind::lines, false};
    PartBuilder leaves{"leaves", PartKind::automatic, true};
    PartBuilder petals{"petals", PartKind::automatic, true};
    PartBuilder disc{"disc", PartKind::points, false};
};

// A leaf on a stalk of its own, so that broad leaves stand away from the stem.
void grow_leaf(Parts& parts, const FlowerParameters& p, const LeafParameters& leaves,
               const LeafPlacer& placer, vec3 foot, Frame frame, float size, float young, uint32_t stem,
               Random random) {
    if (p.petiole > 0.0f) {
        float length_m = p.petiole * leaves.length_m * size;
        float radius_m = 0.22f * p.radius_m * std::max(size, 0.4f);
        vec3 end = foot + frame.along * length_m;
        TubeRing rings[] = {
            {foot, frame, radius_m, p.stem_color_linear},
            {foot + frame.along * (0.6f * length_m), frame, radius_m * 0.8f, p.stem_color_linear},
            {end + frame.along * (0.3f * length_m), frame, 0.0f, p.stem_color_linear}};
        add_tube(parts.stem, rings, 3, false, stem, 1);
        foot = end;
        frame = tilt(frame, 0.35f);
    }
    vec3 outwards = normalize_or(vec3(frame.along.x, 0, frame.along.z), vec3(0));
    placer.place(parts.leaves, foot, orient_leaf(leaves, frame, outwards), size, 1.0f, young, stem, random);
}

// A dome around frame.along, with florets standing on it in the order of a sunflower's seeds.
void grow_disc(PartBuilder& disc, const HeadParameters& head, vec3 center, const Frame& frame,
               Random random) {
    constexpr uint32_t k_sides = 12, k_rings = 4;
    auto dome = [&](float out, float around) {
        vec3 radial = frame.side * portable_cos(around) + frame.upper * portable_sin(around);
        return center + radial * (head.disc_radius_m * out) +
               frame.along * (head.disc_height_m * (1.0f - out * out));
    };
    auto normal_at = [&](float out, float around) {
        vec3 radial = frame.side * portable_cos(around) + frame.upper * portable_sin(around);
        return normalize_or(frame.along * head.disc_radius_m + radial * (2.0f * out * head.disc_height_m),
                            frame.along);
    };
    auto color_at = [&](float out) {
        return glm::mix(head.disc_color_linear, head.disc_rim_color_linear, out * out);
    };
    uint32_t top = disc.add_vertex(dome(0, 0), frame.along, color_at(0.0f) * 0.8f);
    uint32_t previous = 0;
    for (uint32_t ring = 1; ring <= k_rings; ++ring) {
        float out = float(ring) / float(k_rings);
        uint32_t current = 0;
        for (uint32_t s = 0; s < k_sides; ++s) {
            float around = 2.0f * k_pi * float(s) / float(k_sides);
            uint32_t v = disc.add_vertex(dome(out, around), normal_at(out, around), color_at(out) * 0.8f);
            if (s == 0) current = v;
        }
        for (uint32_t s = 0; s < k_sides; ++s) {
            uint32_t t = (s + 1) % k_sides;
            if (ring == 1) {
                disc.add_triangle(top, current + s, current + t);
            } else {
                disc.add_triangle(previous + s, current + s, current + t);
                disc.add_triangle(previous + s, current + t, previous + t);
            }
        }
        previous = current;
    }
    // Underside: closed by a shallow cone.
    uint32_t bottom = disc.add_vertex(center - frame.along * (0.35f * head.disc_radius_m), -frame.along,
                                      color_at(1.0f) * 0.6f);
    for (uint32_t s = 0; s < k_sides; ++s)
        disc.add_triangle(previous + (s + 1) % k_sides, previous + s, bottom);

    float size = head.florets > 0 ? 1.1f * head.disc_radius_m / std::sqrt(float(head.florets)) : 0.0f;
    for (uint32_t i = 0; i < head.florets; ++i) {
        float out = 0.97f * std::sqrt((float(i) + 0.5f) / float(head.florets));
        float around = k_golden_rad * float(i);
        vec3 at = dome(out, around), normal = normal_at(out, around);
        vec3 color = vary_color(color_at(out), {0.3f, 0.05f}, random);
        Frame stand = roll(frame_of(normal, frame.side), around);
        vec3 corners[3];
        for (int k = 0; k < 3; ++k) {
            float turn = 2.0f * k_pi * float(k) / 3.0f;
            corners[k] = at + (stand.side * portable_cos(turn) + stand.upper * portable_sin(turn)) * size -
                         normal * (0.3f * size);
        }
        vec3 tip = at + normal * (0.9f * size);
        for (int k = 0; k < 3; ++k) {
            vec3 a = corners[k], b = corners[(k + 1) % 3];
            vec3 face = normalize_or(glm::cross(b - a, tip - a), normal);
            uint32_t v = disc.add_vertex(a, face, color * 0.7f);
            disc.add_vertex(b, face, color * 0.7f);
            disc.add_vertex(tip, face, color);
            disc.add_triangle(v, v + 1, v + 2);
        }
    }
}

void grow_head(Parts& parts, const HeadParameters& head, const LeafPlacer& petals, const LeafPlacer& sepals,
               vec3 center, Frame frame, uint32_t stem, Random random) {
    grow_disc(parts.disc, head, center, frame, random.fork(1));
    auto grow_row = [&](PartBuilder& part, const LeafParameters& leaves, const LeafPlacer& placer,
                        float start, float down, float size, Random row) {
        for (uint32_t i = 0; i < leaves.count; ++i) {
            Random own = row.fork(i);
            float step = 2.0f * k_pi / float(leaves.count);
            Frame out = roll(frame, start + step * (float(i) + own.next_in(-0.25f, 0.25f)));
            vec3 foot = center - out.upper * (0.88f * head.disc_radius_m);
            out = tilt(out, down + own.next_around(leaves.down_angle.center, leaves.down_angle.spread));
            out = roll(out, own.next_around(0.0f, 0.18f));
            placer.place(part, foot, out, size, 1.0f, own.next_unit() * 0.5f, stem, own.fork(1));
        }
    };
    for (uint32_t row = 0; row < head.petal_rows; ++row) {
        float start = float(row) * k_pi / float(std::max(head.petals.count, 1u));
        grow_row(parts.petals, head.petals, petals, start, -0.16f * float(row), 1.0f - 0.08f * float(row),
                 random.fork(2 + row));
    }
    grow_row(parts.leaves, head.sepals, sepals, 0.0f, 0.0f, 1.0f, random.fork(100));
}

}  // namespace

PlantDescription grow_flower(const FlowerParameters& p, Random random) {
    Parts parts;
    LeafPlacer leaves(p.leaves), rosette(p.rosette), petals(p.head.petals), sepals(p.head.sepals);
    for (uint32_t s = 0; s < p.stems; ++s) {
        Random own = random.fork(s);
        Random shape = own.fork(1);
        Frame frame = roll(Frame{}, k_golden_rad * float(s) + shape.next_in(0.0f, 2.0f));
        vec3 position(0);
        if (p.stems > 1)
            position = -frame.upper * (p.base_spread_m * std::sqrt((float(s) + 0.5f) / float(p.stems)));
        position.y -= p.radius_m;
        float height_m = p.height_m * shape.next_around(1.0f, p.height_variation);
        frame = tilt(frame, shape.next_around(p.lean.center, p.lean.spread));
        float curve = p.curve_rad * shape.next_around(1.0f, 0.5f) / float(p.segments);
        std::vector<TubeRing> rings;
        for (uint32_t i = 0; i <= p.segments; ++i) {
            float t = float(i) / float(p.segments);
            vec3 color = p.stem_color_linear * (0.8f + 0.25f * t);
            rings.push_back({position, frame, p.radius_m * (1.0f - 0.4f * t), color});
            position += frame.along * (height_m / float(p.segments));
            frame = tilt(frame, -curve + shape.next_around(0.0f, 0.03f));
            frame = roll(frame, shape.next_around(0.0f, 0.1f));
        }
        for (uint32_t i = 0; i < p.leaves.count; ++i) {
            Random leaf = own.fork(100 + i);
            float t = p.leaves.first_fraction + (p.leaves.last_fraction - p.leaves.first_fraction) *
                                                    (float(i) + 0.5f) / float(p.leaves.count);
            float x = t * float(p.segments);
            size_t k = std::min(size_t(x), rings.size() - 2);
            vec3 foot = glm::mix(rings[k].center, rings[k + 1].center, x - float(k));
            Frame out =
                roll(rings[k].frame, leaf.next_around(p.leaves.rotation.center, p.leaves.rotation.spread) +
                                         p.leaves.rotation.center * float(i));
            out = tilt(out, leaf.next_around(p.leaves.down_angle.center, p.leaves.down_angle.spread));
            // Leaves are largest below the middle of the stem.
            float size =
                0.35f + 0.65f * portable_sin(k_pi * std::clamp(0.25f + 0.72f * (1.0f - t), 0.0f, 1.0f));
            grow_leaf(parts, p, p.leaves, leaves, foot, out, size, t, s, leaf.fork(1));
        }
        // The stem's end is the head's underside; the face tilts from the stem.
        vec3 center = rings.back().center;
        rings.back().center -= frame.along * (0.2f * p.head.disc_radius_m);
        rings.push_back(
            {center + frame.along * (0.3f * p.head.disc_height_m), frame, 0.0f, p.stem_color_linear});
        add_tube(parts.stem, rings, p.sides, true, s, 0);
        Frame face = tilt(frame, shape.next_around(p.head.tilt.center, p.head.tilt.spread));
        grow_head(parts, p.head, petals, sepals, center, face, s, own.fork(2));
    }
    for (uint32_t i = 0; i < p.rosette.count; ++i) {
        Random leaf = random.fork(1000000 + i);
        Frame out =
            roll(Frame{}, k_golden_rad * float(i) + leaf.next_around(0.0f, p.rosette.rotation.spread));
        vec3 foot = -out.upper * (p.base_spread_m * std::sqrt(leaf.next_unit()));
        out = tilt(out, leaf.next_around(p.rosette.down_angle.center, p.rosette.down_angle.spread));
        rosette.place(parts.leaves, foot + vec3(0, 0.002f, 0), orient_leaf(p.rosette, out, vec3(0)), 1.0f,
                      1.0f, leaf.next_unit() * 0.6f, p.stems + i, leaf.fork(1));
    }
    PlantDescription plant;
    for (PartBuilder* part : {&parts.stem, &parts.leaves, &parts.petals, &parts.disc}) {
        if (!part->empty()) plant.parts.push_back(part->take());
    }
    return plant;
}

}  // namespace coppice::modeller
