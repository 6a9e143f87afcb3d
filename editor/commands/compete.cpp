// Plants that grow into each other until some die: circular neighbourhoods, in which the dominated give way.
// Source: Deussen et al. 1998, 4.2. Deviates: growth is the same share a step for all that are not full-grown; the smaller
// of two that meet dies at once.
#include <numeric>
#include "editor/commands/commands.h"
#include "editor/commands/target.h"

namespace coppice {
namespace {

constexpr uint32_t k_step_limit = 1000;

struct Competitor {
    dvec2 at;
    double radius_m;  // now
    double radius_most_m;
    uint32_t plant;  // of the selection
};

// Those that live, largest first wins. Equal ones: the first in order lives.
void drop_dominated(std::vector<Competitor>& living) {
    double widest_m = 0.0;
    for (const Competitor& each : living) widest_m = std::max(widest_m, each.radius_m);
    const double cell_m = std::max(2.0 * widest_m, 0.01);
    auto cell_of = [&](dvec2 at) {
        return std::pair(int64_t(std::floor(at.x / cell_m)), int64_t(std::floor(at.y / cell_m)));
    };
    std::vector<uint32_t> order(living.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return living[a].radius_m != living[b].radius_m ? living[a].radius_m > living[b].radius_m
                                                        : living[a].plant < living[b].plant;
    });
    std::map<std::pair<int64_t, int64_t>, std::vector<uint32_t>> cells;  // of those that stay
    std::vector<Competitor> left;
    for (uint32_t i : order) {
        const Competitor& each = living[i];
        const auto [x, z] = cell_of(each.at);
        bool dominated = false;
        for (int64_t dx = -1; dx <= 1 && !dominated; ++dx)
            for (int64_t dz = -1; dz <= 1 && !dominated; ++dz) {
                const auto found = cells.find({x + dx, z + dz});
                if (found == cells.end()) continue;
                for (uint32_t other : found->second)
                    if (glm::length(left[other].at - each.at) < left[other].radius_m + each.radius_m)
                        dominated = true;
            }
        if (dominated) continue;
        cells[{x, z}].push_back(uint32_t(left.size()));
        left.push_back(each);
    }
    living = std::move(left);
}

}  // namespace

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
    const uint64_t steps = arguments.whole("steps", 0, k_step_limit, 10);
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
    drop_dominated(living);
    for (uint64_t step = 0; step < steps; ++step) {
        for (Competitor& each : living)
            each.radius_m = std::min(each.radius_m * (1.0 + growth), each.radius_most_m);
        drop_dominated(living);
    }
    for (const Competitor& each : living) {
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
