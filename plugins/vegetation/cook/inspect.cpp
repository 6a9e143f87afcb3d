#include "plugins/vegetation/cook/inspect.h"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/plant/direction_form.h"
#include "plugins/vegetation/plant/leaf_range.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

std::string srgb_hex(const float color_linear[3]) {
    std::string text = "#";
    for (int c = 0; c < 3; ++c)
        text += fmt::format("{:02x}", int(linear_to_srgb(color_linear[c]) * 255.0f + 0.5f));
    return text;
}

const char* name_of_kind(const PackedPart& part) {
    return part.kind == PackedPartKind::lines ? "lines" : "points";
}

ptrdiff_t cell_count(const Plant& plant, const PackedPart& part) {
    const auto index = uint32_t(&part - plant.parts.data());
    return std::count_if(plant.cells.begin(), plant.cells.end(),
                         [index](const PackedPart& cell) { return cell.part == index; });
}

// At d' = 1 px, of which leaves cover these multiples: the range in which FoliageMode::automatic draws them.
struct LeafSizes {
    float from_px2, to_px2;  // of the crown's own leaves; to <= from: nowhere
};
LeafSizes leaf_sizes(const Plant& plant, const PackedCrown& crown) {
    const LeafRange range =
        automatic_leaf_range(plant.parts[crown.part], crown.full_count, crown.least_count);
    return {range.from / float(crown.full_count), range.to / float(crown.full_count)};
}

}  // namespace

std::string inspect_plant(const Plant& plant) {
    vec3 size = plant.bounds_plant.size();
    std::string text = fmt::format(
        "{}: {} parts, {} cells, {} triangles, {} points, {} lines; {:.2f} x {:.2f} x {:.2f} m; content {}\n",
        plant.name, plant.parts.size(), plant.cells.size(), plant.triangle_vertices.size() / 3,
        plant.points.size(), plant.line_vertices.size() / 2, size.x, size.y, size.z,
        hash_to_hex(plant.content_hash));
    text +=
        fmt::format("{:<16} {:<6} {:<6} {:>5} {:>9} {:>9} {:>7} {:>9} {:>9} {:>8} {:>6} {:>9} {:>9} {:>8}\n",
                    "part", "far as", "sides", "cells", "triangles", "points", "lines", "area m2", "length m",
                    "eps_l mm", "import", "above m2", "beside m2", "colour");
    for (const PackedPart& part : plant.parts) {
        const char* sides = part.flags & k_part_closed ? "closed"
                            : part.flags & k_part_leaf ? "leaf"
                                                       : "open";
        text += fmt::format(
            "{:<16} {:<6} {:<6} {:>5} {:>9} {:>9} {:>7} {:>9.3f} {:>9.2f} {:>8.2f} {:>6.2f} {:>9.3f} "
            "{:>9.3f} "
            "{:>8}\n",
            part.name, name_of_kind(part), sides, cell_count(plant, part), part.triangle_count,
            part.point_count, part.line_count, part.area_m2, part.line_length_m, part.line_error_m * 1000.0f,
            part.importance, part.projected_area_m2.evaluate(vec3(0, 1, 0)),
            part.projected_area_m2.evaluate(vec3(1, 0, 0)), srgb_hex(part.mean_color_linear));
    }
    for (const PackedCrown& crown : plant.crowns) {
        const LeafSizes sizes = leaf_sizes(plant, crown);
        text += fmt::format("{}: {} leaves, joined down to {}; ", plant.parts[crown.part].name, crown.full_count,
                            crown.least_count);
        text += sizes.from_px2 < sizes.to_px2
                    ? fmt::format("drawn where one covers {:.1f} to {:.1f} d'^2 in the mean; smaller and larger ones as points or triangles\n",
                                  sizes.from_px2, sizes.to_px2)
                    : "never drawn: points or triangles are better\n";
    }
    text += fmt::format(
        "bytes: parts {}, cells {}, triangle vertices {}, points {}, point owners {}, line vertices {}, leaves {}\n",
        plant.parts.size_bytes(), plant.cells.size_bytes(), plant.triangle_vertices.size_bytes(),
        plant.points.size_bytes(), plant.point_owners.size_bytes(), plant.line_vertices.size_bytes(), plant.leaves.size_bytes());
    if (plant.dropped_triangles || plant.dropped_vertices)
        text +=
            fmt::format("dropped when cooked: {} triangles without area, {} vertices without a triangle\n",
                        plant.dropped_triangles, plant.dropped_vertices);
    return text;
}

