// Brushes and polygons: paint, erase, fill.
#include "editor/commands/brush.h"
#include "editor/commands/commands.h"
#include "editor/commands/rule_names.h"

namespace coppice {
namespace {

constexpr size_t k_stroke_point_limit = 100000;
constexpr double k_radius_limit_m = 10000.0;

std::vector<dvec2> read_stroke(JsonObject& arguments) {
    std::vector<dvec2> points;
    const nlohmann::json* list = arguments.find("stroke");
    bool good = list && list->is_array() && !list->empty() && list->size() <= k_stroke_point_limit;
    for (size_t i = 0; good && i < list->size(); ++i) {
        const auto& pair = (*list)[i];
        good = pair.is_array() && pair.size() == 2 && pair[0].is_number() && pair[1].is_number();
        if (!good) break;
        points.emplace_back(pair[0].get<double>(), pair[1].get<double>());
        good = std::abs(points.back().x) <= k_farthest_m && std::abs(points.back().y) <= k_farthest_m;
    }
    if (!good)
        arguments.report(ErrorId::value_out_of_range, "stroke", list ? "found " + shown(*list) : "missing",
                         "write up to 100000 places [x, z] within 1e7 m");
    return points;
}

}  // namespace

Result<Edit> make_paint(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, rule_names_of(context, target));
    const Region under_brush{{RegionShape{}}};
    const BrushRule rule = read_brush_rule(arguments, names, target.terrain, &under_brush);
    if (arguments.document().sound() && !(rule.scatter.density_per_m2 > 0.0))
        arguments.report(ErrorId::syntax, "scatter", "a brush needs a density", "write density_per_m2");
    if (rule.scatter.competition.crown_radius_m > 0.0)
        arguments.report(ErrorId::syntax, "scatter", "what a brush paints cannot compete while it is painted",
                         "leave compete out, and run the command compete afterwards; or fill a polygon");
    const std::vector<dvec2> points = read_stroke(arguments);
    const double radius_m = arguments.number("radius_m", 0.01, k_radius_limit_m);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    PaintStroke stroke(rule, radius_m);
    std::vector<PlacedPlant> added;
    for (const dvec2& point : points) {
        COPPICE_TRY(const std::vector<PlacedPlant> more, stroke.extend(point, target.file->plants));
        added.insert(added.end(), more.begin(), more.end());
        if (added.size() > k_plant_limit)
            return fail(ErrorId::limit_exceeded, "", "stroke", "too many plants",
                        "less density or a smaller radius");
    }
    Edit edit = edit_of(target, {}, std::move(added));
    if (!edit.files.empty()) edit.name = "paint " + count_text(context.document, edit.files[0].added);
    return edit;
}

Result<Edit> make_erase(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *target.file, target.path));
    const std::vector<uint16_t> kinds = read_populations(arguments, context.document, *target.file, names);
    const std::vector<dvec2> points = read_stroke(arguments);
    const double radius_m = arguments.number("radius_m", 0.01, k_radius_limit_m);
    const double share = arguments.number("share", 0.0, 1.0, 1.0);
    const uint64_t seed = arguments.whole("seed", 0, UINT64_MAX, 1);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    Edit edit = edit_of(target, plants_under(target.file->plants, points, radius_m, kinds, share, seed), {});
    if (!edit.files.empty()) edit.name = "erase " + count_text(context.document, edit.files[0].removed);
    return edit;
}

Result<Edit> make_fill(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, rule_names_of(context, target));
    const nlohmann::json* polygon = arguments.find("polygon");
    Region where;
    if (polygon)
        where = read_region(arguments.document(), {{"polygon", *polygon}}, arguments.place_of("polygon"));
    const BrushRule rule = read_brush_rule(arguments, names, target.terrain, polygon ? &where : nullptr);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};
    COPPICE_TRY(std::vector<PlacedPlant> added, fill_region(rule, target.file->plants));
    Edit edit = edit_of(target, {}, std::move(added));
    if (!edit.files.empty()) edit.name = "fill with " + count_text(context.document, edit.files[0].added);
    return edit;
}

}  // namespace coppice
