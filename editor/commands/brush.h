// Painting along a stroke, piece by piece as the hand moves: what a script paints at once is what the hand painted.
#pragma once
#include <optional>
#include "editor/commands/target.h"

namespace coppice {

// A rule as in "scatter" of a scene's placements.
struct BrushRule {
    ScatterSettings scatter;
    Region within;  // beside the scatter's own; no shape: everywhere
};
// Argument "scatter". where: in place of the rule's region, which then only limits it; null: the rule's own.
BrushRule read_brush_rule(JsonObject& arguments, const SceneNames& names, const Terrain* terrain,
                          const Region* where);

class PaintStroke {
  public:
    // Requires a rule with a density.
    PaintStroke(BrushRule rule, double radius_m) : rule_(std::move(rule)), radius_m_(radius_m) {}

    // What grows where the brush came now and was not before: of the rule's density, and not nearer than its spacing to plants
    // that stand there or came with this stroke. Errors: scatter's.
    Result<std::vector<PlacedPlant>> extend(dvec2 to, const PlantSet& there);

  private:
    BrushRule rule_;
    double radius_m_;
    Region painted_;
    std::vector<dvec2> points_;
    PlantSet added_;
};

// What is placed by the rule, but for plants too near to those that stand there. Errors: scatter's.
Result<std::vector<PlacedPlant>> fill_region(const BrushRule& rule, const PlantSet& there);

// Plants under a stroke; share < 1: so many of them, by chance from the seed.
std::vector<PlacedPlant> plants_under(const PlantSet& plants, const std::vector<dvec2>& stroke,
                                      double radius_m, const std::vector<uint16_t>& kinds, double share,
                                      uint64_t seed);

}  // namespace coppice
