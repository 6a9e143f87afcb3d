#include "plugins/vegetation/eco/tile_forest.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <fmt/format.h>
#include "plugins/vegetation/eco/file_chain.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "plugins/vegetation/eco/group_places.h"
#include "plugins/vegetation/eco/mosaic_tree.h"
#include "plugins/vegetation/eco/scene_file.h"

namespace coppice {
namespace {

// Two grounds that share so little of the area of all do not overlap, and so little may lie bare.
constexpr double k_gap_share = 1e-6;

// A row, and the cloud that stands for it, which of a place is its target's.
struct Draft {
    ForestRow row;
    uint32_t cloud = k_no_row;
    dvec3 cloud_origin{0.0};  // in the space of the row
    uint32_t scene =
        k_no_row;  // of a place: the loaded scene whose first row is the target; none: a row of its own scene
};

struct DraftGround {
    ForestGround ground;
    dvec3 low{INFINITY}, high{-INFINITY};  // in the space of the scene
    double area_m2 = 0.0;                  // that a colour counts for

    double area_of_bounds_m2() const { return (high.x - low.x) * (high.z - low.z); }
};

struct LoadedScene {
    std::vector<Draft> rows;  // the first stands for all
    std::optional<DraftGround> ground;
    uint32_t depth = 0;  // the longest chain of mosaics below
};

// The mean of what the coarsest levels show from above; their skirts have the colours of what they border.
vec3 mean_color(const Terrain& terrain) {
    dvec3 sum(0.0);
    double area_m2 = 0.0;
    std::vector<PackedVertex> vertices;
    for (const TerrainPatch& patch : terrain.patches()) {
        if (patch.level_count == 0) continue;
        const TerrainLevel& level = terrain.levels()[patch.first_level + patch.level_count - 1];
        vertices.resize(level.vertex_count);
        terrain.write_level(patch.first_level + patch.level_count - 1, vertices);
        for (size_t v = 0; v + 2 < vertices.size(); v += 3) {
            const PackedVertex &a = vertices[v], &b = vertices[v + 1], &c = vertices[v + 2];
            const double twice_m2 = std::fabs(double(b.x_plant - a.x_plant) * double(c.z_plant - a.z_plant) -
                                              double(c.x_plant - a.x_plant) * double(b.z_plant - a.z_plant));
            for (const PackedVertex* vertex : {&a, &b, &c})
                sum += twice_m2 * dvec3(decode_surface(vertex->surface).color_linear);
            area_m2 += 3.0 * twice_m2;
        }
    }
    return area_m2 > 0.0 ? vec3(sum / area_m2) : vec3(0.0f);
}

}  // namespace

Box bounds_without_skirts(const Terrain& terrain) {
    Box bounds = terrain.bounds_local();
    if (const TerrainLayout layout = terrain.layout(); layout.cells_x > 0) {
        bounds.min.x = layout.corner_local.x;
        bounds.min.z = layout.corner_local.y;
        bounds.max.x = layout.corner_local.x + float(layout.cells_x) * layout.cell_m;
        bounds.max.z = layout.corner_local.y + float(layout.cells_z) * layout.cell_m;
    }
    return bounds;
}

namespace {

DraftGround ground_of(const std::shared_ptr<const Terrain>& terrain) {
    DraftGround ground;
    ground.ground.terrain = terrain;
    ground.ground.without_gaps = true;
    ground.ground.mean_color_linear = mean_color(*terrain);
    const Box bounds = bounds_without_skirts(*terrain);
    ground.low = terrain->origin_world() + dvec3(bounds.min);
    ground.high = terrain->origin_world() + dvec3(bounds.max);
    ground.area_m2 = ground.area_of_bounds_m2();
    return ground;
}

double shared_area_m2(const DraftGround& a, const DraftGround& b) {
    const dvec3 size = glm::min(a.high, b.high) - glm::max(a.low, b.low);
    return size.x > 0.0 && size.z > 0.0 ? size.x * size.z : 0.0;
}

// places: the grounds of a mosaic's places, in its space.
DraftGround union_of(std::span<const DraftGround> places, bool everywhere) {
    DraftGround ground;
    dvec3 color(0.0);
    double bounded_m2 = 0.0, shared_m2 = 0.0;
    for (const DraftGround& place : places) {
        ground.low = glm::min(ground.low, place.low);
        ground.high = glm::max(ground.high, place.high);
        ground.area_m2 += place.area_m2;
        color += place.area_m2 * dvec3(place.ground.mean_color_linear);
        bounded_m2 += place.area_of_bounds_m2();
        everywhere &= place.ground.without_gaps;
        for (const DraftGround& other : places)
            if (&other < &place) shared_m2 += shared_area_m2(place, other);
    }
    if (ground.area_m2 > 0.0) ground.ground.mean_color_linear = vec3(color / ground.area_m2);
    const double area_m2 = ground.area_of_bounds_m2();
    ground.ground.without_gaps = everywhere && std::fabs(bounded_m2 - area_m2) <= k_gap_share * area_m2 &&
                                 shared_m2 <= k_gap_share * area_m2;
    return ground;
}

class ForestMaker {
  public:
    explicit ForestMaker(const TerrainInterface* terrain) : terrain_(terrain) {}

