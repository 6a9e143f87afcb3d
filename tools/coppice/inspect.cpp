// `coppice inspect`: what is inside a packed plant.
#include <cstring>
#include <memory>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/hash.h"
#include "tools/coppice/command.h"
#include "tools/coppice/describe_plant.h"

namespace coppice {
namespace {

constexpr const char* k_examples = R"(
Examples:
  coppice inspect out/birch.plant
  coppice inspect out/birch.plant --json | jq '.parts[].points'

Columns: k triangles, n_p points and n_l lines stored, A area, l length of the lines, eps_l their largest distance
from the surface; flags: c closed (only the front half can be seen), l leaf (two-sided, lets light through).)";

struct InspectCommand {
    std::string file;
    bool json = false;
};

std::string flags_of(const PackedPart& part) {
    return fmt::format("{}{}", part.flags & 1 ? 'c' : '-', part.flags & 2 ? 'l' : '-');
}

std::string name_of(const PackedPart& part) {
    return std::string(part.name, strnlen(part.name, sizeof part.name));
}

void print_json(const Plant& plant) {
    using nlohmann::json;
    json parts = json::array();
    for (const PackedPart& part : plant.parts)
        parts.push_back({{"name", name_of(part)},
                         {"kind", part.kind == PackedPartKind::lines ? "lines" : "points"},
                         {"closed", (part.flags & 1) != 0},
                         {"leaf", (part.flags & 2) != 0},
                         {"importance", part.importance},
                         {"triangles", part.triangle_count},
                         {"points", part.point_count},
                         {"lines", part.line_count},
                         {"area_m2", part.area_m2},
                         {"line_length_m", part.line_length_m},
                         {"line_error_m", part.line_error_m},
                         {"mean_color_linear", part.mean_color_linear}});
    const Box& box = plant.bounds_plant;
    json all{{"name", plant.name},
             {"hash", hash_to_hex(plant.content_hash)},
             {"bounds_min_m", {box.min.x, box.min.y, box.min.z}},
             {"bounds_max_m", {box.max.x, box.max.y, box.max.z}},
             {"triangles", plant.triangle_vertices.size() / 3},
             {"points", plant.points.size()},
             {"lines", plant.line_vertices.size() / 2},
             {"dropped_triangles", plant.dropped_triangles},
             {"dropped_vertices", plant.dropped_vertices},
             {"parts", std::move(parts)}};
    fmt::print("{}\n", all.dump(2, ' ', false, json::error_handler_t::replace));
}

Status run(const InspectCommand& command) {
    COPPICE_TRY(const Plant plant, load_plant(command.file));
    if (command.json)
        print_json(plant);
    else
        fmt::print("{}", describe_plant(plant));
    return {};
}

}  // namespace

std::string describe_plant(const Plant& plant) {
    const vec3 size = plant.bounds_plant.size();
    std::string text = fmt::format(
        "{}: {:.2f} m high, {:.2f} x {:.2f} m wide, {} triangles, {} points, {} lines, hash {}\n", plant.name,
        plant.bounds_plant.max.y, size.x, size.z, plant.triangle_vertices.size() / 3, plant.points.size(),
        plant.line_vertices.size() / 2, hash_to_hex(plant.content_hash));
    if (plant.dropped_triangles > 0 || plant.dropped_vertices > 0)
        text += fmt::format("left out: {} triangles without area or not finite, {} vertices of no triangle\n",
                            plant.dropped_triangles, plant.dropped_vertices);
    text += fmt::format("  {:<20}{:<8}{:<6}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>11}  mean colour\n", "part", "kind",
                        "flags", "k", "n_p", "n_l", "A m2", "l m", "eps_l mm", "importance");
    for (const PackedPart& part : plant.parts)
        text += fmt::format("  {:<20.19}{:<8}{:<6}{:>10}{:>10}{:>10}{:>10.3f}{:>10.2f}{:>10.2f}{:>11.2f}  {:.2f} {:.2f} "
                            "{:.2f}\n",
                            name_of(part), part.kind == PackedPartKind::lines ? "lines" : "points", flags_of(part),
                            part.triangle_count, part.point_count, part.line_count, part.area_m2, part.line_length_m,
                            part.line_error_m * 1000.0f, part.importance, part.mean_color_linear[0],
                            part.mean_color_linear[1], part.mean_color_linear[2]);
    return text;
}

void add_inspect(CLI::App& app, Command& chosen) {
    auto command = std::make_shared<InspectCommand>();
    CLI::App* inspect = app.add_subcommand("inspect", "Show what is inside a packed plant");
    inspect->footer(k_examples);
    inspect->add_option("file", command->file, "The packed plant, *.plant")->required();
    inspect->add_flag("--json", command->json, "As JSON");
    inspect->callback([command, &chosen] { chosen = [command] { return run(*command); }; });
}

}  // namespace coppice
