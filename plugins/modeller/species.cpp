#include "plugins/modeller/species.h"

#include <algorithm>

#include <fmt/format.h>

#include "plugins/modeller/leaf_shapes.h"
#include "plugins/modeller/read_json.h"
#include "plugins/shared/json_depth.h"

namespace coppice::modeller {
namespace {

// "key_deg" and "key_variation_deg"
void read_angle(JsonReader& in, const std::string& key, Varied& value, float low_deg, float high_deg) {
    in.angle_deg((key + "_deg").c_str(), value.center, low_deg, high_deg);
    in.angle_deg((key + "_variation_deg").c_str(), value.spread, -180.0f, 180.0f);
}

void read_variation(JsonReader& in, ColorVariation& variation) {
    in.number("brightness_variation", variation.brightness, 0.0f, 0.9f);
    in.number("hue_variation", variation.hue, 0.0f, 0.9f);
}

void read_leaves(JsonReader in, LeafParameters& leaves) {
    uint32_t shape = uint32_t(leaves.shape);
    in.word("shape", shape,
            {"rhombic", "ovate", "lanceolate", "birch", "oak", "heart", "spoon", "petal", "needles"});
    leaves.shape = LeafShape(shape);
    in.count("count", leaves.count, 0, 100000);
    in.number("length_m", leaves.length_m, 0.0005f, 20.0f);
    in.number("width_m", leaves.width_m, 0.0001f, 20.0f);
    in.number("size_variation", leaves.size_variation, 0.0f, 0.9f);
    read_angle(in, "down_angle", leaves.down_angle, -180.0f, 180.0f);
    read_angle(in, "rotation", leaves.rotation, -360.0f, 360.0f);
    in.number("first_fraction", leaves.first_fraction, 0.0f, 1.0f);
    in.number("last_fraction", leaves.last_fraction, 0.0f, 1.0f);
    in.number("bend", leaves.bend, 0.0f, 1.0f);
    in.angle_deg("droop_deg", leaves.droop_rad, -90.0f, 180.0f);
    in.angle_deg("fold_deg", leaves.fold_rad, -80.0f, 80.0f);
    in.angle_deg("curve_deg", leaves.curve_rad, -180.0f, 180.0f);
    in.count("needles", leaves.needles, 1, 200);
    in.angle_deg("needle_spread_deg", leaves.needle_spread_rad, 0.0f, 120.0f);
    in.color("color_linear", leaves.color_linear);
    in.color("young_color_linear", leaves.young_color_linear);
    in.number("inner_brightness", leaves.inner_brightness, 0.0f, 1.0f);
    read_variation(in, leaves.variation);
    in.finish();
}

void read_bark(JsonReader in, BarkParameters& bark) {
    in.color("color_linear", bark.color_linear);
    in.color("foot_color_linear", bark.foot_color_linear);
    in.color("twig_color_linear", bark.twig_color_linear);
    in.color("patch_color_linear", bark.patch_color_linear);
    in.number("foot_fraction", bark.foot_fraction, 0.0f, 1.0f);
    in.number("streaks", bark.streaks, 0.0f, 1.0f);
    in.number("patches", bark.patches, 0.0f, 1.0f);
    in.count("marks", bark.marks, 0, 100000);
    in.count("furrows", bark.furrows, 0, 100000);
    in.finish();
}

void read_level(JsonReader in, LevelParameters& level) {
    in.count("count", level.count, 1, 100000);
    in.number("length", level.length.center, 0.001f, 10.0f);
    in.number("length_variation", level.length.spread, 0.0f, 10.0f);
    in.number("taper", level.taper, 0.0f, 3.0f);
    in.count("segments", level.segments, 1, 200);
    in.count("sides", level.sides, 3, 64);
    in.count("rings", level.rings, 1, 32);
    in.angle_deg("curve_deg", level.curve_rad, -720.0f, 720.0f);
    in.angle_deg("curve_back_deg", level.curve_back_rad, -720.0f, 720.0f);
    in.angle_deg("curve_variation_deg", level.curve_variation_rad, -1440.0f, 1440.0f);
    in.count("base_splits", level.base_splits, 0, 16);
    in.number("segment_splits", level.segment_splits, 0.0f, 4.0f);
    read_angle(in, "split_angle", level.split_angle, 0.0f, 120.0f);
    read_angle(in, "down_angle", level.down_angle, -180.0f, 180.0f);
    read_angle(in, "rotation", level.rotation, -360.0f, 360.0f);
    in.count("whorl", level.whorl, 1, 100);
    in.number("first_fraction", level.first_fraction, 0.0f, 1.0f);
    in.number("last_fraction", level.last_fraction, 0.0f, 1.0f);
    in.number("attraction_up", level.attraction_up, -20.0f, 20.0f);
    in.finish();
}

void read_prune(JsonReader in, PruneParameters& prune) {
    in.number("ratio", prune.ratio, 0.0f, 1.0f);
    in.number("width", prune.width, 0.01f, 10.0f);
    in.number("width_peak", prune.width_peak, 0.05f, 0.95f);
    in.number("power_low", prune.power_low, 0.0f, 10.0f);
    in.number("power_high", prune.power_high, 0.0f, 10.0f);
    in.finish();
}

void read_tree(JsonReader& in, TreeParameters& tree) {
    uint32_t shape = uint32_t(tree.shape);
    in.number("height_m", tree.height_m, 0.01f, 200.0f);
    in.number("height_variation_m", tree.height_variation_m, 0.0f, 100.0f);
    in.word("shape", shape,
            {"conical", "spherical", "hemispherical", "cylindrical", "tapered_cylindrical", "flame",
             "inverse_conical", "tend_flame"});
    tree.shape = Shape(shape);
    in.number("base_fraction", tree.base_fraction, 0.0f, 0.95f);
    in.number("ratio", tree.ratio, 0.0005f, 0.5f);
    in.number("ratio_power", tree.ratio_power, 0.1f, 5.0f);
    in.number("flare", tree.flare, 0.0f, 10.0f);
    in.count("lobes", tree.lobes, 0, 32);
    in.number("lobe_depth", tree.lobe_depth, 0.0f, 0.9f);
    in.number("base_spread_m", tree.base_spread_m, 0.0f, 20.0f);
    in.number("least_radius_m", tree.least_radius_m, 0.0001f, 1.0f);
    in.number("branch_radius_m", tree.branch_radius_m, 0.0f, 10.0f);
    in.number("twig_radius_m", tree.twig_radius_m, 0.0f, 10.0f);
    in.count("leaf_levels", tree.leaf_levels, 1, 4);
    in.count("triangles", tree.triangles, 0, uint32_t(k_triangle_limit));
    read_prune(in.object("prune"), tree.prune);
    read_bark(in.object("bark"), tree.bark);
    read_leaves(in.object("leaves"), tree.leaves);
    for (JsonReader& reader : in.array("levels", 1, 5)) {
        LevelParameters level;
        if (tree.levels.empty()) {  // the trunk's own defaults
            level.count = 1;
            level.length = {1.0f, 0.0f};
            level.segments = 10;
            level.sides = 8;
            level.down_angle = {0.0f, 0.0f};
        }
        read_level(reader, level);
        tree.levels.push_back(level);
    }
    if (tree.height_variation_m >= tree.height_m) {
        in.refuse(ErrorId::value_out_of_range, "height_variation_m",
                  fmt::format("{} is not below height_m, {}", tree.height_variation_m, tree.height_m),
                  "write a smaller variation");
    }
}

void read_fronds(JsonReader in, FrondParameters& fronds) {
    in.count("count", fronds.count, 1, 10000);
    in.count("segments", fronds.segments, 2, 100);
    in.count("leaflets", fronds.leaflets, 2, 10000);
    in.number("length_m", fronds.length_m, 0.01f, 50.0f);
    in.number("length_variation", fronds.length_variation, 0.0f, 0.9f);
    read_angle(in, "down_angle", fronds.down_angle, -180.0f, 180.0f);
    in.angle_deg("arch_deg", fronds.arch_rad, -180.0f, 270.0f);
    in.number("stalk_fraction", fronds.stalk_fraction, 0.0f, 0.9f);
    in.number("radius_m", fronds.radius_m, 0.0002f, 1.0f);
    in.number("leaflet_length_m", fronds.leaflet_length_m, 0.001f, 10.0f);
    in.number("leaflet_width_m", fronds.leaflet_width_m, 0.0005f, 10.0f);
    in.angle_deg("leaflet_angle_deg", fronds.leaflet_angle_rad, 5.0f, 120.0f);
    in.angle_deg("leaflet_droop_deg", fronds.leaflet_droop_rad, -120.0f, 180.0f);
    in.angle_deg("leaflet_lift_deg", fronds.leaflet_lift_rad, -90.0f, 90.0f);
    in.count("leaflet_segments", fronds.leaflet_segments, 1, 50);
    in.color("color_linear", fronds.color_linear);
    in.color("tip_color_linear", fronds.tip_color_linear);
    in.color("rachis_color_linear", fronds.rachis_color_linear);
    in.number("dry", fronds.dry, 0.0f, 1.0f);
    in.color("dry_color_linear", fronds.dry_color_linear);
    read_variation(in, fronds.variation);
    in.finish();
}

void read_palm(JsonReader& in, PalmParameters& palm) {
    in.number("trunk_height_m", palm.trunk_height_m, 0.05f, 100.0f);
    in.number("trunk_radius_m", palm.trunk_radius_m, 0.005f, 5.0f);
    in.angle_deg("trunk_lean_deg", palm.trunk_lean_rad, 0.0f, 60.0f);
    in.count("trunk_rings", palm.trunk_rings, 2, 1000);
    in.count("trunk_sides", palm.trunk_sides, 3, 64);
    in.color("trunk_color_linear", palm.trunk_color_linear);
    in.color("ring_color_linear", palm.ring_color_linear);
    read_fronds(in.object("fronds"), palm.fronds);
}

void read_grass(JsonReader& in, GrassParameters& grass) {
    in.count("blades", grass.blades, 1, 100000);
    in.count("segments", grass.segments, 1, 50);
    in.number("height_m", grass.height_m, 0.005f, 20.0f);
    in.number("height_variation", grass.height_variation, 0.0f, 0.9f);
    in.number("width_m", grass.width_m, 0.0002f, 1.0f);
    in.number("radius_m", grass.radius_m, 0.0f, 20.0f);
    read_angle(in, "lean", grass.lean, -90.0f, 90.0f);
    read_angle(in, "curve", grass.curve, -180.0f, 270.0f);
    in.count("stalks", grass.stalks, 0, 10000);
    in.number("stalk_height_m", grass.stalk_height_m, 0.01f, 20.0f);
    in.color("color_linear", grass.color_linear);
    in.color("tip_color_linear", grass.tip_color_linear);
    in.color("dry_color_linear", grass.dry_color_linear);
    in.number("dry", grass.dry, 0.0f, 1.0f);
    read_variation(in, grass.variation);
}

void read_head(JsonReader in, HeadParameters& head) {
    head.petals.shape = LeafShape::petal;
    head.petals.count = 21;
    head.petals.down_angle = {80 * k_degree, 8 * k_degree};
    head.petals.color_linear = {0.75f, 0.75f, 0.72f};
    head.petals.young_color_linear = {0.8f, 0.8f, 0.78f};
    head.petals.fold_rad = 8 * k_degree;
    head.petals.variation = {0.06f, 0.03f};
    head.sepals.shape = LeafShape::ovate;
    head.sepals.count = 0;
    head.sepals.down_angle = {100 * k_degree, 15 * k_degree};
    in.number("disc_radius_m", head.disc_radius_m, 0.0005f, 5.0f);
    in.number("disc_height_m", head.disc_height_m, 0.0001f, 5.0f);
    in.count("florets", head.florets, 0, 100000);
    in.color("disc_color_linear", head.disc_color_linear);
    in.color("disc_rim_color_linear", head.disc_rim_color_linear);
    read_angle(in, "tilt", head.tilt, -180.0f, 180.0f);
    in.count("petal_rows", head.petal_rows, 1, 20);
    read_leaves(in.object("petals"), head.petals);
    read_leaves(in.object("sepals"), head.sepals);
    in.finish();
}

void read_flower(JsonReader& in, FlowerParameters& flower) {
    flower.leaves.count = 0;
    flower.rosette.count = 0;
    flower.rosette.shape = LeafShape::spoon;
    flower.rosette.down_angle = {70 * k_degree, 15 * k_degree};
    in.count("stems", flower.stems, 1, 10000);
    in.count("sides", flower.sides, 3, 64);
    in.count("segments", flower.segments, 2, 100);
    in.number("height_m", flower.height_m, 0.005f, 20.0f);
    in.number("height_variation", flower.height_variation, 0.0f, 0.9f);
    in.number("radius_m", flower.radius_m, 0.0002f, 1.0f);
    in.number("base_spread_m", flower.base_spread_m, 0.0f, 20.0f);
    read_angle(in, "lean", flower.lean, -90.0f, 90.0f);
    in.angle_deg("curve_deg", flower.curve_rad, -180.0f, 180.0f);
    in.color("stem_color_linear", flower.stem_color_linear);
    in.number("petiole", flower.petiole, 0.0f, 2.0f);
    read_leaves(in.object("leaves"), flower.leaves);
    read_leaves(in.object("rosette"), flower.rosette);
    read_head(in.object("head"), flower.head);
}

Result<nlohmann::json> parse_json(std::string_view text, const std::string& file) {
    if (const auto byte = byte_nested_deeper(text))
        return fail(ErrorId::limit_exceeded, file, fmt::format("byte {}", *byte),
                    fmt::format("JSON nested deeper than {} levels", k_json_depth_limit), "a flatter file");
    try {
        return nlohmann::json::parse(text.begin(), text.end());
    } catch (const nlohmann::json::parse_error& error) {
        size_t before = std::min(error.byte, text.size());
        size_t line = 1 + size_t(std::count(text.begin(), text.begin() + ptrdiff_t(before), '\n'));
        return fail(ErrorId::syntax, file, fmt::format("line {}", line), "not well-formed JSON",
                    "check for a missing comma, quote or bracket there");
    } catch (const nlohmann::json::exception&) {
        return fail(ErrorId::value_out_of_range, file, "", "holds a number beyond double precision",
                    "write numbers of ordinary size");
    }
}

double leaf_triangles(const LeafParameters& leaves, double count) {
    return count * double(triangles_of_leaf(leaves.shape, leaves.needles));
}

double tree_bound(const TreeParameters& tree) {
    double stems = 1.0, triangles = 0.0, leafy_stems = 0.0;
    for (size_t i = 0; i < tree.levels.size(); ++i) {
        const LevelParameters& level = tree.levels[i];
        stems *= double(level.count) * double(1 + level.base_splits);
        for (uint32_t s = 1; s < level.segments && stems < 1e30; ++s)
            stems *= 1.0 + double(level.segment_splits);
        triangles += stems * (2.0 * level.sides * (double(level.segments) * level.rings + 1.0));
        if (i + tree.leaf_levels >= tree.levels.size()) leafy_stems += stems;
    }
    triangles += 2.0 * (double(tree.bark.marks) + tree.bark.furrows) *
                 (tree.levels.empty() ? 1 : tree.levels[0].count);
    double leaves = leaf_triangles(tree.leaves, leafy_stems * tree.leaves.count);
    // With a target the leaves fill what the stems leave.
    return tree.triangles ? std::max(triangles, double(tree.triangles)) : triangles + leaves;
}

double frond_bound(const FrondParameters& fronds) {
    return double(fronds.count) *
           (8.0 * fronds.segments + double(fronds.leaflets + 2) * (2.0 * fronds.leaflet_segments));
}

double flower_bound(const FlowerParameters& flower) {
    const HeadParameters& head = flower.head;
    double stalk = flower.petiole > 0.0f ? 12.0 : 0.0;
    double each = 2.0 * flower.sides * (flower.segments + 1.0) +
                  leaf_triangles(flower.leaves, flower.leaves.count) + stalk * flower.leaves.count +
                  leaf_triangles(head.petals, double(head.petals.count) * head.petal_rows) +
                  leaf_triangles(head.sepals, head.sepals.count) + 3.0 * head.florets + 400.0;
    return each * flower.stems + leaf_triangles(flower.rosette, flower.rosette.count);
}

}  // namespace

double triangle_bound(const Species& species) {
    switch (species.form) {
        case PlantForm::tree:
            return tree_bound(species.tree);
        case PlantForm::palm:
            return 2.0 * species.palm.trunk_sides * (2.0 * species.palm.trunk_rings + 2.0) +
                   frond_bound(species.palm.fronds);
        case PlantForm::fern:
            return frond_bound(species.palm.fronds);
        case PlantForm::grass:
            return double(species.grass.blades) * 2.0 * species.grass.segments + species.grass.stalks * 60.0;
        case PlantForm::flower:
            return flower_bound(species.flower);
    }
    return 0.0;
}

Result<Species> parse_species(std::string_view json, const std::string& file) {
    COPPICE_TRY(nlohmann::json root, parse_json(json, file));
    std::optional<Error> error;
    JsonReader in(root, file, "", error);
    Species species;
    uint32_t form = 0;
    in.text("name", species.name);
    in.seed("seed", species.seed);
    if (!in.has("form")) {
        in.refuse(ErrorId::value_out_of_range, "form", "missing",
                  "write one of tree, palm, fern, grass, flower");
    }
    in.word("form", form, {"tree", "palm", "fern", "grass", "flower"});
    species.form = PlantForm(form);
    if (!error) {
        switch (species.form) {
            case PlantForm::tree:
                read_tree(in, species.tree);
                break;
            case PlantForm::palm:
                read_palm(in, species.palm);
                break;
            case PlantForm::fern:
                read_fronds(in.object("fronds"), species.palm.fronds);
                break;
            case PlantForm::grass:
                read_grass(in, species.grass);
                break;
            case PlantForm::flower:
                read_flower(in, species.flower);
                break;
        }
        in.finish();
    }
    if (error) return fail(std::move(*error));
    double bound = triangle_bound(species);
    if (!(bound <= k_triangle_limit)) {
        return fail(ErrorId::limit_exceeded, file, "",
                    fmt::format("these counts can give {:.3g} triangles", bound),
                    fmt::format("lower the counts, splits, segments or sides: a plant has at most {:.0f}",
                                k_triangle_limit));
    }
    return species;
}

}  // namespace coppice::modeller
