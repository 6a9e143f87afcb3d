#include "plugins/vegetation/eco/read_references.h"

#include <fmt/format.h>
#include "plugins/vegetation/eco/read_scatter.h"

namespace coppice {
namespace {

void read_grid(JsonObject grid, SceneReference& reference) {
    reference.columns = uint32_t(grid.whole("columns", 1, k_plant_limit));
    reference.rows = uint32_t(grid.whole("rows", 1, k_plant_limit));
    reference.spacing_m = grid.number("spacing_m", 0.001, k_farthest_m);
    reference.turn_step_deg = grid.number("turn_step_deg", -360.0, 360.0, 0.0);
    grid.close();
    if (reference.copy_count() > k_plant_limit)
        grid.report(ErrorId::limit_exceeded, "columns",
                    fmt::format("{} x {} copies", reference.columns, reference.rows),
                    fmt::format("at most {} plants stand in a scene", k_plant_limit));
}

}  // namespace

std::vector<SceneReference> read_references(std::vector<JsonObject> entries,
                                            const std::filesystem::path& folder) {
    std::vector<SceneReference> references;
    for (size_t i = 0; i < entries.size(); ++i) {
        JsonObject& entry = entries[i];
        SceneReference reference;
        reference.place = fmt::format("references[{}]", i);
        reference.path = (folder / entry.text("scene")).lexically_normal().string();
        const nlohmann::json* at = entry.find("at");
        reference.on_ground = !at || (at->is_array() && at->size() == 2);
        auto place = entry.numbers("at", reference.on_ground ? 2 : 3, -k_farthest_m, k_farthest_m,
                                   std::vector<double>(3, 0.0));
        reference.at = dvec3(place.front(), reference.on_ground ? 0.0 : place[1], place.back());
        reference.turn_deg = entry.number("turn_deg", -360.0, 360.0, 0.0);
        reference.scale = entry.number("scale", double(k_scale_least), double(k_scale_most), 1.0);
        if (entry.has("grid")) read_grid(entry.object("grid"), reference);
        entry.close();
        references.push_back(std::move(reference));
    }
    return references;
}

}  // namespace coppice
