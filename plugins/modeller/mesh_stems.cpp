#include "plugins/modeller/mesh_stems.h"

#include <algorithm>

#include "plugins/modeller/taper.h"

namespace coppice::modeller {
namespace {

constexpr float k_foot_depth = 1.2f;  // of the trunk's radius, under the ground, for slopes

struct Ring {
    vec3 center;
    Frame frame;
    float fraction, radius_m;
};

// Smooth value noise on a lattice, in [0, 1]; wraps around `period` in x.
float noise(float x, float y, uint32_t period, Random random) {
    float fx = std::floor(x), fy = std::floor(y);
    float tx = x - fx, ty = y - fy;
    tx = tx * tx * (3.0f - 2.0f * tx);
    ty = ty * ty * (3.0f - 2.0f * ty);
    auto at = [&](int32_t ix, int32_t iy) {
        uint32_t wrapped = uint32_t((ix % int32_t(period) + int32_t(period)) % int32_t(period));
        return random.fork(wrapped).fork(uint32_t(iy)).next_unit();
    };
    int32_t ix = int32_t(fx), iy = int32_t(fy);
    return glm::mix(glm::mix(at(ix, iy), at(ix + 1, iy), tx),
                    glm::mix(at(ix, iy + 1), at(ix + 1, iy + 1), tx), ty);
}

class StemMesher {
  public:
    StemMesher(const TreeParameters& p, const StemTree& tree, Random random)
        : p_(p), tree_(tree), bark_random_(random) {
        parts_.emplace_back("trunk", PartKind::automatic, false);
        parts_.emplace_back("branches", PartKind::lines, false);
        parts_.emplace_back("twigs", PartKind::lines, false);
        trunk_radius_m_ = 0.0f;
        for (const Stem& stem : tree.stems) trunk_radius_m_ = std::max(trunk_radius_m_, stem.base_radius_m);
        branch_radius_m_ = p.branch_radius_m > 0.0f ? p.branch_radius_m : 0.3f * trunk_radius_m_;
        twig_radius_m_ = p.twig_radius_m > 0.0f ? p.twig_radius_m : 0.08f * trunk_radius_m_;
    }

    std::vector<PartDescription> mesh() {
        for (size_t i = 0; i < tree_.stems.size(); ++i) mesh_stem(tree_.stems[i], uint32_t(i));
        std::vector<PartDescription> out;
        for (PartBuilder& part : parts_) {
            if (!part.empty()) out.push_back(part.take());
        }
        return out;
    }

  private:
    // The nodes, and between them rings on a smooth curve through them.
    void make_rings(const Stem& stem) {
        rings_.clear();
        uint32_t between = p_.levels[stem.level].rings;
        const StemNode* nodes = &tree_.nodes[stem.first_node];
        for (uint32_t i = 0; i + 1 < stem.node_count; ++i) {
            const StemNode &a = nodes[i], &b = nodes[i + 1];
            float length = glm::length(b.position - a.position);
            for (uint32_t k = 0; k < between; ++k) {
                float t = float(k) / float(between);
                // The flare needs its rings near the ground.
                if (stem.level == 0 && i == 0 && stem.first_fraction == 0.0f) t *= t;
                // Nodes carry the direction of the segment that ends there.
                vec3 from = i == 0 && stem.first_fraction == 0.0f ? b.frame.along : a.frame.along;
                float t2 = t * t, t3 = t2 * t;
                vec3 center = a.position * (2 * t3 - 3 * t2 + 1) + from * (length * (t3 - 2 * t2 + t)) +
                              b.position * (3 * t2 - 2 * t3) + b.frame.along * (length * (t3 - t2));
                vec3 along = glm::mix(from, b.frame.along, t);
                float fraction = glm::mix(a.fraction, b.fraction, t);
                rings_.push_back({center, frame_of(along, glm::mix(a.frame.side, b.frame.side, t)), fraction,
                                  glm::mix(a.radius_m, b.radius_m, t)});
            }
        }
        const StemNode& last = nodes[stem.node_count - 1];
        rings_.push_back({last.position, last.frame, last.fraction, last.radius_m});
        if (stem.level == 0) {
            for (Ring& ring : rings_) ring.radius_m *= flare_factor(p_.flare, ring.fraction);
            if (stem.first_fraction == 0.0f) {
                Ring foot = rings_[0];
                foot.center.y -= k_foot_depth * stem.base_radius_m;
                rings_.insert(rings_.begin(), foot);
            }
        }
        // A stem that does not end in a point gets one.
        Ring end = rings_.back();
        Ring& before = rings_[rings_.size() - 2];
        if (end.radius_m > 0.35f * before.radius_m) {
            end.center += end.frame.along * end.radius_m;
            rings_.push_back(end);
        }
        rings_.back().radius_m = 0.0f;
    }

    uint32_t part_of(float radius_m) const {
        return radius_m >= branch_radius_m_ ? 0 : radius_m >= twig_radius_m_ ? 1 : 2;
    }

