#include "plugins/vegetation/draw/scene_geometry.h"

#include <algorithm>
#include <bit>
#include "plugins/vegetation/plant/leaf_bands.h"
#include "plugins/vegetation/plant/line_points.h"
#include "plugins/vegetation/plant/point_run.h"

namespace coppice {
namespace {

// What stands for the last part's lines where it is far.
void add_line_points(const Plant& plant, const PackedPart& part, SceneGeometry& geometry) {
    PartGeometry& place = geometry.part_geometry.back();
    place.first_point = uint32_t(geometry.vertices.size());
    place.first_owner = uint32_t(geometry.owners.size());
    place.point_count = line_point_count(part);
    for (uint32_t i = 0; i < place.point_count; ++i) {
        const LinePoint point = line_point(part, plant.line_vertices, i);
        geometry.vertices.push_back(point.vertex);
        geometry.owners.push_back(std::bit_cast<uint32_t>(pack_density(0.0, point.width_share)));
    }
}

void add_crown(const Plant& plant, const PackedCrown& crown, PartGeometry& place, SceneGeometry& geometry) {
    place.leaves = {crown.full_count, crown.least_count};
    place.first_leaf_vertex = uint32_t(geometry.vertices.size());
    const LeafGrid grid = leaf_grid(plant.parts[crown.part]);
    for (const vec3& v : {grid.origin_plant, grid.step_m}) geometry.vertices.push_back({v.x, v.y, v.z, 0});
    static_assert(sizeof(PackedLeaf) == 2 * sizeof(PackedVertex));
    for (const PackedLeaf& leaf :
         plant.leaves.subspan(crown.first_leaf, banded_leaf_count(crown.full_count, crown.least_count)))
        for (const PackedVertex& texel : std::bit_cast<std::array<PackedVertex, 2>>(leaf))
            geometry.vertices.push_back(texel);
}

}  // namespace

void set_cloud(SceneGeometry& geometry, uint32_t index, const TileCloud& cloud) {
    DrawCloud& drawn = geometry.clouds[index];
    drawn.part = cloud.part;
    drawn.densities.assign(cloud.densities.begin(), cloud.densities.end());
    drawn.geometry.point_count = uint32_t(cloud.points.size());
}

Result<SceneGeometry> gather_geometry(const Scene& scene, std::span<const Plant> plants,
                                      std::span<const TileNode> tiles) {
    const std::vector<Ground> grounds = make_grounds(scene.terrain);
    GeometrySource source{scene.path, scene.models, plants, {}, 0, grounds};
    for (const TileNode& tile : tiles) source.clouds.push_back(&tile.cloud);
    return gather_geometry(source);
}

Result<SceneGeometry> gather_geometry(const GeometrySource& source) {
    const std::span<const Plant> plants = source.plants;
    SceneGeometry geometry;
    const uint64_t reserved = uint64_t(source.streamed_clouds) * k_cloud_points;
    uint64_t vertex_count = 0, owner_count = 0;
    for (const Ground& ground : source.grounds)
        vertex_count += ground.coarse.vertices.size() + (ground.terrain ? ground.terrain->vertex_count() : 0);
    for (const Plant& plant : plants) {
        vertex_count += 2 * plant.leaves.size() + 2 * plant.crowns.size();
        vertex_count += plant.triangle_vertices.size() + plant.points.size() + plant.line_vertices.size();
        owner_count += plant.point_owners.size();
        for (const auto& parts : {plant.parts, plant.cells})
            for (const PackedPart& part : parts) {
                vertex_count += line_point_count(part);
                owner_count += line_point_count(part);
            }
    }
    for (const TileCloud* cloud : source.clouds) {
        vertex_count += cloud->points.size();
        owner_count += cloud->points.size();
    }
    if (vertex_count + reserved > UINT32_MAX)
        return fail(ErrorId::limit_exceeded, source.path, "plants",
                    std::to_string(vertex_count + reserved) + " vertices",
                    "a scene may hold 4294967295 in all its models, grounds and tiles in memory");
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
            part.importance *= i < source.models.size() ? source.models[i].importance : 1.0f;
            geometry.least_importance = std::min(geometry.least_importance, part.importance);
            geometry.part_geometry.push_back(
                {first_triangle_vertex + part.first_triangle * 3, first_point + part.first_point,
                 first_line_vertex + part.first_line * 2, first_owner + part.first_point,
                 (part.flags & k_part_faces_outwards) != 0, part.point_count, part.line_count, 0, 0, {}});
            if (part.kind == PackedPartKind::lines) add_line_points(plant, part, geometry);
            const vec3 low(part.bounds_min[0], part.bounds_min[1], part.bounds_min[2]);
            const vec3 high(part.bounds_max[0], part.bounds_max[1], part.bounds_max[2]);
            geometry.part_spheres.push_back({(low + high) * 0.5f, 0.5f * glm::length(high - low)});
            geometry.part_cells.push_back({});
            geometry.parts.push_back(part);
        };
        for (const PackedPart& part : plant.parts) {
            add_part(part);
            PartGeometry& place = geometry.part_geometry.back();
            place.point_turn_mask = point_turn_mask(place.point_count);
            model.triangle_count += part.triangle_count;
        }
        for (const PackedCrown& crown : plant.crowns)
            add_crown(plant, crown, geometry.part_geometry[model.first_part + crown.part], geometry);
        for (const PackedPart& cell : plant.cells) {
            PartCells& cells = geometry.part_cells[model.first_part + cell.part];
            if (cells.count++ == 0) cells.first = uint32_t(geometry.parts.size());
            add_part(cell);
        }
        model.has_cells = !plant.cells.empty();
        if (i < source.models.size()) model.tints = ColorTints(source.models[i].color_variation);
        geometry.has_tints |= model.tints.any();
        geometry.models.push_back(model);
    }
    for (const TileCloud* cloud : source.clouds) {
        PartGeometry place{};
        place.first_point = append(cloud->points);
        place.first_owner = uint32_t(geometry.owners.size());
        for (float density : cloud->densities) geometry.owners.push_back(std::bit_cast<uint32_t>(density));
        geometry.clouds.push_back({{}, {}, place});
        set_cloud(geometry, uint32_t(geometry.clouds.size() - 1), *cloud);
    }
    for (const Ground& ground : source.grounds) {
        DrawGround drawn;
        drawn.terrain = ground.terrain;
        if (ground.terrain) {
            drawn.first_vertex = uint32_t(geometry.vertices.size());
            geometry.vertices.resize(geometry.vertices.size() + ground.terrain->vertex_count());
            ground.terrain->write_vertices(std::span(geometry.vertices).subspan(drawn.first_vertex));
            for (const TerrainPatch& patch : ground.terrain->patches())
                drawn.steepest = std::max(drawn.steepest, patch.steepest);
        }
        drawn.first_coarse_vertex = append(ground.coarse.vertices);
        drawn.coarse_levels = ground.coarse.levels;
        geometry.grounds.push_back(drawn);
    }
    geometry.reserved_points = uint32_t(reserved);
    for (uint32_t i = 0; i < source.streamed_clouds; ++i) {
        PartGeometry place{};
        place.first_point = uint32_t(geometry.vertices.size()) + i * k_cloud_points;
        place.first_owner = uint32_t(geometry.owners.size()) + i * k_cloud_points;
        geometry.clouds.push_back({{}, {}, place});
    }
    return geometry;
}

}  // namespace coppice
