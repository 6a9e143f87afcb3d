#include "plugins/modeller/stems.h"

#include <algorithm>

#include <fmt/format.h>

#include "plugins/modeller/taper.h"

namespace coppice::modeller {
namespace {

// Streams of one stem's random numbers: what one purpose draws never shifts another's.
enum Stream : uint64_t {
    k_stream_shape = 1,
    k_stream_curve,
    k_stream_children,
    k_stream_clones,
    k_stream_trunks
};

constexpr size_t k_node_limit = 20'000'000;
constexpr float k_split_radius_power = 0.42f;  // n stems after a split have each n^-p of the radius before
constexpr int k_prune_steps = 24;

// A stem that is being grown, and where its next segment begins.
struct Growing {
    Stem stem;
    Frame frame;
    vec3 position;
    uint32_t first_segment = 0;
    Frame first_frame;  // of a clone's first node
    float radius_scale = 1.0f;
    vec3 correction_axis{0};  // a split's turn is taken back over the rest of the stem
    float correction_rad = 0.0f;
};

class StemGrower {
  public:
    StemGrower(const TreeParameters& parameters, float height_m) : p_(parameters), height_m_(height_m) {
        split_error_.assign(p_.levels.size(), 0.0f);
    }

    bool grow(Random random) {
        grow_trunks(random);
        // Stems are appended level by level, so every stem is met once, after its parent.
        for (size_t i = 0; i < tree_.stems.size() && !overflow_; ++i) {
            Stem stem = tree_.stems[i];
            if (stem.level + 1 < p_.levels.size()) grow_children(stem);
        }
        return !overflow_;
    }
    StemTree& tree() { return tree_; }

  private:
    void grow_trunks(Random random) {
        const LevelParameters& level = p_.levels[0];
        for (uint32_t i = 0; i < level.count; ++i) {
            Random own = random.fork(k_stream_trunks).fork(i);
            Random shape = own.fork(k_stream_shape);
            Growing growing{Stem{0, 0, 0, 0, 1, 0, 0, 0, own}, Frame{}, vec3(0)};
            float around = float(i) * 2.39996323f + shape.next_in(0.0f, 2.0f * k_pi);
            growing.frame = roll(growing.frame, around);
            if (level.count > 1) {
                float out = p_.base_spread_m * std::sqrt((float(i) + 0.5f) / float(level.count));
                growing.position = growing.frame.upper * -out;
            }
            growing.frame =
                tilt(growing.frame, shape.next_around(level.down_angle.center, level.down_angle.spread));
            float length = std::max(shape.next_around(level.length.center, level.length.spread), 0.05f);
            growing.stem.length_m = height_m_ * length;
            growing.stem.base_radius_m = growing.stem.length_m * p_.ratio;
            grow_whole(growing);
        }
    }

