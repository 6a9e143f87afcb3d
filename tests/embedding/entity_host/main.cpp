// A host with entities of its own that wants no pictures: which plant stands where, and at which level of detail each would
// be drawn from where the host looks. No Vulkan is linked or loaded.
//     entity_host SCENE     prints, by distance, how many plants there are and what is drawn of them
#include <cstdio>
#include <map>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/eco/part_chance.h"
#include "plugins/vegetation/load_planted_scene.h"
#include "plugins/vegetation/lod/choose_part.h"

// The host's entities: columns of its own, filled once.
struct Entities {
    std::vector<coppice::dvec3> place_world;
    std::vector<coppice::mat3> turn;
    std::vector<float> scale;
    std::vector<uint32_t> kind, seed;
};

struct Level {
    uint32_t triangles = 0, lines = 0, points = 0, leaves = 0;
};

Entities take_plants(const coppice::Scene& scene) {
    Entities entities;
    for (const coppice::SceneTile& tile : scene.tiles)
        for (uint32_t i = tile.first_plant; i < tile.first_plant + tile.plant_count; ++i) {
            const coppice::PlantPosition& at = scene.positions[i];
            entities.place_world.push_back(tile.tile.origin_world +
                                           coppice::dvec3(at.x_tile, at.y_tile, at.z_tile));
            entities.turn.push_back(coppice::rotation_matrix(scene.turns[i]));
            entities.scale.push_back(at.scale);
            entities.kind.push_back(scene.plant_models[i].model);
            entities.seed.push_back(scene.plant_models[i].seed);
        }
    return entities;
}

// What of the plant is drawn, and how far away it is.
Level level_of(const Entities& entities, size_t i, const coppice::Plant& plant, const coppice::Camera& camera,
               const coppice::Frustum& view, const coppice::FrameSettings& settings, float& distance_m) {
    const coppice::vec3 middle = plant.bounds_plant.center() * entities.scale[i];
    const coppice::vec3 center =
        coppice::vec3(entities.place_world[i] - camera.position_world) + entities.turn[i] * middle;
    const float radius_m = 0.5f * glm::length(plant.bounds_plant.size()) * entities.scale[i];
    distance_m = glm::length(center);
    coppice::PlantView seen;
    seen.direction_plant = coppice::normalize_or(center, {0.0f, 0.0f, -1.0f}) * entities.turn[i];
    seen.pixels_per_meter =
        coppice::pixels_per_meter(view.focal_px, distance_m, radius_m, view.near_m, entities.scale[i]) *
        coppice::off_axis_stretch(view, center, distance_m);
    Level level;
    for (uint32_t part = 0; part < plant.parts.size(); ++part) {
        const float chance = coppice::part_chance(entities.seed[i], part);
        const coppice::PartChoice choice = coppice::choose_part(plant.parts[part], seen, settings, chance);
        level.triangles += choice.triangles;
        level.lines += choice.lines;
        level.points += choice.points - choice.skipped_points;
        level.leaves += choice.leaves;
    }
    return level;
}

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    coppice::Registry registry;
    auto planted = coppice::load_planted_scene(argv[1], registry);
    if (!planted) {
        std::fprintf(stderr, "%s\n", to_string(planted.error()).c_str());
        return coppice::exit_code_of(planted.error().id);
    }
    const Entities entities = take_plants(planted->scene);
    const coppice::Camera camera = planted->scene.camera_path.front().camera;
    const coppice::Frustum view = coppice::make_frustum(camera, 1280, 720);
    coppice::FrameSettings settings;
    settings.sample_distance_px = planted->scene.sample_distance_px;

    struct Ring {
        uint32_t plants = 0;
        Level drawn;
    };
    std::map<int, Ring> rings;  // by the power of two of the distance in m
    for (size_t i = 0; i < entities.seed.size(); ++i) {
        float distance_m;
        const Level level =
            level_of(entities, i, planted->plants[entities.kind[i]], camera, view, settings, distance_m);
        Ring& ring = rings[distance_m > 1.0f ? std::ilogb(distance_m) : 0];
        ++ring.plants;
        ring.drawn.triangles += level.triangles;
        ring.drawn.lines += level.lines;
        ring.drawn.points += level.points;
        ring.drawn.leaves += level.leaves;
    }
    std::printf("plants %zu models %zu\nfrom_m plants triangles leaves lines points\n", entities.seed.size(),
                planted->plants.size());
    for (const auto& [power, ring] : rings)
        std::printf("%d %u %u %u %u %u\n", 1 << power, ring.plants, ring.drawn.triangles, ring.drawn.leaves,
                    ring.drawn.lines, ring.drawn.points);
}
