// Adds geometry to a part: triangles, tubes, leaves, blades. Everything that grows is written through here,
// so that triangles of no area and colours outside [0, 1] never come out.
#pragma once
#include <span>
#include <string>
#include <vector>
#include "plugins/modeller/leaf_shapes.h"
#include "plugins/modeller/species.h"
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/random.h"

namespace coppice::modeller {

// Orthonormal: side x upper = along.
struct Frame {
    vec3 side{1, 0, 0}, upper{0, 0, -1}, along{0, 1, 0};
};

// along is given; side as near to `side` as it can be.
Frame frame_of(vec3 along, vec3 side);
// Turns along about side by angle_rad: positive turns `along` away from `upper`.
Frame tilt(const Frame& frame, float angle_rad);
// Turns side about along.
Frame roll(const Frame& frame, float angle_rad);

class PartBuilder {
  public:
    explicit PartBuilder(std::string name, PartKind kind, bool leaf);

    uint32_t add_vertex(vec3 position, vec3 normal, vec3 color);
    // Left out where its area is zero.
    void add_triangle(uint32_t a, uint32_t b, uint32_t c);
    // What is added from here on belongs to the next leaf.
    void begin_element();
    void add_segment(vec3 begin, vec3 end, float begin_radius_m, float end_radius_m, uint32_t stem,
                     uint32_t level, vec3 color);

    const DescriptionVertex& vertex(uint32_t index) const { return part_.vertices[index]; }
    uint32_t triangle_count() const { return uint32_t(part_.indices.size() / 3); }
    bool empty() const { return part_.indices.empty(); }
    // Closes the last element. The builder is empty afterwards.
    PartDescription take();

  private:
    PartDescription part_;
};

// One ring of a tube.
struct TubeRing {
    vec3 center;
    Frame frame;
    float radius_m;
    vec3 color;
};

// Closes the ring of vertices [ring, ring + sides) from below, with vertices of its own.
void add_cap(PartBuilder& part, uint32_t ring, uint32_t sides, vec3 normal);

// A closed tube of one colour a ring, with a pointed end; begins with a cap if asked for. Adds its skeleton.
void add_tube(PartBuilder& part, std::span<const TubeRing> rings, uint32_t sides, bool cap, uint32_t stem,
              uint32_t level);

// A cross-section of a blade: two edges and a midrib that may lie lower.
struct BladeSection {
    vec3 center;
    Frame frame;  // along the blade
    float half_width_m;
    vec3 color;
};
// A ribbon that ends in a point: 2 triangles a section, 1 at the tip; fold_rad > 0 adds the midrib and
// doubles it. One element, with its skeleton.
void add_blade(PartBuilder& part, std::span<const BladeSection> sections, float fold_rad, uint32_t stem,
               uint32_t level);

// The colour of one leaf among many: random, around `color`.
vec3 vary_color(vec3 color, const ColorVariation& variation, Random& random);

// Places leaves of one kind. Keeps a few meshes of different curvature, made once.
class LeafPlacer {
  public:
    explicit LeafPlacer(const LeafParameters& leaves);
    // frame.along: from foot to tip. outer in [0, 1]: how near the outside of the crown; young in [0, 1].
    void place(PartBuilder& part, vec3 foot, Frame frame, float size, float outer, float young, uint32_t stem,
               Random random) const;
    uint32_t triangles_each() const { return triangles_of_leaf(leaves_.shape, leaves_.needles); }

  private:
    void place_needles(PartBuilder& part, vec3 foot, const Frame& frame, float size, vec3 color,
                       vec3 tip_color, uint32_t stem, Random& random) const;
    LeafParameters leaves_;
    std::vector<LeafMesh> meshes_;
};

// Turns a leaf's upper side towards the sky and outwards, and its tip towards the ground, as its parameters
// say.
Frame orient_leaf(const LeafParameters& leaves, Frame frame, vec3 outwards);

}  // namespace coppice::modeller
