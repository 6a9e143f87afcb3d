// Trees and shrubs: stems, their mesh, and leaves on the last levels.
#include <algorithm>

#include <fmt/format.h>

#include "plugins/modeller/grow.h"
#include "plugins/modeller/mesh_stems.h"
#include "plugins/modeller/part_builder.h"
#include "plugins/modeller/stems.h"

namespace coppice::modeller {
namespace {

enum Stream : uint64_t { k_stream_stems = 11, k_stream_bark, k_stream_leaves };

bool carries_leaves(const TreeParameters& tree, const Stem& stem) {
    return stem.level + tree.leaf_levels >= tree.levels.size();
}

// W&P: leaves of a twig by where it left its parent; of a clone, its share of the whole stem. By length too,
// so that the short twigs of a crown's top are not denser than the rest.
float leaf_weight(const Stem& stem, float mean_length_m) {
    return shape_ratio(Shape::tapered_cylindrical, 1.0f - stem.parent_fraction) *
           (1.0f - stem.first_fraction) * (0.25f + 0.75f * stem.length_m / mean_length_m);
}

float mean_leafy_length_m(const TreeParameters& parameters, const StemTree& tree) {
    double length_m = 0.0, stems = 0.0;
    for (const Stem& stem : tree.stems) {
        if (!carries_leaves(parameters, stem)) continue;
        length_m += double(stem.length_m);
        stems += 1.0;
    }
    return stems > 0.0 ? float(length_m / stems) : 1.0f;
}

// The crown as an ellipsoid, to know a leaf's place in it.
struct Crown {
    vec3 center{0}, half_size{1};
    float outer(vec3 p) const { return std::min(glm::length((p - center) / half_size), 1.0f); }
};

Crown crown_of(const TreeParameters& parameters, const StemTree& tree) {
    Box box;
    for (const Stem& stem : tree.stems) {
        if (carries_leaves(parameters, stem))
            box.include(tree.nodes[stem.first_node + stem.node_count - 1].position);
    }
    if (box.empty()) return {};
    return {box.center(), glm::max(box.size() * 0.5f, vec3(0.05f))};
}

void place_on_stem(PartBuilder& part, const LeafPlacer& placer, const LeafParameters& leaves,
                   const StemTree& tree, const Stem& stem, uint32_t stem_index, uint32_t count,
                   const Crown& crown) {
    Random random = stem.random.fork(k_stream_leaves);
    float turn = random.next_in(0.0f, 2.0f * k_pi);
    float begin = std::max(leaves.first_fraction, stem.first_fraction);
    float end = std::max(leaves.last_fraction, begin);
    for (uint32_t i = 0; i < count; ++i) {
        Random own = random.fork(i);
        // The last leaf ends the twig.
        bool terminal = i + 1 == count && leaves.last_fraction >= 1.0f;
        float fraction =
            begin + (end - begin) * (float(i) + (terminal ? 1.0f : own.next_in(0.2f, 0.8f))) / float(count);
        StemNode at = node_at(tree, stem, fraction);
        float rotation = own.next_around(leaves.rotation.center, leaves.rotation.spread);
        Frame frame;
        if (leaves.rotation.center < 0.0f) {
            vec3 level_side = glm::cross(vec3(0, 1, 0), at.frame.along);
            frame = frame_of(at.frame.along,
                             glm::dot(level_side, level_side) > 1e-4f ? level_side : at.frame.side);
            frame = roll(frame, i % 2 ? k_pi + rotation : k_pi - rotation);
        } else {
            turn += rotation;
            frame = roll(at.frame, turn);
        }
        float down = own.next_around(leaves.down_angle.center, leaves.down_angle.spread);
        frame = tilt(frame, terminal ? 0.25f * down : down);
        vec3 outwards =
            normalize_or(vec3(at.position.x - crown.center.x, 0, at.position.z - crown.center.z), vec3(0));
        frame = orient_leaf(leaves, frame, outwards);
        float outer = crown.outer(at.position);
        float young =
            fraction * fraction * own.next_in(0.2f, 1.0f) * std::clamp(2.0f * outer - 0.8f, 0.0f, 1.0f);
        placer.place(part, at.position + frame.along * at.radius_m, frame, 1.0f, outer, young, stem_index,
                     own.fork(1));
    }
}

}  // namespace

Result<PlantDescription> grow_tree(const TreeParameters& parameters, const std::string& file, Random random) {
    COPPICE_TRY(StemTree tree, grow_stems(parameters, file, random.fork(k_stream_stems)));
    PlantDescription plant;
    plant.parts = mesh_stems(parameters, tree, random.fork(k_stream_bark));
    double bark_triangles = 0.0;
    for (const PartDescription& part : plant.parts) bark_triangles += double(part.indices.size() / 3);

    float mean_length_m = mean_leafy_length_m(parameters, tree);
    double weights = 0.0;
    for (const Stem& stem : tree.stems) {
        if (carries_leaves(parameters, stem)) weights += double(leaf_weight(stem, mean_length_m));
    }
    const LeafParameters& leaves = parameters.leaves;
    LeafPlacer placer(leaves);
    double each = double(leaves.count);
    if (parameters.triangles > 0) {
        double left = double(parameters.triangles) - bark_triangles;
        if (left < 0.0) {
            return fail(ErrorId::value_out_of_range, file, "triangles",
                        fmt::format("the stems alone have {:.0f}", bark_triangles),
                        "ask for more triangles, or for fewer sides, segments, rings or stems");
        }
        each = weights > 0.0 ? left / double(placer.triangles_each()) / weights : 0.0;
    }
    PartBuilder part(leaves.shape == LeafShape::needles ? "needles" : "leaves", PartKind::automatic, true);
    Crown crown = crown_of(parameters, tree);
    double due = 0.0, placed = 0.0;
    for (size_t i = 0; i < tree.stems.size(); ++i) {
        const Stem& stem = tree.stems[i];
        if (!carries_leaves(parameters, stem)) continue;
        due += each * double(leaf_weight(stem, mean_length_m));
        if (due * placer.triangles_each() > k_triangle_limit) {
            return fail(ErrorId::limit_exceeded, file, "leaves.count",
                        fmt::format("more than {:.0f} triangles of leaves", k_triangle_limit),
                        "lower the counts");
        }
        // Rounded down: what is left over goes to the next twig, and the whole is never passed.
        uint32_t count = due > placed ? uint32_t(due - placed + 1e-6) : 0;
        placed += double(count);
        place_on_stem(part, placer, leaves, tree, stem, uint32_t(i), count, crown);
    }
    if (!part.empty()) plant.parts.push_back(part.take());
    return plant;
}

}  // namespace coppice::modeller