    void grow_children(const Stem& parent) {
        const LevelParameters& level = p_.levels[parent.level + 1];
        float begin =
            std::max(parent.level == 0 ? p_.base_fraction : level.first_fraction, parent.first_fraction);
        float end = level.last_fraction;
        float whole = std::max(
            level.last_fraction - (parent.level == 0 ? p_.base_fraction : level.first_fraction), 1e-3f);
        if (!(end > begin)) return;
        float wanted = float(level.count) * (end - begin) / whole;
        if (parent.level == 1) wanted *= 0.2f + 0.8f * parent.relative_length;
        if (parent.level >= 2) wanted *= 1.0f - 0.5f * parent.parent_fraction;
        uint32_t count = uint32_t(wanted + 0.5f);
        uint32_t whorls = (count + level.whorl - 1) / level.whorl;
        // Clones go on turning where the whole stem's children would be.
        float turn = parent.random.fork(k_stream_children).next_in(0.0f, 2.0f * k_pi);
        for (uint32_t i = 0; i < count && !overflow_; ++i) {
            Random own = parent.random.fork(k_stream_children).fork(i);
            Random shape = own.fork(k_stream_shape);
            float spacing = (end - begin) / float(whorls);
            float jitter = level.whorl > 1 ? 0.08f : 0.35f;
            float fraction =
                begin + spacing * (float(i / level.whorl) + 0.5f + shape.next_in(-jitter, jitter));
            float rotation = shape.next_around(level.rotation.center, level.rotation.spread);
            Growing child{Stem{parent.level + 1, 0, 0, fraction, 1, 0, 0, 0, own}, Frame{}, vec3(0)};
            StemNode at = node_at(tree_, parent, fraction);
            if (level.rotation.center < 0.0f) {
                vec3 level_side = glm::cross(at.frame.along, vec3(0, 1, 0));
                Frame upright = frame_of(
                    at.frame.along, glm::dot(level_side, level_side) > 1e-4f ? -level_side : at.frame.side);
                child.frame = roll(upright, i % 2 ? k_pi + rotation : k_pi - rotation);
            } else {
                if (level.whorl > 1) {
                    turn += 2.0f * k_pi / float(level.whorl);
                    if (i % level.whorl == 0) turn += rotation;
                    child.frame = roll(at.frame, turn + shape.next_around(0.0f, level.rotation.spread));
                } else {
                    turn += rotation;
                    child.frame = roll(at.frame, turn);
                }
            }
            float crown_base = parent.level == 0 ? p_.base_fraction : 0.0f;
            child.frame =
                tilt(child.frame, down_angle(level, shape, (1.0f - fraction) / (1.0f - crown_base)));
            child.position = at.position;
            float relative = std::max(shape.next_around(level.length.center, level.length.spread), 0.02f);
            float length_m = 0.0f;
            if (parent.level == 0) {
                float ratio = shape_ratio(p_.shape, (1.0f - fraction) / (1.0f - p_.base_fraction));
                length_m = parent.length_m * relative * ratio;
                child.stem.relative_length = relative * ratio / (level.length.center + level.length.spread);
            } else {
                length_m = relative * parent.length_m * (1.0f - 0.6f * fraction);
                child.stem.relative_length = 1.0f - 0.6f * fraction;
            }
            if (!(length_m > 1e-3f)) continue;
            child.stem.length_m = length_m;
            float radius = parent.base_radius_m * portable_pow(length_m / parent.length_m, p_.ratio_power);
            child.stem.base_radius_m = std::max(std::min(radius, 0.85f * at.radius_m), p_.least_radius_m);
            if (parent.level == 0)
                child.stem.base_radius_m = std::min(child.stem.base_radius_m, 0.6f * parent.base_radius_m);
            grow_whole(child);
        }
    }

    // W&P: a negative variation opens the angle along the parent instead of at random.
    float down_angle(const LevelParameters& level, Random& random, float height_fraction) const {
        if (level.down_angle.spread >= 0.0f)
            return random.next_around(level.down_angle.center, level.down_angle.spread);
        float along = 1.0f - 2.0f * shape_ratio(Shape::conical, height_fraction);
        float jitter = random.next_around(1.0f, 0.12f);
        return (level.down_angle.center + level.down_angle.spread * along) * jitter;
    }

    // Shortens the stem until it stays inside the envelope, then keeps it. Pruning is for the crown's first
    // levels.
    void grow_whole(Growing growing) {
        float wanted_m = growing.stem.length_m;
        if (p_.prune.ratio > 0.0f && growing.stem.level == 1) {
            size_t stems = tree_.stems.size(), nodes = tree_.nodes.size();
            std::vector<float> errors = split_error_;
            float length_m = wanted_m;
            for (int step = 0; step < k_prune_steps; ++step) {
                growing.stem.length_m = length_m;
                grow_stem(growing);
                bool inside = true;
                for (size_t i = nodes; i < tree_.nodes.size(); ++i)
                    inside = inside && inside_envelope(tree_.nodes[i].position);
                tree_.stems.resize(stems, growing.stem);
                tree_.nodes.resize(nodes);
                split_error_ = errors;
                if (inside) break;
                length_m *= 0.88f;
            }
            growing.stem.length_m = glm::mix(wanted_m, length_m, p_.prune.ratio);
            growing.stem.relative_length *= growing.stem.length_m / wanted_m;
        }
        grow_stem(growing);
    }

