#include "editor/commands/brush.h"

#include "runtime/core/hash.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

RegionShape stroke_shape(std::span<const dvec2> points, double radius_m) {
    RegionShape shape;
    shape.radius_m = radius_m;
    if (points.size() == 1) {
        shape.kind = RegionShape::Kind::circle;
        shape.center = points.front();
    } else {
        shape.kind = RegionShape::Kind::corridor;
        shape.points.assign(points.begin(), points.end());
    }
    return shape;
}

bool is_free(const PlantSet& plants, dvec2 at, double spacing_m) {
    bool free = true;
    plants.each_in(at - spacing_m, at + spacing_m, [&](const PlacedPlant& plant) {
        const dvec2 away = ground_place(plant) - at;
        free = free && glm::dot(away, away) >= spacing_m * spacing_m;
    });
    return free;
}

}  // namespace

BrushRule read_brush_rule(JsonObject& arguments, const SceneNames& names, const Terrain* terrain,
                          const Region* where) {
    BrushRule rule;
    arguments.object("scatter");
    if (!arguments.document().sound()) return rule;
    nlohmann::json text = *arguments.find("scatter");
    JsonObject object(arguments.document(), text, arguments.place_of("scatter"));
    if (const nlohmann::json* region = object.find("region"); region && where)
        rule.within = read_region(arguments.document(), *region, object.place_of("region"), names.regions);
    // The reader asks for a region, which is replaced.
    if (where) text["region"] = {{"circle", {{"center", {0, 0}}, {"radius_m", 1}}}};
    rule.scatter = read_scatter(object, names, terrain);
    if (where) rule.scatter.region = *where;
    return rule;
}

Result<std::vector<PlacedPlant>> PaintStroke::extend(dvec2 to, const PlantSet& there) {
    std::vector<dvec2> piece;
    if (!points_.empty()) piece.push_back(points_.back());
    piece.push_back(to);
    ScatterSettings settings = rule_.scatter;
    settings.region.shapes = {stroke_shape(piece, radius_m_)};
    // Only the pieces nearby matter, and a long stroke has many.
    const auto [low, high] = settings.region.bounds();
    for (const RegionShape& shape : painted_.shapes) {
        const auto [shape_low, shape_high] = Region{{shape}}.bounds();
        if (shape_low.x < high.x && shape_high.x > low.x && shape_low.y < high.y && shape_high.y > low.y)
            settings.exclude.shapes.push_back(shape);
    }
    settings.seed = hash_combine(rule_.scatter.seed, points_.size());
    COPPICE_TRY(const std::vector<Placement> grown, scatter(settings, "", "stroke"));
    std::vector<PlacedPlant> plants;
    for (const Placement& plant : grown) {
        const PlacedPlant placed = placed_from(plant);
        const dvec2 at = ground_place(placed);
        if (!rule_.within.shapes.empty() && !rule_.within.contains(at)) continue;
        if (!settings.keeps_distances(at)) continue;  // once more: its place was rounded
        if (settings.spacing_m > 0.0 &&
            (!is_free(there, at, settings.spacing_m) || !is_free(added_, at, settings.spacing_m)))
            continue;
        plants.push_back(placed);
    }
    if (settings.spacing_m > 0.0) added_.add(plants);
    painted_.shapes.push_back(settings.region.shapes.front());
    points_.push_back(to);
    return plants;
}

Result<std::vector<PlacedPlant>> fill_region(const BrushRule& rule, const PlantSet& there) {
    COPPICE_TRY(const std::vector<Placement> grown, scatter(rule.scatter, "", "scatter"));
    std::vector<PlacedPlant> plants;
    for (const Placement& plant : grown) {
        const PlacedPlant placed = placed_from(plant);
        const dvec2 at = ground_place(placed);
        if (!rule.within.shapes.empty() && !rule.within.contains(at)) continue;
        if (!rule.scatter.keeps_distances(at)) continue;
        if (rule.scatter.spacing_m > 0.0 && !is_free(there, at, rule.scatter.spacing_m)) continue;
        plants.push_back(placed);
    }
    return plants;
}

std::vector<PlacedPlant> plants_under(const PlantSet& plants, const std::vector<dvec2>& stroke,
                                      double radius_m, const std::vector<uint16_t>& kinds, double share,
                                      uint64_t seed) {
    std::vector<PlacedPlant> under;
    const Region region{{stroke_shape(stroke, radius_m)}};
    const auto [low, high] = region.bounds();
    plants.each_in(low, high, [&](const PlacedPlant& plant) {
        if (!is_chosen(kinds, plant.kind) || !region.contains(ground_place(plant))) return;
        const uint64_t name = uint64_t(uint32_t(plant.x)) << 32 | uint32_t(plant.z);
        if (double(Random(seed, name).next_unit()) < share) under.push_back(plant);
    });
    return under;
}

}  // namespace coppice
