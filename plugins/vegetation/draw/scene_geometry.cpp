#include "plugins/vegetation/draw/scene_geometry.h"

#include <algorithm>
#include <bit>
#include "plugins/vegetation/plant/direction_form.h"

namespace coppice {

Result<SceneGeometry> gather_geometry(const Scene& scene, std::span<const Plant> plants,
                                      std::span<const TileNode> tiles) {
    SceneGeometry geometry;
    uint64_t vertex_count = scene.terrain ? scene.terrain->vertices().size() : 0, owner_count = 0;
    for (const Plant& plant : plants) {
        vertex_count += plant.triangle_vertices.size() + plant.points.size() + plant.line_vertices.size();
        owner_count += plant.point_owners.size();
    }
    for (const TileNode& tile : tiles) {
        vertex_count += tile.cloud.points.size();
        owner_count += tile.cloud.points.size();
    }
    if (vertex_count > UINT32_MAX)
        return fail(ErrorId::limit_exceeded, scene.path, "plants", std::to_string(vertex_count) + " vertices",
                    "a scene may hold 4294967295 in all its models");
    geometry.vertices.reserve(vertex_count);
    geometry.owners.reserve(owner_count);
    auto append = [&geometry](std::span<const PackedVertex> vertices) {
        uint32_t first = uint32_t(geometry.vertices.size());
        geometry.vertices.insert(geometry.vertices.end(), vertices.begin(), vertices.end());
        return first;
    };
    for (size_t i = 0; i < plants.size(); ++i) {
        const Plant& plant = plants[i];
        DrawModel model{};
        if (!plant.bounds_plant.empty()) {
            model.center_plant = plant.bounds_plant.center();
            model.radius_m = 0.5f * glm::length(plant.bounds_plant.size());
        }
        constexpr float k_slack = 1.001f;  // rounding
        model.foot_radius_m = k_slack * (glm::length(model.center_plant) + model.radius_m);
        for (size_t line_end = 1; line_end < plant.line_vertices.size(); line_end += 2)
            geometry.most_line_width = std::max(geometry.most_line_width,
                                                std::bit_cast<float>(plant.line_vertices[line_end].surface));
        model.first_part = uint32_t(geometry.parts.size());
        model.part_count = uint32_t(plant.parts.size());
        uint32_t first_triangle_vertex = append(plant.triangle_vertices);
        uint32_t first_point = append(plant.points);
        uint32_t first_line_vertex = append(plant.line_vertices);
        uint32_t first_owner = uint32_t(geometry.owners.size());
        geometry.owners.insert(geometry.owners.end(), plant.point_owners.begin(), plant.point_owners.end());
        auto add_part = [&](PackedPart part) {
            part.importance *= i < scene.models.size() ? scene.models[i].importance : 1.0f;
            geometry.least_importance = std::min(geometry.least_importance, part.importance);
            geometry.part_geometry.push_back(
                {first_triangle_vertex + part.first_triangle * 3, first_point + part.first_point,
                 first_line_vertex + part.first_line * 2, first_owner + part.first_point,
                 (part.flags & k_part_faces_outwards) != 0, part.point_count, part.line_count});
            const vec3 low(part.bounds_min[0], part.bounds_min[1], part.bounds_min[2]);
            const vec3 high(part.bounds_max[0], part.bounds_max[1], part.bounds_max[2]);
            geometry.part_spheres.push_back({(low + high) * 0.5f, 0.5f * glm::length(high - low)});
            geometry.part_cells.push_back({});
            geometry.parts.push_back(part);
        };
        for (const PackedPart& part : plant.parts) {
            add_part(part);
            model.triangle_count += part.triangle_count;
        }
        for (const PackedPart& cell : plant.cells) {
            PartCells& cells = geometry.part_cells[model.first_part + cell.part];
            if (cells.count++ == 0) cells.first = uint32_t(geometry.parts.size());
            add_part(cell);
        }
        model.has_cells = !plant.cells.empty();
        geometry.models.push_back(model);
    }
    for (const TileNode& tile : tiles) {
        PartGeometry place{};
        place.first_point = append(tile.cloud.points);
        place.point_count = uint32_t(tile.cloud.points.size());
        place.first_owner = uint32_t(geometry.owners.size());
        for (float density : tile.cloud.densities)
            geometry.owners.push_back(std::bit_cast<uint32_t>(density));
        const float mean_area_m2 = float(mean_over_directions(tile.cloud.part.projected_area_m2));
        geometry.clouds.push_back({tile.cloud.part, mean_area_m2, tile.cloud.densities, place});
    }
    if (scene.terrain) geometry.first_terrain_vertex = append(scene.terrain->vertices());
    return geometry;
}

}  // namespace coppice
