#include "tools/accuracy/substitute_models.h"

#include <algorithm>
#include <utility>
#include "plugins/vegetation/lod/project.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr size_t k_kept_scenes = 5;  // the drawn one and four others

vec3 position_of(const PackedVertex& v) { return {v.x_plant, v.y_plant, v.z_plant}; }

}  // namespace

void add_triangle_part(const PackedPart& like, std::span<const PackedVertex> corners, PlantBlocks& plant) {
    PackedPart part = like;
    part.kind = PackedPartKind::points;
    part.first_triangle = uint32_t(plant.triangle_vertices.size() / 3);
    part.triangle_count = uint32_t(corners.size() / 3);
    part.first_point = uint32_t(plant.points.size());
    part.first_line = uint32_t(plant.line_vertices.size() / 2);
    part.point_count = part.line_count = 0;
    part.line_length_m = part.line_error_m = part.point_radius_m = 0.0f;
    double area_m2 = 0.0;
    float longest_square = 0.0f;
    Box bounds;
    for (size_t i = 0; i + 2 < corners.size(); i += 3) {
        const vec3 a = position_of(corners[i]), b = position_of(corners[i + 1]),
                   c = position_of(corners[i + 2]);
        area_m2 += 0.5 * double(glm::length(glm::cross(b - a, c - a)));
        for (vec3 edge : {b - a, c - b, a - c})
            longest_square = std::max(longest_square, glm::dot(edge, edge));
        for (vec3 p : {a, b, c}) bounds.include(p);
    }
    part.area_m2 = float(area_m2);
    part.longest_edge_m = std::sqrt(longest_square);
    if (bounds.empty()) bounds = {vec3(0.0f), vec3(0.0f)};
    for (int axis = 0; axis < 3; ++axis) {
        part.bounds_min[axis] = bounds.min[axis];
        part.bounds_max[axis] = bounds.max[axis];
    }
    plant.triangle_vertices.insert(plant.triangle_vertices.end(), corners.begin(), corners.end());
    plant.parts.push_back(part);
}

PlantBlocks empty_blocks_like(const Plant& plant) {
    PlantBlocks blocks;
    blocks.name = plant.name;
    blocks.bounds_plant = plant.bounds_plant;
    return blocks;
}

Result<Plant> pack_substitute(const PlantBlocks& blocks) {
    return load_plant_from_memory(std::make_shared<const std::vector<std::byte>>(pack_plant(blocks)),
                                  blocks.name);
}

Result<Plant> triangles_only(const Plant& plant) {
    PlantBlocks blocks = empty_blocks_like(plant);
    for (const PackedPart& part : plant.parts)
        add_triangle_part(
            part,
            plant.triangle_vertices.subspan(3 * size_t(part.first_triangle), 3 * size_t(part.triangle_count)),
            blocks);
    return pack_substitute(blocks);
}

SubstituteScenes::SubstituteScenes(const MethodScene& original, std::vector<SubstituteLadder> ladders) {
    base_.scene = original.scene;
    base_.scene.models.clear();
    for (size_t i = 0; i < ladders.size(); ++i) {
        first_level_.push_back(uint32_t(base_.plants.size()));
        std::vector<float>& grains = grains_m_.emplace_back();
        for (SubstituteLevel& level : ladders[i]) {
            SceneModel model = original.scene.models[i];
            model.name += " level " + std::to_string(grains.size());
            model.importance = 1.0f;
            grains.push_back(level.grain_m);
            base_.scene.models.push_back(std::move(model));
            base_.plants.push_back(std::move(level.plant));
        }
    }
    for (PlantModel& plant : base_.scene.plant_models) plant.model = first_level_[plant.model];
}

SubstituteScenes::Choice SubstituteScenes::choose(const Camera& camera, float focal_px, double grain_px) {
    const Scene& scene = base_.scene;
    std::vector<PlantModel> chosen = scene.plant_models;
    auto level_of = [&](const SceneTile& tile, uint32_t row) {
        const size_t kind =
            size_t(std::upper_bound(first_level_.begin(), first_level_.end(), chosen[row].model) -
                   first_level_.begin()) -
            1;
        const Box& bounds = base_.plants[first_level_[kind]].bounds_plant;
        const PlantPosition& place = scene.positions[row];
        const vec3 middle = vec3(place.x_tile, place.y_tile, place.z_tile) +
                            rotation_matrix(scene.turns[row]) * (bounds.center() * place.scale);
        const float distance_m = glm::length(vec3(tile.tile.origin_world - camera.position_world) + middle);
        const float pixels =
            pixels_per_meter(focal_px, distance_m, 0.5f * glm::length(bounds.size()) * place.scale,
                             camera.near_m, place.scale);
        const std::vector<float>& grains = grains_m_[kind];
        size_t level = grains.size() - 1;
        while (level > 0 && !(double(grains[level]) * double(pixels) <= grain_px)) --level;
        return first_level_[kind] + uint32_t(level);
    };
    parallel_for(scene.tiles.size(), 4, [&](size_t first, size_t last) {
        for (size_t t = first; t < last; ++t) {
            const SceneTile& tile = scene.tiles[t];
            for (uint32_t row = tile.first_plant; row < tile.first_plant + tile.plant_count; ++row)
                chosen[row].model = level_of(tile, row);
        }
    });
    auto same = [](const PlantModel& a, const PlantModel& b) { return a.model == b.model; };
    for (const Made& made : made_)
        if (std::equal(chosen.begin(), chosen.end(), made.scene->scene.plant_models.begin(), same))
            return {made.scene.get(), made.revision};
    auto made = std::make_unique<MethodScene>(base_);
    made->scene.plant_models = std::move(chosen);
    made_.push_back({std::move(made), ++revision_});
    if (made_.size() > k_kept_scenes) made_.pop_front();
    return {made_.back().scene.get(), made_.back().revision};
}

}  // namespace coppice
