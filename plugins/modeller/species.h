// A species file in memory: what one kind of plant looks like, in metres and radians, with every value
// checked. README.md lists the keys. Defaults here are the defaults of the file.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>
#include "plugins/modeller/shape_ratio.h"
#include "runtime/core/math.h"
#include "runtime/core/result.h"

namespace coppice::modeller {

inline constexpr double k_triangle_limit =
    20e6;  // of one plant; more would be a mistake, and fill the memory
inline constexpr float k_degree = k_pi / 180.0f;

enum class PlantForm : uint32_t { tree, palm, fern, grass, flower };

enum class LeafShape : uint32_t { rhombic, ovate, lanceolate, birch, oak, heart, spoon, petal, needles };

// A value drawn for each piece: uniform in center +- spread.
struct Varied {
    float center = 0.0f, spread = 0.0f;
};

struct ColorVariation {
    float brightness = 0.15f;  // relative, +-
    float hue = 0.1f;          // towards yellow or towards blue, +-
};

// One leaf, petal or cluster of needles.
struct LeafParameters {
    LeafShape shape = LeafShape::ovate;
    uint32_t count = 20;  // on one twig, stem or rosette
    float length_m = 0.1f, width_m = 0.06f, size_variation = 0.2f;
    Varied down_angle{45 * k_degree, 15 * k_degree};    // from the twig's direction
    Varied rotation{137.5f * k_degree, 15 * k_degree};  // about the twig, from leaf to leaf
    float first_fraction = 0.1f;                        // of the twig, free of leaves
    float last_fraction = 1.0f;
    float bend = 0.3f;                // W&P: turn of the upper side towards the light, [0, 1]
    float droop_rad = 0;              // turn of the tip towards the ground
    float fold_rad = 20 * k_degree;   // of the halves along the midrib
    float curve_rad = 25 * k_degree;  // of the midrib from foot to tip, downwards
    uint32_t needles = 6;             // of one cluster
    float needle_spread_rad = 35 * k_degree;
    vec3 color_linear{0.07f, 0.14f, 0.03f};
    vec3 young_color_linear{0.10f, 0.18f, 0.04f};  // outside of the crown, tip of a leaf
    float inner_brightness = 0.7f;                 // of the leaves near the crown's middle
    ColorVariation variation;
};

struct BarkParameters {
    vec3 color_linear{0.13f, 0.10f, 0.07f};
    vec3 foot_color_linear{0.11f, 0.085f, 0.06f};
    vec3 twig_color_linear{0.10f, 0.075f, 0.05f};
    vec3 patch_color_linear{0.03f, 0.028f, 0.025f};
    float foot_fraction = 0.15f;  // of the height, where the foot's colour has faded
    float streaks = 0.35f;        // how much darker vertical furrows are
    float patches = 0.0f;         // share of the trunk under large dark patches
    uint32_t marks = 0;           // scars across the trunk, in the patches' colour
    uint32_t furrows = 0;         // dark furrows along the trunk
};

// W&P's parameters of one level of stems, in their order.
struct LevelParameters {
    uint32_t count = 20;  // on one stem of the level below; of level 0: trunks
    Varied length{0.4f, 0.05f};
    float taper = 1.0f;
    uint32_t segments = 4, sides = 4, rings = 1;  // rings of the mesh in one segment
    float curve_rad = 0, curve_back_rad = 0, curve_variation_rad = 30 * k_degree;
    uint32_t base_splits = 0;
    float segment_splits = 0;
    Varied split_angle{25 * k_degree, 5 * k_degree};
    Varied down_angle{50 * k_degree, 10 * k_degree};  // spread < 0: varies along the parent, as in the paper
    Varied rotation{140 * k_degree, 20 * k_degree};   // center < 0: alternates left and right
    uint32_t whorl = 1;                               // stems that leave the parent at one height
    float first_fraction = 0.1f, last_fraction = 1.0f;  // of the parent, where stems leave
    float attraction_up = 0.0f;
};

struct PruneParameters {
    float ratio = 0.0f;  // 0: not pruned, 1: wholly
    float width = 0.5f, width_peak = 0.5f, power_low = 0.5f, power_high = 0.5f;
};

struct TreeParameters {
    float height_m = 10.0f, height_variation_m = 0.0f;
    Shape shape = Shape::conical;
    float base_fraction = 0.2f;  // of the trunk, free of branches
    float ratio = 0.015f, ratio_power = 1.2f, flare = 0.5f;
    uint32_t lobes = 0;
    float lobe_depth = 0.0f;
    float base_spread_m = 0.0f;  // where there is more than one trunk: radius of the circle they leave from
    float least_radius_m = 0.003f;
    float branch_radius_m = 0.0f,
          twig_radius_m = 0.0f;  // the parts' limits; 0: a fifth and a twentieth of the trunk
    PruneParameters prune;
    std::vector<LevelParameters> levels;
    uint32_t leaf_levels = 1;  // so many of the last levels carry leaves
    uint32_t triangles = 0;    // the number of leaves is chosen to reach it; 0: leaves.count decides
    BarkParameters bark;
    LeafParameters leaves;
};

// Fronds: a curved rachis with leaflets on both sides.
struct FrondParameters {
    uint32_t count = 14, segments = 8, leaflets = 50;  // leaflets of one frond, both sides together
    float length_m = 1.6f, length_variation = 0.15f;
    Varied down_angle{50 * k_degree, 35 * k_degree};  // the inner ones stand, the outer ones hang
    float arch_rad = 80 * k_degree;                   // how far a frond bends down from foot to tip
    float stalk_fraction = 0.15f;                     // free of leaflets
    float radius_m = 0.012f;
    float leaflet_length_m = 0.4f, leaflet_width_m = 0.03f, leaflet_angle_rad = 55 * k_degree;
    float leaflet_droop_rad = 35 * k_degree, leaflet_lift_rad = 20 * k_degree;
    uint32_t leaflet_segments = 2;
    vec3 color_linear{0.06f, 0.13f, 0.035f};
    vec3 tip_color_linear{0.11f, 0.17f, 0.05f};
    vec3 rachis_color_linear{0.13f, 0.15f, 0.05f};
    float dry = 0.0f;  // share of the oldest fronds that are dry and hang
    vec3 dry_color_linear{0.22f, 0.15f, 0.07f};
    ColorVariation variation;
};

struct PalmParameters {
    float trunk_height_m = 1.5f, trunk_radius_m = 0.1f, trunk_lean_rad = 6 * k_degree;
    uint32_t trunk_rings = 24, trunk_sides = 10;
    vec3 trunk_color_linear{0.18f, 0.14f, 0.10f};
    vec3 ring_color_linear{0.09f, 0.07f, 0.05f};
    FrondParameters fronds;
};

struct GrassParameters {
    uint32_t blades = 60, segments = 4;
    float height_m = 0.45f, height_variation = 0.35f;
    float width_m = 0.006f, radius_m = 0.05f;  // of a blade; of the tuft at the ground
    Varied lean{18 * k_degree, 16 * k_degree};
    Varied curve{55 * k_degree, 35 * k_degree};
    uint32_t stalks = 0;  // with a seed head
    float stalk_height_m = 0.6f;
    vec3 color_linear{0.05f, 0.10f, 0.025f};
    vec3 tip_color_linear{0.13f, 0.18f, 0.05f};
    vec3 dry_color_linear{0.26f, 0.20f, 0.10f};
    float dry = 0.1f;  // share of blades
    ColorVariation variation;
};

struct HeadParameters {
    float disc_radius_m = 0.01f, disc_height_m = 0.006f;
    uint32_t florets = 60;  // in golden-section order, each a small pyramid
    vec3 disc_color_linear{0.55f, 0.36f, 0.02f};
    vec3 disc_rim_color_linear{0.60f, 0.42f, 0.03f};
    Varied tilt{15 * k_degree, 15 * k_degree};  // of the face from upright
    uint32_t petal_rows = 1;
    LeafParameters petals;
    LeafParameters sepals;
};

struct FlowerParameters {
    uint32_t stems = 1, sides = 5, segments = 6;
    float height_m = 0.2f, height_variation = 0.2f, radius_m = 0.0015f, base_spread_m = 0.0f;
    Varied lean{8 * k_degree, 8 * k_degree};
    float curve_rad = 20 * k_degree;
    vec3 stem_color_linear{0.08f, 0.14f, 0.04f};
    LeafParameters leaves, rosette;
    float petiole = 0.0f;  // a leaf's stalk, as a share of the leaf's length
    HeadParameters head;
};

struct Species {
    std::string name;
    PlantForm form = PlantForm::tree;
    uint64_t seed = 1;
    TreeParameters tree;
    PalmParameters palm;  // ferns too: without a trunk
    GrassParameters grass;
    FlowerParameters flower;
};

// Errors: syntax (with line), name_unknown (with the nearest known key), value_out_of_range, limit_exceeded.
Result<Species> parse_species(std::string_view json, const std::string& file);

// No fewer triangles than growing can give; infinite rather than wrong. Nothing is built.
double triangle_bound(const Species& species);

}  // namespace coppice::modeller