    Result<TileForest> make(const PopulatedScene& root) {
        COPPICE_CHECK(add(root));
        COPPICE_CHECK(lay_out(root.scene.path));
        forest_.name = root.scene.name;
        forest_.path = root.scene.path;
        forest_.light = root.scene.light;
        forest_.camera_path = root.scene.camera_path;
        forest_.sample_distance_px = root.scene.sample_distance_px;
        return std::move(forest_);
    }

  private:
    // Scenes stand in scenes_ behind all that stand in them.
    Result<uint32_t> add(const PopulatedScene& populated) {
        chain_.enter(populated.scene.path);
        LoadedScene scene;
        COPPICE_CHECK(populated.mosaic.empty() ? add_packs(populated, scene) : add_places(populated, scene));
        chain_.leave();
        scenes_.push_back(std::move(scene));
        known_[file_key(populated.scene.path)] = {uint32_t(scenes_.size() - 1), populated.content_hash};
        return uint32_t(scenes_.size() - 1);
    }

    Result<uint32_t> find_or_load(const PlacedScene& placed) {
        const std::string place = placed.place + ".scene";
        COPPICE_CHECK(chain_.check_is_new(placed.path, place));
        auto check_content = [&](uint64_t content_hash) -> Status {
            if (content_hash == placed.content_hash) return {};
            return fail(ErrorId::file_corrupt, placed.path, "", "not the scene its mosaic was populated with",
                        "populate the mosaic again");
        };
        if (auto found = known_.find(file_key(placed.path)); found != known_.end()) {
            COPPICE_CHECK(check_content(found->second.content_hash));
            return found->second.scene;
        }
        COPPICE_CHECK(chain_.check_depth(placed.path, place, 0));
        COPPICE_TRY(const PopulatedScene populated, load_populated_scene(placed.path, terrain_));
        COPPICE_CHECK(check_content(populated.content_hash));
        return add(populated);
    }

    // Which of the forest's models are these: those of a scene before, or new ones.
    Result<uint32_t> add_models(const PopulatedScene& populated) {
        const std::vector<SceneModel>& models = populated.scene.models;
        for (size_t first = 0; first + models.size() <= forest_.models.size(); ++first) {
            size_t same = 0;
            while (same < models.size() &&
                   forest_.model_content_hashes[first + same] == populated.model_content_hashes[same] &&
                   forest_.models[first + same].importance == models[same].importance &&
                   forest_.models[first + same].color_variation == models[same].color_variation)
                ++same;
            if (same == models.size()) return uint32_t(first);
        }
        const size_t first = forest_.models.size();
        forest_.models.insert(forest_.models.end(), models.begin(), models.end());
        forest_.model_content_hashes.insert(forest_.model_content_hashes.end(),
                                            populated.model_content_hashes.begin(),
                                            populated.model_content_hashes.end());
        if (forest_.models.size() > k_model_limit)
            return fail(ErrorId::limit_exceeded, populated.scene.path, "plants",
                        fmt::format("{} models with those of the scenes before", forest_.models.size()),
                        fmt::format("at most {} in all", k_model_limit));
        return uint32_t(first);
    }

