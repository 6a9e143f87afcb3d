// The dominated among the chosen plants give way (eco/compete.h).
#include "editor/commands/commands.h"
#include "editor/commands/target.h"
#include "plugins/vegetation/eco/compete.h"

namespace coppice {

Result<Edit> make_compete(const CommandContext& context, JsonObject& arguments) {
    const Target target = read_target(context, arguments);
    if (!target.file) return Edit{};
    COPPICE_TRY(const SceneNames names, names_of(context.document, *target.file, target.path));
    const std::vector<PlacedPlant> plants = read_selection(arguments, context.document, *target.file, names);
    // A number for all kinds, or one each.
    const nlohmann::json* radii = arguments.find("crown_radius_m");
    std::vector<double> radius_of_kind(context.document.kinds().size(), 0.0);
    if (radii && radii->is_object()) {
        JsonObject object = arguments.object("crown_radius_m");
        for (const auto& [name, ignored] : radii->items())
            if (names.find_kind(object, name.c_str(), name))
                radius_of_kind[context.document.kind_of(name)] = object.number(name.c_str(), 0.001, 1000.0);
    } else {
        radius_of_kind.assign(radius_of_kind.size(), arguments.number("crown_radius_m", 0.001, 1000.0));
    }
    const uint64_t steps = arguments.whole("steps", 0, k_competition_step_limit, 10);
    const double growth = arguments.number("growth", 0.0, 1.0, 0.1);
    const double scale_most =
        arguments.number("scale_most", double(k_scale_least), double(k_scale_most), 1.0);
    arguments.close();
    if (!arguments.document().sound()) return Edit{};

    std::vector<Competitor> living;
    std::vector<PlacedPlant> removed, added;
    for (uint32_t i = 0; i < plants.size(); ++i) {
        const double radius_m = radius_of_kind[plants[i].kind];
        if (!(radius_m > 0.0)) continue;  // takes no part
        const double scale = double(unpack_scale(plants[i].scale));
        living.push_back(
            {ground_place(plants[i]), radius_m * scale, radius_m * std::max(scale, scale_most), i});
    }
    for (const Competitor& each : living) removed.push_back(plants[each.plant]);
    for (const Competitor& each : compete(std::move(living), uint32_t(steps), growth)) {
        PlacedPlant plant = plants[each.plant];
        plant.scale = pack_scale(float(each.radius_m / radius_of_kind[plant.kind]));
        added.push_back(plant);
    }
    const size_t dead_count = removed.size() - added.size();
    std::sort(removed.begin(), removed.end());
    std::sort(added.begin(), added.end());
    if (removed == added) return Edit{};
    Edit edit = edit_of(target, std::move(removed), std::move(added));
    edit.name =
        "let " + std::to_string(dead_count) + " of " + std::to_string(plants.size()) + " plants give way";
    return edit;
}

}  // namespace coppice