    bool inside_envelope(vec3 position) const {
        float out_m = std::sqrt(position.x * position.x + position.z * position.z);
        float down = (height_m_ - position.y) / (height_m_ * (1.0f - p_.base_fraction));
        return out_m < height_m_ * p_.prune.width *
                           envelope_ratio(down, p_.prune.width_peak, p_.prune.power_low, p_.prune.power_high);
    }

    void grow_stem(Growing growing) {
        const LevelParameters& level = p_.levels[growing.stem.level];
        uint32_t segments = level.segments;
        Random curve = growing.stem.random.fork(k_stream_curve);
        float segment_m = growing.stem.length_m / float(segments);
        growing.stem.first_node = uint32_t(tree_.nodes.size());
        growing.stem.first_fraction = float(growing.first_segment) / float(segments);
        std::vector<Growing> clones;
        auto add_node = [&](uint32_t segment, const Frame& frame) {
            float fraction = float(segment) / float(segments);
            tree_.nodes.push_back({growing.position, frame, fraction, radius_at(growing, fraction)});
        };
        add_node(growing.first_segment, growing.first_segment > 0 ? growing.first_frame : growing.frame);
        float helix = curve.next_in(0.0f, 2.0f * k_pi);
        for (uint32_t i = growing.first_segment; i < segments; ++i) {
            turn_segment(growing, level, i, curve, helix);
            growing.position += growing.frame.along * segment_m;
            // Both ways of a split leave its node in the old direction and with what it had of thickness, and
            // turn from there, so that the fork is smooth.
            add_node(i + 1, growing.frame);
            uint32_t splits = i + 1 < segments ? splits_at(growing.stem.level, i) : 0;
            if (splits == 0) continue;
            Growing before = growing;
            before.first_segment = i + 1;
            before.first_frame = growing.frame;
            before.radius_scale *= portable_pow(float(splits + 1), -k_split_radius_power);
            float around = curve.next_in(0.0f, 2.0f * k_pi);
            for (uint32_t k = 0; k <= splits; ++k) {
                Growing after =
                    split_off(before, level, around + 2.0f * k_pi * float(k) / float(splits + 1), curve);
                if (k == 0) {
                    growing = after;
                } else {
                    after.stem.random = growing.stem.random.fork(k_stream_clones).fork(i * 32u + k);
                    clones.push_back(after);
                }
            }
        }
        growing.stem.node_count = uint32_t(tree_.nodes.size()) - growing.stem.first_node;
        tree_.stems.push_back(growing.stem);
        overflow_ = overflow_ || tree_.nodes.size() > k_node_limit;
        for (Growing& clone : clones) {
            if (overflow_) return;
            grow_stem(clone);
        }
    }

    void turn_segment(Growing& growing, const LevelParameters& level, uint32_t segment, Random& curve,
                      float helix) const {
        float n = float(level.segments);
        float bend = level.curve_rad / n;
        if (level.curve_back_rad != 0.0f) {
            bend = (segment * 2 < level.segments ? level.curve_rad : level.curve_back_rad) * 2.0f / n;
        }
        Frame& frame = growing.frame;
        if (segment > 0 || growing.stem.level > 0) {
            frame = tilt(frame, bend);
            if (level.curve_variation_rad < 0.0f) {  // W&P: a helix
                vec3 axis = rotate_about(frame.side, frame.along, helix + 2.0f * k_pi * float(segment) / n);
                turn(frame, axis, -level.curve_variation_rad / n);
            } else {
                float spread = level.curve_variation_rad / n;
                frame = tilt(frame, curve.next_around(0.0f, spread));
                turn(frame, frame.upper, curve.next_around(0.0f, spread));
            }
        }
        if (growing.correction_rad != 0.0f) turn(frame, growing.correction_axis, growing.correction_rad);
        if (level.attraction_up != 0.0f) {
            vec3 axis = glm::cross(frame.along, vec3(0, 1, 0));
            float sine = glm::length(axis);
            if (sine > 1e-4f) {
                float declination = portable_acos(frame.along.y);
                float wanted = level.attraction_up > 0.0f ? declination : k_pi - declination;
                float angle = std::min(std::fabs(level.attraction_up) * wanted * sine / n, wanted);
                turn(frame, axis / sine, level.attraction_up > 0.0f ? angle : -angle);
            }
        }
    }