    uint32_t keep(TileCloud cloud) {
        forest_.clouds.push_back(std::move(cloud));
        return uint32_t(forest_.clouds.size() - 1);
    }

    Status add_packs(const PopulatedScene& populated, LoadedScene& scene) {
        if (populated.scene.terrain) scene.ground = ground_of(populated.scene.terrain);
        COPPICE_TRY(std::vector<TilePack> packs, open_packs(populated));
        std::erase_if(packs, [](const TilePack& pack) { return pack.nodes.empty(); });
        if (packs.empty()) {
            if (scene.ground) scene.rows.push_back(bare_row(*scene.ground));
            return {};
        }
        COPPICE_TRY(const uint32_t first_model, add_models(populated));
        std::vector<dvec3> roots;
        for (const TilePack& pack : packs) {
            const double* origin = pack.nodes[0].origin_world;
            roots.push_back(dvec3(origin[0], origin[1], origin[2]));
        }
        // One pack's root is the scene's; the roots of many stand in places below the rows that join them, because a
        // parent's children follow each other.
        const Groups groups = group_places(roots);
        const size_t join_count = packs.size() > 1 ? groups.nodes.size() : 0;
        scene.rows.resize(join_count);
        std::vector<uint32_t> root_rows;
        for (TilePack& pack : packs) {
            root_rows.push_back(uint32_t(scene.rows.size()));
            COPPICE_CHECK(add_pack_rows(pack, scene.rows));
            forest_.packs.push_back(std::move(pack));
            forest_.first_model.push_back(first_model);
        }
        for (size_t n = join_count; n-- > 0;) {
            const GroupNode& group = groups.nodes[n];
            if (group.child_count == 0) {
                scene.rows[n] = place_of(scene.rows[root_rows[group.place]], dvec3(0.0));
                scene.rows[n].row.target = root_rows[group.place];
            } else {
                scene.rows[n].row.first_child = group.first_child;
                scene.rows[n].row.child_count = group.child_count;
                COPPICE_CHECK(join_children(populated, scene.rows, n));
            }
        }
        return {};
    }

    Status add_pack_rows(const TilePack& pack, std::vector<Draft>& rows) {
        const uint32_t first = uint32_t(rows.size());
        for (uint32_t n = 0; n < pack.nodes.size(); ++n) {
            const PackedTileNode& node = pack.nodes[n];
            ForestRow& row = rows.emplace_back().row;
            row.origin = dvec3(node.origin_world[0], node.origin_world[1], node.origin_world[2]);
            row.bounds_tile = {vec3(node.bounds_min[0], node.bounds_min[1], node.bounds_min[2]),
                               vec3(node.bounds_max[0], node.bounds_max[1], node.bounds_max[2])};
            row.first_child = node.child_count ? first + node.first_child : 0;
            row.child_count = node.child_count;
            row.pack = uint32_t(forest_.packs.size());
            row.node = n;
            row.finest_density = node.finest_density;
            row.plant_count = node.plant_count;
            row.triangle_count = node.triangle_count;
        }
        COPPICE_TRY(TileCloud cloud, read_cloud(pack, 0));
        Draft& root = rows[first];
        root.cloud = root.row.cloud = keep(std::move(cloud));
        root.cloud_origin = root.row.origin;
        return {};
    }

    Draft bare_row(const DraftGround& ground) {
        const dvec3 corners[] = {ground.low, ground.high};
        const Box points[] = {{vec3(0.0f), vec3(0.0f)}, {vec3(0.0f), vec3(0.0f)}};
        const JoinedSpace space = join_spaces(corners, points);
        Draft draft;
        draft.row.origin = draft.cloud_origin = space.origin;
        draft.row.bounds_tile = space.bounds;
        draft.row.finest_density = std::numeric_limits<float>::max();
        draft.cloud = draft.row.cloud = keep(TileCloud{});
        return draft;
    }

