#include "plugins/modeller/part_builder.h"

#include <algorithm>

namespace coppice::modeller {
namespace {

constexpr uint32_t k_leaf_meshes = 5;
constexpr float k_least_area_m2 = 1e-10f;

}  // namespace

Frame frame_of(vec3 along, vec3 side) {
    Frame frame;
    frame.along = normalize_or(along, vec3(0, 1, 0));
    vec3 flat = side - frame.along * glm::dot(side, frame.along);
    frame.side =
        glm::dot(flat, flat) > 1e-8f ? normalize_or(flat, vec3(1, 0, 0)) : perpendicular_to(frame.along);
    frame.upper = glm::cross(frame.along, frame.side);
    return frame;
}

Frame tilt(const Frame& frame, float angle_rad) {
    float s = portable_sin(angle_rad), c = portable_cos(angle_rad);
    return {frame.side, frame.upper * c + frame.along * s, frame.along * c - frame.upper * s};
}

Frame roll(const Frame& frame, float angle_rad) {
    float s = portable_sin(angle_rad), c = portable_cos(angle_rad);
    return {frame.side * c + frame.upper * s, frame.upper * c - frame.side * s, frame.along};
}

PartBuilder::PartBuilder(std::string name, PartKind kind, bool leaf) {
    part_.name = std::move(name);
    part_.kind = kind;
    part_.leaf = leaf;
}

uint32_t PartBuilder::add_vertex(vec3 position, vec3 normal, vec3 color) {
    part_.vertices.push_back({position, normal, glm::min(glm::max(color, vec3(0)), vec3(1))});
    return uint32_t(part_.vertices.size() - 1);
}

void PartBuilder::add_triangle(uint32_t a, uint32_t b, uint32_t c) {
    vec3 pa = part_.vertices[a].position_plant, pb = part_.vertices[b].position_plant,
         pc = part_.vertices[c].position_plant;
    vec3 area = glm::cross(pb - pa, pc - pa);
    if (!(glm::dot(area, area) > 4.0f * k_least_area_m2 * k_least_area_m2)) return;
    part_.indices.insert(part_.indices.end(), {a, b, c});
}

void PartBuilder::begin_element() {
    uint32_t triangles = triangle_count();
    std::vector<uint32_t>& firsts = part_.element_first_triangle;
    if (firsts.empty() || firsts.back() != triangles) firsts.push_back(triangles);
}

void PartBuilder::add_segment(vec3 begin, vec3 end, float begin_radius_m, float end_radius_m, uint32_t stem,
                              uint32_t level, vec3 color) {
    part_.skeleton.push_back(
        {begin, end, begin_radius_m, end_radius_m, stem, level, glm::min(glm::max(color, vec3(0)), vec3(1))});
}

PartDescription PartBuilder::take() {
    if (!part_.element_first_triangle.empty()) begin_element();
    PartDescription part = std::move(part_);
    part_ = {};
    return part;
}

void add_cap(PartBuilder& part, uint32_t ring, uint32_t sides, vec3 normal) {
    uint32_t first =
        part.add_vertex(part.vertex(ring).position_plant, normal, part.vertex(ring).color_linear);
    for (uint32_t s = 1; s < sides; ++s)
        part.add_vertex(part.vertex(ring + s).position_plant, normal, part.vertex(ring + s).color_linear);
    for (uint32_t s = 0; s + 2 < sides; ++s) part.add_triangle(first, first + s + 2, first + s + 1);
}

void add_tube(PartBuilder& part, std::span<const TubeRing> rings, uint32_t sides, bool cap, uint32_t stem,
              uint32_t level) {
    if (rings.size() < 2) return;
    auto add_ring = [&](size_t i, vec3 along, float slope) {
        uint32_t first = 0;
        for (uint32_t s = 0; s < sides; ++s) {
            float angle = 2.0f * k_pi * float(s) / float(sides);
            vec3 out = rings[i].frame.side * portable_cos(angle) + rings[i].frame.upper * portable_sin(angle);
            uint32_t v = part.add_vertex(rings[i].center + out * rings[i].radius_m,
                                         normalize_or(out - along * slope, out), rings[i].color);
            if (s == 0) first = v;
        }
        return first;
    };
    size_t last = rings.size() - 1;
    uint32_t previous = 0;
    for (size_t i = 0; i < last; ++i) {
        const TubeRing& ring = rings[i];
        const TubeRing& next = rings[i + 1];
        float length = std::max(glm::length(next.center - ring.center), 1e-6f);
        float slope = std::clamp((next.radius_m - ring.radius_m) / length, -4.0f, 4.0f);
        uint32_t current = add_ring(i, ring.frame.along, slope);
        if (i == 0 && cap) add_cap(part, current, sides, -ring.frame.along);
        for (uint32_t s = 0; s < sides; ++s) {
            uint32_t t = (s + 1) % sides;
            if (i > 0) {
                part.add_triangle(previous + s, previous + t, current + t);
                part.add_triangle(previous + s, current + t, current + s);
            }
        }
        part.add_segment(ring.center, next.center, ring.radius_m, next.radius_m, stem, level,
                         (ring.color + next.color) * 0.5f);
        previous = current;
    }
    uint32_t tip = part.add_vertex(rings[last].center, rings[last].frame.along, rings[last].color);
    for (uint32_t s = 0; s < sides; ++s) part.add_triangle(previous + s, previous + (s + 1) % sides, tip);
}

void add_blade(PartBuilder& part, std::span<const BladeSection> sections, float fold_rad, uint32_t stem,
               uint32_t level) {
    if (sections.size() < 2) return;
    part.begin_element();
    bool folded = fold_rad > 0.0f;
    float across = portable_cos(fold_rad), up = portable_sin(fold_rad);
    size_t last = sections.size() - 1;
    uint32_t left = 0, middle = 0, right = 0;
    for (size_t i = 0; i < last; ++i) {
        const BladeSection& section = sections[i];
        const Frame& frame = section.frame;
        vec3 reach = -frame.side * (section.half_width_m * across),
             lift = frame.upper * (section.half_width_m * up);
        vec3 left_normal = folded ? frame.upper * across - frame.side * up : frame.upper;
        vec3 right_normal = folded ? frame.upper * across + frame.side * up : frame.upper;
        uint32_t l = part.add_vertex(section.center - reach + lift, left_normal, section.color);
        uint32_t m = folded ? part.add_vertex(section.center, frame.upper, section.color) : l;
        uint32_t r = part.add_vertex(section.center + reach + lift, right_normal, section.color);
        auto join = [&](uint32_t a, uint32_t b, uint32_t a_next, uint32_t b_next) {
            part.add_triangle(a, b, b_next);
            part.add_triangle(a, b_next, a_next);
        };
        if (i > 0 && folded) {
            join(left, middle, l, m);
            join(middle, right, m, r);
        } else if (i > 0) {
            join(left, right, l, r);
        }
        left = l, middle = m, right = r;
    }
    const BladeSection& end = sections[last];
    uint32_t tip = part.add_vertex(end.center, end.frame.upper, end.color);
    if (folded) {
        part.add_triangle(left, middle, tip);
        part.add_triangle(middle, right, tip);
    } else {
        part.add_triangle(left, right, tip);
    }
    for (size_t i = 0; i < last; ++i) {
        part.add_segment(sections[i].center, sections[i + 1].center, sections[i].half_width_m,
                         i + 1 == last ? 0.0f : sections[i + 1].half_width_m, stem, level,
                         (sections[i].color + sections[i + 1].color) * 0.5f);
    }
}

vec3 vary_color(vec3 color, const ColorVariation& variation, Random& random) {
    float brightness = random.next_around(1.0f, variation.brightness);
    float hue = random.next_around(0.0f, variation.hue);
    return color * vec3(1.0f + 1.2f * hue, 1.0f + 0.2f * hue, 1.0f - 0.6f * hue) * brightness;
}

LeafPlacer::LeafPlacer(const LeafParameters& leaves) : leaves_(leaves) {
    if (leaves.shape == LeafShape::needles) return;
    float width_ratio = leaves.width_m / leaves.length_m;
    for (uint32_t i = 0; i < k_leaf_meshes; ++i) {
        float share = 0.4f + 1.2f * float(i) / float(k_leaf_meshes - 1);
        meshes_.push_back(make_leaf_mesh(leaves.shape, width_ratio, leaves.fold_rad * (1.4f - 0.4f * share),
                                         leaves.curve_rad * share));
    }
}

void LeafPlacer::place(PartBuilder& part, vec3 foot, Frame frame, float size, float outer, float young,
                       uint32_t stem, Random random) const {
    float shade =
        leaves_.inner_brightness + (1.0f - leaves_.inner_brightness) * std::clamp(outer, 0.0f, 1.0f);
    vec3 grown =
        glm::mix(leaves_.color_linear, leaves_.young_color_linear, 0.7f * std::clamp(young, 0.0f, 1.0f));
    vec3 color = vary_color(grown, leaves_.variation, random) * shade;
    vec3 tip_color = glm::mix(color, leaves_.young_color_linear * shade, 0.3f);
    float scale = size * leaves_.length_m * random.next_around(1.0f, leaves_.size_variation);
    if (leaves_.shape == LeafShape::needles) {
        place_needles(part, foot, frame, scale / leaves_.length_m, color, tip_color, stem, random);
        return;
    }
    const LeafMesh& mesh = meshes_[random.next_below(k_leaf_meshes)];
    // Across is -side, so that (across, along, upper) is right-handed as the mesh's frame is.
    auto world = [&](vec3 p) { return frame.along * p.y + frame.upper * p.z - frame.side * p.x; };
    part.begin_element();
    uint32_t first = 0;
    for (size_t i = 0; i < mesh.positions.size(); ++i) {
        // The midrib is a little lighter than the blade.
        float light = 1.0f + 0.12f * (1.0f - mesh.edge[i]);
        uint32_t v = part.add_vertex(foot + world(mesh.positions[i]) * scale,
                                     normalize_or(world(mesh.normals[i]), frame.upper),
                                     glm::mix(color, tip_color, mesh.along[i]) * light);
        if (i == 0) first = v;
    }
    for (const auto& t : mesh.triangles) part.add_triangle(first + t[0], first + t[1], first + t[2]);
}

// Each needle is one long triangle; a cluster opens like a brush around its axis.
void LeafPlacer::place_needles(PartBuilder& part, vec3 foot, const Frame& frame, float size, vec3 color,
                               vec3 tip_color, uint32_t stem, Random& random) const {
    part.begin_element();
    float start = random.next_in(0.0f, 2.0f * k_pi);
    for (uint32_t i = 0; i < leaves_.needles; ++i) {
        float around = start + 2.39996323f * float(i);
        // Equal shares of the cone's cap, so that needles fill the brush and not its rim alone.
        float opening = leaves_.needle_spread_rad * std::sqrt((float(i) + 0.5f) / float(leaves_.needles));
        Frame needle = tilt(roll(frame, around), opening);
        needle = roll(needle, random.next_in(0.0f, 2.0f * k_pi));
        float length_m = leaves_.length_m * size * random.next_in(0.85f, 1.15f);
        float half_width_m = 0.5f * leaves_.width_m * size;
        vec3 end = foot + needle.along * length_m;
        vec3 varied = vary_color(color, {0.08f, 0.04f}, random);
        uint32_t a = part.add_vertex(foot + needle.side * half_width_m, needle.upper, varied);
        uint32_t b = part.add_vertex(foot - needle.side * half_width_m, needle.upper, varied);
        uint32_t c = part.add_vertex(end, needle.upper, tip_color);
        part.add_triangle(a, b, c);
        part.add_segment(foot, end, half_width_m, 0.0f, stem, 0, glm::mix(varied, tip_color, 0.4f));
    }
}

Frame orient_leaf(const LeafParameters& leaves, Frame frame, vec3 outwards) {
    if (leaves.droop_rad != 0.0f) {
        vec3 axis = glm::cross(frame.along, vec3(0, -1, 0));
        float sine = glm::length(axis);
        if (sine > 1e-4f) {
            float angle = leaves.droop_rad * sine;
            frame = frame_of(rotate_about(frame.along, axis / sine, angle),
                             rotate_about(frame.side, axis / sine, angle));
        }
    }
    if (leaves.bend > 0.0f) {
        vec3 light = normalize_or(vec3(0, 1, 0) + outwards * 0.6f, vec3(0, 1, 0));
        vec3 upper = normalize_or(glm::mix(frame.upper, light, leaves.bend), frame.upper);
        vec3 side = glm::cross(upper, frame.along);
        if (glm::dot(side, side) > 1e-4f) frame = frame_of(frame.along, side);
    }
    return frame;
}

}  // namespace coppice::modeller