    static void turn(Frame& frame, vec3 axis, float angle_rad) {
        frame =
            frame_of(rotate_about(frame.along, axis, angle_rad), rotate_about(frame.side, axis, angle_rad));
    }

    // W&P: fractions of splits are not rolled as dice but handed on, so that their number is steady.
    uint32_t splits_at(uint32_t level_index, uint32_t segment) {
        const LevelParameters& level = p_.levels[level_index];
        if (segment == 0 && level.base_splits > 0) return level.base_splits;
        if (!(level.segment_splits > 0.0f)) return 0;
        float wanted = level.segment_splits + split_error_[level_index];
        uint32_t splits = wanted > 0.0f ? uint32_t(wanted + 0.5f) : 0;
        split_error_[level_index] = wanted - float(splits);
        return splits;
    }

    Growing split_off(const Growing& before, const LevelParameters& level, float around,
                      Random& random) const {
        Growing after = before;
        float angle = std::max(random.next_around(level.split_angle.center, level.split_angle.spread), 0.0f);
        vec3 axis = rotate_about(before.frame.side, before.frame.along, around);
        turn(after.frame, axis, angle);
        uint32_t left = level.segments - before.first_segment;
        after.correction_axis = axis;
        after.correction_rad = left > 1 ? -0.6f * angle / float(left - 1) : 0.0f;
        return after;
    }

    float radius_at(const Growing& growing, float fraction) const {
        float radius = tapered_radius(p_.levels[growing.stem.level].taper, fraction,
                                      growing.stem.base_radius_m, growing.stem.length_m);
        return radius * growing.radius_scale;
    }

    const TreeParameters& p_;
    float height_m_;
    StemTree tree_{};
    std::vector<float> split_error_;  // one a level
    bool overflow_ = false;
};

}  // namespace

StemNode node_at(const StemTree& tree, const Stem& stem, float fraction) {
    const StemNode* nodes = &tree.nodes[stem.first_node];
    uint32_t i = 0;
    while (i + 2 < stem.node_count && nodes[i + 1].fraction < fraction) ++i;
    const StemNode &a = nodes[i], &b = nodes[i + 1];
    float t = std::clamp((fraction - a.fraction) / std::max(b.fraction - a.fraction, 1e-6f), 0.0f, 1.0f);
    return {glm::mix(a.position, b.position, t), frame_of(b.frame.along, b.frame.side), fraction,
            glm::mix(a.radius_m, b.radius_m, t)};
}

Result<StemTree> grow_stems(const TreeParameters& parameters, const std::string& file, Random random) {
    float height_m = random.fork(0).next_around(parameters.height_m, parameters.height_variation_m);
    StemGrower grower(parameters, height_m);
    if (!grower.grow(random)) {
        return fail(ErrorId::limit_exceeded, file, "levels",
                    fmt::format("splits and counts grew more than {} stem nodes", k_node_limit),
                    "lower segment_splits, base_splits or count");
    }
    StemTree tree = std::move(grower.tree());
    float top_m = 0.0f;
    for (const StemNode& node : tree.nodes) top_m = std::max(top_m, node.position.y);
    float scale = top_m > 0.01f * height_m ? height_m / top_m : 1.0f;
    for (StemNode& node : tree.nodes) {
        node.position *= scale;
        node.radius_m *= scale;
    }
    for (Stem& stem : tree.stems) {
        stem.length_m *= scale;
        stem.base_radius_m *= scale;
    }
    tree.height_m = height_m;
    return tree;
}

}  // namespace coppice::modeller