    // Its bounds are those of the target, in the target's space.
    static Draft place_of(const Draft& target, dvec3 origin) {
        const vec3 low(target.row.origin + dvec3(target.row.bounds_tile.min)),
            high(target.row.origin + dvec3(target.row.bounds_tile.max));
        Draft draft;
        draft.row.origin = origin;
        // A float's rounding must not let a plant stick out.
        draft.row.bounds_tile = {low - glm::abs(low) * 0x1p-22f, high + glm::abs(high) * 0x1p-22f};
        draft.row.finest_density = target.row.finest_density;
        draft.row.plant_count = target.row.plant_count;
        draft.row.triangle_count = target.row.triangle_count;
        draft.cloud = target.cloud;
        draft.cloud_origin = origin + target.cloud_origin;
        return draft;
    }

    // Fills a row from its children, all of which have clouds.
    Status join_children(const PopulatedScene& populated, std::vector<Draft>& rows, size_t parent) {
        Draft& draft = rows[parent];
        const auto children = std::span(rows).subspan(draft.row.first_child, draft.row.child_count);
        std::vector<dvec3> origins;
        std::vector<Box> bounds;
        bool countable = true;
        for (const Draft& child : children) {
            origins.push_back(child.row.origin);
            bounds.push_back(child.row.bounds_tile);
            countable &= add_product(draft.row.plant_count, 1, child.row.plant_count) &&
                         add_product(draft.row.triangle_count, 1, child.row.triangle_count);
        }
        if (!countable)
            return fail(ErrorId::limit_exceeded, populated.scene.path, "",
                        "more than 2^64 triangles or plants", "fewer places");
        const JoinedSpace space = join_spaces(origins, bounds);
        draft.row.origin = draft.cloud_origin = space.origin;
        draft.row.bounds_tile = space.bounds;
        const vec3 reach = glm::max(glm::abs(space.bounds.min), glm::abs(space.bounds.max));
        const dvec3 farthest = glm::abs(space.origin) + dvec3(reach);
        if (!(std::max({farthest.x, farthest.y, farthest.z}) <= k_origin_reach_m))
            return fail(ErrorId::value_out_of_range, populated.scene.path, "",
                        fmt::format("reaches {:.3g} m from the origin",
                                    std::max({farthest.x, farthest.y, farthest.z})),
                        fmt::format("at most {:g} m: nearer, or fewer", k_origin_reach_m));

        std::vector<const TileCloud*> clouds;
        std::vector<vec3> offsets_m;
        bool all_shown = true;
        for (const Draft& child : children) {
            clouds.push_back(&forest_.clouds[child.cloud]);
            offsets_m.push_back(vec3(child.cloud_origin - space.origin));
            // Packs keep nothing of a cloud without points, so it counts for nothing in what they are merged to.
            all_shown &= child.row.plant_count == 0 || !clouds.back()->points.empty();
        }
        TileCloud cloud = merge_clouds(clouds, offsets_m);
        draft.row.finest_density = draft.row.plant_count == 0 ? std::numeric_limits<float>::max()
                                   : all_shown                ? cloud.finest_density()
                                                              : 0.0f;
        draft.cloud = draft.row.cloud = keep(std::move(cloud));
        return {};
    }

    Status add_places(const PopulatedScene& populated, LoadedScene& scene) {
        std::vector<DraftGround> grounds;
        scene.rows.emplace_back();
        size_t place_count = 0;
        for (const PlacedScene& placed : populated.mosaic) {
            COPPICE_TRY(const uint32_t index, find_or_load(placed));
            const LoadedScene& below = scenes_[index];
            COPPICE_CHECK(chain_.check_depth(placed.path, placed.place + ".scene", below.depth));
            scene.depth = std::max(scene.depth, below.depth + 1);
            for (uint64_t copy = 0; copy < placed.copy_count(); ++copy) {
                const dvec3 at = placed.origin_of(copy);
                ++place_count;
                if (below.ground) {
                    grounds.push_back(*below.ground);
                    grounds.back().low += at;
                    grounds.back().high += at;
                }
                if (below.rows.empty()) continue;
                scene.rows.push_back(place_of(below.rows[0], at));
                scene.rows.back().scene = index;
            }
        }
        if (!grounds.empty()) scene.ground = union_of(grounds, grounds.size() == place_count);
        if (scene.rows.size() == 1) {
            scene.rows.clear();  // nothing stands anywhere
            return {};
        }
        scene.rows[0].row.first_child = 1;
        scene.rows[0].row.child_count = uint32_t(scene.rows.size() - 1);
        return join_children(populated, scene.rows, 0);
    }