    vec3 color_at(const Ring& ring, float around, const Stem& stem, uint32_t index) const {
        const BarkParameters& bark = p_.bark;
        float height = std::clamp(ring.center.y / tree_.height_m, 0.0f, 1.0f);
        float thick = std::clamp(ring.radius_m / std::max(trunk_radius_m_, 1e-6f), 0.0f, 1.0f);
        float twiggy = 1.0f - std::clamp((thick - 0.03f) / 0.14f, 0.0f, 1.0f);
        vec3 color = glm::mix(bark.color_linear, bark.twig_color_linear, twiggy);
        if (stem.level == 0 && bark.foot_fraction > 0.0f) {
            float foot = std::clamp(1.0f - height / bark.foot_fraction, 0.0f, 1.0f);
            color = glm::mix(color, bark.foot_color_linear, foot * foot * (3.0f - 2.0f * foot));
        }
        Random own = bark_random_.fork(index);
        if (stem.level <= 1) {
            float along_m = ring.fraction * stem.length_m;
            // Furrows run along the stem: fine around it, slow along it.
            float furrow = noise(around * 9.0f, along_m * 1.3f, 9, own.fork(1));
            color *= 1.0f - bark.streaks * (1.0f - twiggy) * furrow;
            if (bark.patches > 0.0f && twiggy < 0.8f) {
                // Patches lie across it: slow around it, fine along it.
                float patch = noise(around * 5.0f, along_m * 4.5f, 5, own.fork(2));
                float low = stem.level == 0 ? std::max(0.0f, 1.0f - 5.0f * height) * 0.2f : 0.0f;
                // Smooth noise is seldom near 0 or 1: its middle half holds most of it.
                float threshold = 0.85f - 0.7f * std::min(bark.patches + low, 1.0f);
                float inside = std::clamp((patch - threshold) * 7.0f + 0.5f, 0.0f, 1.0f);
                color = glm::mix(color, bark.patch_color_linear, inside);
            }
        }
        return color * own.fork(3).next_around(1.0f, 0.08f);
    }

    struct SurfacePoint {
        vec3 position, normal;  // normal: of an untapered stem
    };
    SurfacePoint point_on(const Ring& ring, float around, uint32_t level) const {
        float angle = 2.0f * k_pi * around;
        vec3 out = ring.frame.side * portable_cos(angle) + ring.frame.upper * portable_sin(angle);
        if (level > 0 || p_.lobes == 0) return {ring.center + out * ring.radius_m, out};
        // Lobes fade upwards.
        float fade = std::max(1.0f - 2.0f * ring.fraction, 0.0f) * p_.lobe_depth;
        float lobe = float(p_.lobes) * angle;
        vec3 tangent = ring.frame.upper * portable_cos(angle) - ring.frame.side * portable_sin(angle);
        return {ring.center + out * (ring.radius_m * (1.0f + fade * portable_sin(lobe))),
                normalize_or(out - tangent * (fade * float(p_.lobes) * portable_cos(lobe)), out)};
    }

    uint32_t add_ring(PartBuilder& part, const Ring& ring, float slope, const Stem& stem, uint32_t index,
                      uint32_t sides) const {
        uint32_t first = 0;
        for (uint32_t s = 0; s < sides; ++s) {
            float around = float(s) / float(sides);
            SurfacePoint point = point_on(ring, around, stem.level);
            uint32_t v = part.add_vertex(point.position,
                                         normalize_or(point.normal - ring.frame.along * slope, point.normal),
                                         color_at(ring, around, stem, index));
            if (s == 0) first = v;
        }
        return first;
    }

    // Detail finer than the trunk's mesh can colour: small diamonds just above its faces. Marks lie across
    // the trunk and grow tall at the foot (birch), furrows run along it (oak, pine).
    void add_bark_detail(uint32_t index, uint32_t sides) {
        Random random = bark_random_.fork(index).fork(4);
        for (uint32_t m = 0; m < p_.bark.marks; ++m) {
            float at = random.next_unit();
            at *= random.next_in(0.3f, 1.0f);  // denser towards the foot
            float height = at * tree_.height_m;
            float foot = std::clamp(1.0f - height / (0.12f * tree_.height_m), 0.0f, 1.0f);
            float half_width = random.next_in(0.16f, 0.38f);
            float half_height_m = random.next_in(0.006f, 0.016f);
            half_height_m *= 1.0f + 7.0f * foot * random.next_unit();
            vec3 color =
                glm::mix(p_.bark.patch_color_linear, p_.bark.color_linear, random.next_in(0.0f, 0.12f));
            add_diamond(at, sides, half_width, half_height_m, color, index, random);
        }
        for (uint32_t f = 0; f < p_.bark.furrows; ++f) {
            float at = random.next_unit();
            at *= random.next_in(0.2f, 1.0f);
            float half_width = random.next_in(0.06f, 0.14f);
            float half_height_m = trunk_radius_m_ * random.next_in(0.25f, 0.75f);
            add_diamond(at, sides, half_width, half_height_m, vec3(-random.next_in(0.35f, 0.6f)), index,
                        random);
        }
    }