std::string inspect_plant_json(const Plant& plant) {
    using nlohmann::ordered_json;
    auto triple = [](const float v[3]) { return ordered_json{v[0], v[1], v[2]}; };
    vec3 low = plant.bounds_plant.min, high = plant.bounds_plant.max;
    ordered_json parts = ordered_json::array();
    for (const PackedPart& part : plant.parts)
        parts.push_back({{"name", part.name},
                         {"kind", name_of_kind(part)},
                         {"closed", (part.flags & k_part_closed) != 0},
                         {"leaf", (part.flags & k_part_leaf) != 0},
                         {"importance", part.importance},
                         {"cells", cell_count(plant, part)},
                         {"triangles", part.triangle_count},
                         {"points", part.point_count},
                         {"lines", part.line_count},
                         {"area_m2", part.area_m2},
                         {"line_length_m", part.line_length_m},
                         {"line_error_m", part.line_error_m},
                         {"longest_edge_m", part.longest_edge_m},
                         {"point_radius_m", part.point_radius_m},
                         {"projected_area_mean_m2", mean_over_directions(part.projected_area_m2)},
                         {"projected_area_above_m2", part.projected_area_m2.evaluate(vec3(0, 1, 0))},
                         {"projected_area_beside_m2", part.projected_area_m2.evaluate(vec3(1, 0, 0))},
                         {"projected_length_mean_m", mean_over_directions(part.projected_length_m)},
                         {"mean_color_linear", triple(part.mean_color_linear)},
                         {"bounds_min_m", triple(part.bounds_min)},
                         {"bounds_max_m", triple(part.bounds_max)}});
    ordered_json crowns = ordered_json::array();
    for (const PackedCrown& crown : plant.crowns) {
        const LeafSizes sizes = leaf_sizes(plant, crown);
        crowns.push_back({{"part", plant.parts[crown.part].name},
                          {"leaves", crown.full_count},
                          {"least_leaves", crown.least_count},
                          {"drawn", sizes.from_px2 < sizes.to_px2},
                          {"drawn_from_px2", sizes.from_px2},
                          {"drawn_to_px2", sizes.to_px2}});
    }
    ordered_json root = {{"name", plant.name},
                         {"content_hash", hash_to_hex(plant.content_hash)},
                         {"bounds_min_m", {low.x, low.y, low.z}},
                         {"bounds_max_m", {high.x, high.y, high.z}},
                         {"cells", plant.cells.size()},
                         {"triangles", plant.triangle_vertices.size() / 3},
                         {"points", plant.points.size()},
                         {"lines", plant.line_vertices.size() / 2},
                         {"dropped_triangles", plant.dropped_triangles},
                         {"dropped_vertices", plant.dropped_vertices},
                         {"bytes",
                          {{"parts", plant.parts.size_bytes()},
                           {"cells", plant.cells.size_bytes()},
                           {"triangle_vertices", plant.triangle_vertices.size_bytes()},
                           {"points", plant.points.size_bytes()},
                           {"point_owners", plant.point_owners.size_bytes()},
                           {"line_vertices", plant.line_vertices.size_bytes()},
                           {"leaves", plant.leaves.size_bytes()}}},
                         {"crowns", std::move(crowns)},
                         {"parts", std::move(parts)}};
    // A name that is not UTF-8 must not throw.
    return root.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace coppice