    // The root first, and each scene before those that stand in it.
    Status lay_out(const std::string& path) {
        std::vector<size_t> first_row(scenes_.size());
        size_t row_count = 0;
        for (size_t s = scenes_.size(); s-- > 0;) {
            first_row[s] = row_count;
            row_count += scenes_[s].rows.size();
        }
        if (row_count >= k_no_row)
            return fail(ErrorId::limit_exceeded, path, "", fmt::format("{} tiles", row_count),
                        "fewer different scenes");
        forest_.rows.reserve(row_count);
        for (size_t s = scenes_.size(); s-- > 0;) {
            const uint32_t first = uint32_t(first_row[s]);
            if (scenes_[s].ground) {
                DraftGround& ground = *scenes_[s].ground;
                ground.ground.bounds = {vec3(ground.low), vec3(ground.high)};
                if (!scenes_[s].rows.empty())
                    scenes_[s].rows[0].row.ground = uint32_t(forest_.grounds.size());
                forest_.grounds.push_back(std::move(ground.ground));
            }
            for (Draft& draft : scenes_[s].rows) {
                ForestRow& row = forest_.rows.emplace_back(draft.row);
                if (row.child_count) row.first_child += first;
                if (draft.scene != k_no_row)
                    row.target = uint32_t(first_row[draft.scene]);
                else if (row.target != k_no_row)
                    row.target += first;
            }
            scenes_[s].rows = {};
        }
        return {};
    }

    struct Known {
        uint32_t scene;
        uint64_t content_hash;
    };

    const TerrainInterface* terrain_;
    TileForest forest_;
    std::vector<LoadedScene> scenes_;
    FileChain chain_;
    std::map<std::string, Known> known_;
};

double distance_m(const Box& bounds, double x, double z) {
    const double away_x = std::max({double(bounds.min.x) - x, x - double(bounds.max.x), 0.0});
    const double away_z = std::max({double(bounds.min.z) - z, z - double(bounds.max.z), 0.0});
    return std::sqrt(away_x * away_x + away_z * away_z);
}

}  // namespace

Result<TileForest> make_forest(const PopulatedScene& root, const TerrainInterface* terrain) {
    return ForestMaker(terrain).make(root);
}

Result<TileForest> load_forest(const std::string& path, const TerrainInterface* terrain) {
    COPPICE_TRY(const PopulatedScene root, load_populated_scene(path, terrain));
    return make_forest(root, terrain);
}

Result<std::vector<Plant>> load_plants(const TileForest& forest) {
    std::vector<Plant> plants;
    for (size_t m = 0; m < forest.models.size(); ++m) {
        const std::string& file = forest.models[m].source_path;
        COPPICE_TRY(Plant plant, load_plant(file));
        if (plant.content_hash != forest.model_content_hashes[m])
            return fail(ErrorId::file_corrupt, file, "", "not the plant that the scene was populated with",
                        "populate the scene again");
        plants.push_back(std::move(plant));
    }
    return plants;
}

double ground_height(const TileForest& forest, double x_world, double z_world) {
    if (forest.rows.empty() || forest.rows[0].ground == k_no_row) return 0.0;
    const ForestRow* row = &forest.rows[0];
    dvec3 at(x_world, 0.0, z_world);
    for (;;) {
        const ForestGround& ground = forest.grounds[row->ground];
        if (ground.terrain) return ground_height(ground.terrain.get(), at.x, at.z) - at.y;
        const ForestRow* nearest = nullptr;
        double nearest_m = INFINITY;
        for (uint32_t c = row->first_child; c < row->first_child + row->child_count; ++c) {
            const ForestRow& place = forest.rows[c];
            const uint32_t below = forest.rows[place.target].ground;
            if (below == k_no_row) continue;
            const double away_m =
                distance_m(forest.grounds[below].bounds, at.x - place.origin.x, at.z - place.origin.z);
            if (nearest && away_m >= nearest_m) continue;
            nearest = &place;
            nearest_m = away_m;
        }
        at -= nearest->origin;
        row = &forest.rows[nearest->target];
    }
}

}  // namespace coppice