    // at: share of the trunk's length; half_width: of one face's. A negative color is a factor on the bark's
    // own.
    void add_diamond(float at, uint32_t sides, float half_width, float half_height_m, vec3 color,
                     uint32_t index, Random& random) {
        uint32_t side = random.next_below(sides);
        float middle = random.next_in(half_width, 1.0f - half_width);
        size_t i = 1;  // ring 0 is in the ground
        while (i + 3 < rings_.size() && rings_[i + 1].fraction <= at) ++i;
        const Ring &below = rings_[i], &above = rings_[i + 1];
        if (part_of(above.radius_m) != 0) return;
        float left = float(side) / float(sides), right = float(side + 1) / float(sides);
        SurfacePoint a = point_on(below, left, 0), b = point_on(below, right, 0);
        SurfacePoint c = point_on(above, left, 0), d = point_on(above, right, 0);
        float half_height =
            std::min(half_height_m / std::max(glm::length(c.position - a.position), 1e-3f), 0.48f);
        float along = (at - below.fraction) / std::max(above.fraction - below.fraction, 1e-6f);
        float up = std::clamp(along, half_height, 1.0f - half_height);
        vec3 face = normalize_or(glm::cross(b.position - a.position, c.position - a.position), a.normal);
        if (color.x < 0.0f) color = color_at(below, left, tree_.stems[index], index) * -color;
        auto place = [&](float across, float share) {
            vec3 position = glm::mix(glm::mix(a.position, b.position, across),
                                     glm::mix(c.position, d.position, across), share);
            vec3 normal =
                glm::mix(glm::mix(a.normal, b.normal, across), glm::mix(c.normal, d.normal, across), share);
            return parts_[0].add_vertex(position + face * (0.012f * below.radius_m),
                                        normalize_or(normal, face), color);
        };
        uint32_t west = place(middle - half_width, up), south = place(middle, up - half_height);
        uint32_t east = place(middle + half_width, up), north = place(middle, up + half_height);
        parts_[0].add_triangle(west, south, east);
        parts_[0].add_triangle(west, east, north);
    }

    void mesh_stem(const Stem& stem, uint32_t index) {
        make_rings(stem);
        uint32_t sides = p_.levels[stem.level].sides;
        size_t last = rings_.size() - 1;
        auto slope_at = [&](size_t i) {
            const Ring &a = rings_[i == 0 ? 0 : i - 1], &b = rings_[std::min(i + 1, last)];
            float length = std::max(glm::length(b.center - a.center), 1e-5f);
            return std::clamp((b.radius_m - a.radius_m) / length, -1.5f, 1.5f);
        };
        uint32_t current_part = part_of(0.5f * (rings_[0].radius_m + rings_[1].radius_m));
        uint32_t previous = add_ring(parts_[current_part], rings_[0], slope_at(0), stem, index, sides);
        if (stem.level == 0 && stem.first_fraction == 0.0f) {
            add_cap(parts_[current_part], previous, sides, -rings_[0].frame.along);
        }
        for (size_t i = 0; i < last; ++i) {
            const Ring &ring = rings_[i], &next = rings_[i + 1];
            // Parts change where the thickness passes their limit, towards the thinner only.
            uint32_t wanted = std::max(current_part, part_of(0.5f * (ring.radius_m + next.radius_m)));
            if (wanted != current_part) {
                current_part = wanted;
                previous = add_ring(parts_[current_part], ring, slope_at(i), stem, index, sides);
            }
            PartBuilder& part = parts_[current_part];
            part.add_segment(ring.center, next.center, ring.radius_m, next.radius_m, index, stem.level,
                             color_at(ring, 0.37f, stem, index));
            if (i + 1 == last) {
                uint32_t tip =
                    part.add_vertex(next.center, next.frame.along, color_at(next, 0.0f, stem, index));
                for (uint32_t s = 0; s < sides; ++s)
                    part.add_triangle(previous + s, previous + (s + 1) % sides, tip);
                break;
            }
            uint32_t current = add_ring(part, next, slope_at(i + 1), stem, index, sides);
            for (uint32_t s = 0; s < sides; ++s) {
                uint32_t t = (s + 1) % sides;
                part.add_triangle(previous + s, previous + t, current + t);
                part.add_triangle(previous + s, current + t, current + s);
            }
            previous = current;
        }
        if (stem.level == 0 && stem.first_fraction == 0.0f && rings_.size() > 3)
            add_bark_detail(index, sides);
    }

    const TreeParameters& p_;
    const StemTree& tree_;
    Random bark_random_;
    std::vector<PartBuilder> parts_;
    std::vector<Ring> rings_;
    float trunk_radius_m_, branch_radius_m_, twig_radius_m_;
};

}  // namespace

std::vector<PartDescription> mesh_stems(const TreeParameters& parameters, const StemTree& tree,
                                        Random random) {
    return StemMesher(parameters, tree, random).mesh();
}

}  // namespace coppice::modeller
