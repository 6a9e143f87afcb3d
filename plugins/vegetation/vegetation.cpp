// READ FIRST. Registers the components, systems and passes, in order of execution:
//
//   stream  stream_tiles    draw/     what was read of a world larger than memory is put where it is drawn from
//   cull    list_tiles      cull/     tiles in view, nearest first, down to those whose clouds suffice, and what is missing;
//                                     draw/ sees their plants
//   lod     expand_plants   lod/      the budget's d'; which primitives of each plant's parts and of clouds; draw/ writes
//                                     them down, in parallel; and of what throws shadows (draw/frame_casters.h), into a map that
//                                     shadow/ fits
//   draw    write_work_list draw/     the jobs' lists, one behind the other, into the mapped buffers
//   report  count           report/   what was drawn
//   passes  stream in, where there is a sun the same into the shadow map, clear, triangles, big triangles, leaves, lines, points ..., resolve: draw/rasteriser.cpp
#include "plugins/vegetation/vegetation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include "plugins/vegetation/cull/list_grounds.h"
#include "plugins/vegetation/cull/list_tiles.h"
#include "plugins/vegetation/draw/expand_ground.h"
#include "plugins/vegetation/draw/frame_casters.h"
#include "plugins/vegetation/draw/frame_plants.h"
#include "plugins/vegetation/draw/rasteriser.h"
#include "plugins/vegetation/draw/tile_residency.h"
#include "plugins/vegetation/lod/learn_cost.h"
#include "plugins/vegetation/lod/rest.h"
#include "plugins/vegetation/report/explain_frame.h"
#include "runtime/core/log.h"

namespace coppice {
namespace {

double now_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

PrimitiveCounts counts_of(const FrameReport& report) {
    return {report.triangles, report.lines, report.points, report.leaves};
}

class VegetationSystems final : public Vegetation {
  public:
    explicit VegetationSystems(const VegetationSettings& settings)
        : settings_(settings), slot_counts_(std::max(settings.frame_slots, 1u)) {}
    ~VegetationSystems() override { drop_scene(); }

    Status start() {
        COPPICE_TRY(rasteriser_,
                    Rasteriser::create(*settings_.device, *settings_.frame_graph, settings_.frame_slots,
                                       settings_.width, settings_.height));
        Schedule& schedule = *settings_.schedule;
        schedule.add(Phase::stream, 0, "stream_tiles", [this](World& world) { stream_tiles(world); });
        schedule.add(Phase::cull, 0, "list_tiles",
                     [this](TileList::Tiles tiles, TileList::Plants plants) { list_tiles(tiles, plants); });
        // The runs point into the plants' columns, and another d' asks for other tiles: so this reads them too.
        schedule.add(Phase::lod, 0, "expand_plants",
                     [this](TileList::Tiles tiles, TileList::Plants plants) { expand(tiles, plants); });
        schedule.add(Phase::draw, 0, "write_work_list", [this](TileList::Plants) { write_work_list(); });
        schedule.add(Phase::report, 0, "count", [this](TileList::Plants) { count(); });
        return {};
    }

    Status set_scene(const Scene& scene, std::vector<Plant> plants) override {
        COPPICE_CHECK(check_scene(scene, plants.size()));
        const std::vector<TileNode> tree = build_tile_tree(scene, plants);
        std::vector<Ground> grounds = make_grounds(scene.terrain);
        GeometrySource source{scene.path, scene.models, plants, {}, 0, grounds};
        for (const TileNode& tile : tree) source.clouds.push_back(&tile.cloud);
        COPPICE_TRY(SceneGeometry geometry, gather_geometry(source));
        COPPICE_TRY(Rows rows, make_rows(scene, tree, geometry.models));
        COPPICE_CHECK(show(std::move(geometry), std::move(rows), std::move(grounds), scene.light));
        models_ = scene.models;
        return {};
    }

    Status set_world(TileForest forest, std::vector<Plant> plants,
                     const ResidencySettings& settings) override {
        if (plants.size() != forest.models.size())
            return fail(ErrorId::value_out_of_range, forest.path, "plants",
                        std::to_string(plants.size()) + " packed plants",
                        "one for each of the world's models");
        std::vector<Ground> grounds = make_grounds(forest);
        GeometrySource source{forest.path, forest.models, plants, {}, 0, grounds};
        for (const TileCloud& cloud : forest.clouds) source.clouds.push_back(&cloud);
        source.streamed_clouds = forest.packs.empty() ? 0 : TileResidency::cloud_count(settings);
        COPPICE_TRY(SceneGeometry geometry, gather_geometry(source));
        COPPICE_TRY(Rows rows, make_rows(forest));
        COPPICE_CHECK(show(std::move(geometry), std::move(rows), std::move(grounds), forest.light));
        models_ = forest.models;
        if (!forest.packs.empty())
            residency_ = std::make_unique<TileResidency>(forest, settings, uint32_t(forest.clouds.size()));
        return {};
    }

    Status set_loose_tile(uint64_t name, const LooseTile& loose) override {
        const size_t count = loose.positions.size();
        auto wrong = [name](ErrorId id, std::string fault, std::string remedy) {
            return fail(id, "", "loose tile " + std::to_string(name), std::move(fault), std::move(remedy));
        };
        if (loose.turns.size() != count || loose.models.size() != count)
            return wrong(ErrorId::value_out_of_range, "arrays of different length",
                         "one position, turn and model a plant");
        for (const PlantModel& model : loose.models)
            if (model.model >= geometry_.models.size())
                return wrong(ErrorId::value_out_of_range, "model " + std::to_string(model.model),
                             "the scene has " + std::to_string(geometry_.models.size()) + " models");
        auto found = loose_rows_.find(name);
        if (found == loose_rows_.end()) {
            if (count == 0) return {};
            if (rows_.free_loose_rows.empty())
                return wrong(ErrorId::limit_exceeded, "no room for another",
                             "VegetationSettings::loose_tiles says how many there may be");
            found = loose_rows_.emplace(name, LooseRow{rows_.free_loose_rows.back(), {}}).first;
            rows_.free_loose_rows.pop_back();
        }
        LooseRow& row = found->second;
        World& world = *settings_.world;
        ChunkId chunk{};
        if (count > 0) {
            auto [made, positions, turns, models] = world.create_chunk<PlantPosition, PlantTurn, PlantModel>(
                uint32_t(count), world.chunk(rows_.chunks.front()).entity(row.row));
            if (!made)
                return wrong(ErrorId::limit_exceeded, "no room for its plants", "fewer plants a tile");
            std::copy(loose.positions.begin(), loose.positions.end(), positions.begin());
            std::copy(loose.turns.begin(), loose.turns.end(), turns.begin());
            std::copy(loose.models.begin(), loose.models.end(), models.begin());
            chunk = made;
        }
        if (row.chunk) world.destroy_chunk(row.chunk);
        row.chunk = chunk;
        set_loose_row(row.row, loose);
        if (count == 0) {
            rows_.free_loose_rows.push_back(row.row);
            loose_rows_.erase(found);
        }
        casters_.note_changes();
        moved_ = true;
        return {};
    }

    Status resize(uint32_t width, uint32_t height) override {
        moved_ = true;
        host_picture_.reset();
        refused_map_bytes_ = UINT64_MAX;  // a smaller picture leaves more
        return rasteriser_->resize(width, height);
    }
    Status set_host_picture(const HostPicture& picture) override {
        const bool same = host_picture_ && *host_picture_ == picture;
        if (same) return {};
        host_picture_.reset();
        moved_ = true;
        if (!picture.color) return {};
        COPPICE_CHECK(rasteriser_->make_host_picture(picture));
        host_picture_ = picture;
        return {};
    }
    void set_camera(const Camera& camera) override {
        const dvec3& p = camera.position_world;
        // A host's camera that is not a number must not reach a sort or a pixel: the one before stays.
        if (std::isfinite(p.x + p.y + p.z) && std::isfinite(camera.yaw_rad + camera.pitch_rad) &&
            std::isfinite(camera.roll_rad) && camera.vertical_fov_rad > 0.0f && camera.near_m > 0.0f &&
            std::isfinite(camera.near_m))
            camera_ = camera;
    }
    void set_light(const Light& light) override { light_ = light; }
    void set_settings(const FrameSettings& settings) override { frame_ = settings; }
    void set_slot(uint32_t slot) override {
        slot_ = slot;
        rasteriser_->begin_slot(slot);
    }
    void set_frame_ms(uint32_t slot, double ms) override {
        if (slot < slot_counts_.size() && std::exchange(slot_counts_[slot].drawn, false))
            cost_.learn(slot_counts_[slot].counts, ms);
    }
    const gpu::Buffer& color() const override { return rasteriser_->color(); }
    ResourceIndex color_resource() const override { return rasteriser_->color_resource(); }
    const gpu::Buffer& visibility() const override { return rasteriser_->visibility(); }
    const FrameReport& report() const override { return report_; }
    FrameExplanation explain_frame() const override {
        if (!counted_) return {};
        return coppice::explain_frame(
            {tile_list_, frame_plants_, geometry_, frustum_, drawn_, frame_, resting_.index, models_}, report_);
    }

  private:
    Status check_scene(const Scene& scene, size_t plant_count) const {
        auto wrong = [&scene](std::string fault, std::string remedy) {
            return fail(ErrorId::value_out_of_range, scene.path, "plants", std::move(fault),
                        std::move(remedy));
        };
        if (plant_count != scene.models.size())
            return wrong(std::to_string(plant_count) + " packed plants",
                         "one for each of the scene's models");
        size_t placed = scene.positions.size();
        if (scene.turns.size() != placed || scene.plant_models.size() != placed)
            return wrong("arrays of different length", "one position, turn and model a plant");
        for (const SceneTile& tile : scene.tiles)
            if (tile.first_plant > placed || tile.plant_count > placed - tile.first_plant)
                return wrong("a tile of plants that do not exist", "ranges inside the arrays");
        for (const PlantModel& model : scene.plant_models)
            if (model.model >= plant_count)
                return wrong("model " + std::to_string(model.model),
                             "the scene has " + std::to_string(plant_count) + " models");
        return {};
    }

    // The tiles of a scene in the world; nobody looks at them before they are shown.
    struct Rows {
        std::vector<ChunkId> chunks;  // of the tiles, and of each leaf's plants that is not streamed
        std::vector<uint32_t> free_loose_rows;
        uint64_t triangle_count = 0;
    };

    // In place of what was shown before, which stays on an error.
    Status show(SceneGeometry geometry, Rows rows, std::vector<Ground> grounds, const Light& light) {
        if (auto uploaded =
                rasteriser_->set_geometry({geometry.vertices, geometry.owners, geometry.reserved_points, geometry.has_tints});
            !uploaded) {
            drop_rows(rows);
            return uploaded;
        }
        drop_scene();
        geometry.vertices = {};
        geometry.owners = {};
        geometry_ = std::move(geometry);
        rows_ = std::move(rows);
        grounds_ = std::move(grounds);
        for (Ground& ground : grounds_) ground.coarse.vertices = {};
        refused_entries_ = UINT32_MAX;
        refused_map_bytes_ = UINT64_MAX;
        light_ = light;
        return {};
    }

    void drop_rows(Rows& rows) {
        for (const ChunkId& chunk : rows.chunks) settings_.world->destroy_chunk(chunk);
        rows = {};
    }
    tl::unexpected<Error> no_room(Rows& rows, const std::string& path) {
        drop_rows(rows);
        return fail(ErrorId::limit_exceeded, path, "tiles", "no room for another tile", "place fewer plants");
    }

    // All in one chunk; plants follow when they are needed.
    Result<Rows> make_rows(const TileForest& forest) {
        Rows made;
        if (forest.rows.empty()) return made;
        auto [tile_chunk, tiles, levels] =
            settings_.world->create_chunk<Tile, TileLevels>(uint32_t(forest.rows.size()));
        if (!tile_chunk) return no_room(made, forest.path);
        made.chunks.push_back(tile_chunk);
        for (size_t r = 0; r < forest.rows.size(); ++r) {
            const ForestRow& row = forest.rows[r];
            tiles[r] = {row.origin, row.bounds_tile, row.plant_count};
            levels[r] = {row.cloud,         row.first_child,    row.child_count,
                         row.target,        row.finest_density, row.pack != k_no_row ? 1u : 0u,
                         row.triangle_count};
        }
        made.triangle_count = levels[0].triangle_count;
        return made;
    }

    // All tiles in one chunk; each leaf owns the chunk of its plants. Where there may be loose tiles, row 0 holds the place
    // where the scene stands, and them; the scene's rows follow.
    Result<Rows> make_rows(const Scene& scene, std::span<const TileNode> tree,
                           std::span<const DrawModel> models) {
        Rows made;
        const uint32_t loose_count = std::min(settings_.loose_tiles, k_loose_tile_limit);
        const uint32_t first_row = loose_count > 0 ? 2 + loose_count : 0;
        if (tree.empty() && first_row == 0) return made;
        auto [tile_chunk, tiles, levels] =
            settings_.world->create_chunk<Tile, TileLevels>(first_row + uint32_t(tree.size()));
        if (!tile_chunk) return no_room(made, scene.path);
        made.chunks.push_back(tile_chunk);
        for (size_t n = tree.size(); n-- > 0;) {  // children before their parents
            const TileNode& node = tree[n];
            const size_t row = first_row + n;
            tiles[row] = {node.origin_world, node.bounds_tile, node.plant_count};
            levels[row] = {uint32_t(n),
                           first_row + node.first_child,
                           node.child_count,
                           TileLevels::k_none,
                           node.cloud.finest_density(),
                           0,
                           0};
            for (uint32_t child = 0; child < node.child_count; ++child)
                levels[row].triangle_count +=
                    levels[first_row + node.first_child + child].triangle_count;
            if (node.child_count > 0) continue;
            const SceneTile& source = scene.tiles[node.tile];
            auto [chunk, positions, turns, plant_models] =
                settings_.world->create_chunk<PlantPosition, PlantTurn, PlantModel>(
                    source.plant_count, settings_.world->chunk(tile_chunk).entity(uint32_t(row)));
            if (!chunk) return no_room(made, scene.path);
            made.chunks.push_back(chunk);
            for (uint32_t i = 0; i < source.plant_count; ++i) {
                size_t plant = source.first_plant + i;
                positions[i] = scene.positions[plant];
                turns[i] = scene.turns[plant];
                plant_models[i] = scene.plant_models[plant];
                levels[row].triangle_count += models[plant_models[i].model].triangle_count;
            }
        }
        if (loose_count > 0) {
            tiles[1] = k_empty_tile;
            levels[1] = {};
            if (!tree.empty()) levels[1].target = first_row;
            for (uint32_t row = 1 + loose_count; row >= 2; --row) {
                tiles[row] = k_empty_tile;
                levels[row] = {};
                made.free_loose_rows.push_back(row);  // the lowest goes first
            }
            set_outer_row(tiles, levels, {});
        }
        made.triangle_count = levels[0].triangle_count;
        return made;
    }

    void set_loose_row(uint32_t row, const LooseTile& loose) {
        World& world = *settings_.world;
        const std::span<Tile> tiles = world.column<Tile>(rows_.chunks.front());
        const std::span<TileLevels> levels = world.column<TileLevels>(rows_.chunks.front());
        tiles[row] = loose.positions.empty() ? k_empty_tile : loose.tile;
        tiles[row].plant_count = loose.positions.size();
        levels[row].triangle_count = 0;
        for (const PlantModel& model : loose.models)
            levels[row].triangle_count += geometry_.models[model.model].triangle_count;
        set_outer_row(tiles, levels, loose_rows_);
        rows_.triangle_count = levels[0].triangle_count;
    }

    struct LooseRow {
        uint32_t row;
        ChunkId chunk;
    };
    using LooseRows = std::map<uint64_t, LooseRow>;  // by the host's names

    // What row 0 holds: the scene and all loose tiles, those in use in front.
    static void set_outer_row(std::span<Tile> tiles, std::span<TileLevels> levels, const LooseRows& loose_rows) {
        uint32_t row_end = 2;
        for (const auto& [name, loose] : loose_rows) row_end = std::max(row_end, loose.row + 1);
        Tile& outer = tiles[0];
        const uint32_t scene_row = levels[1].target;
        const bool has_scene = scene_row != TileLevels::k_none;
        outer = k_empty_tile;
        levels[0] = {};
        if (has_scene) {
            outer = tiles[scene_row];
            levels[0].triangle_count = levels[scene_row].triangle_count;
        }
        for (uint32_t row = 2; row < row_end; ++row) {
            const Tile& tile = tiles[row];
            if (tile.plant_count == 0) continue;
            if (outer.plant_count == 0) outer = {tile.origin_world, {}, 0};
            const vec3 from_outer = vec3(tile.origin_world - outer.origin_world);
            outer.bounds_tile.include(
                Box{tile.bounds_tile.min + from_outer, tile.bounds_tile.max + from_outer});
            outer.plant_count += tile.plant_count;
            levels[0].triangle_count += levels[row].triangle_count;
        }
        levels[0].first_child = 1;
        levels[0].child_count = outer.plant_count > 0 ? row_end - 1 : 0;
    }

    void drop_scene() {
        if (residency_) residency_->drop_plants(*settings_.world);
        for (const auto& [name, row] : loose_rows_) settings_.world->destroy_chunk(row.chunk);
        loose_rows_.clear();
        drop_rows(rows_);
        residency_.reset();
        geometry_ = {};
        grounds_.clear();
        report_ = {};
        counted_ = false;
        casters_.forget();
        moved_ = is_new_ = true;
    }

    // How long nothing has moved, and what follows for this frame.
    void begin_frame() {
        const bool rests = !std::exchange(moved_, false) && camera_ == last_camera_ &&
                           light_ == last_light_ && frame_ == last_frame_;
        last_camera_ = camera_;
        last_light_ = light_;
        last_frame_ = frame_;
        // While maps that stay are made again, one by one, it waits.
        const uint32_t step = std::exchange(made_maps_, false) ? 0 : 1;
        rested_ = rests && keep_ ? std::min(rested_ + step, frame_.accumulate_limit) : 0;
        keep_ = frame_.accumulate_limit > 0 && !host_picture_;
        if (keep_)
            if (auto room = rasteriser_->keep_radiance(); !room) {
                if (!std::exchange(keep_refused_, true)) log_warning("{}", to_string(room.error()));
                keep_ = false;
            }
        if (!keep_) rested_ = 0;
        ++averaged_;
        if (std::exchange(changed_, false)) {
            // The mean begins again, but d' stays as fine as it is by now, and with it what is wished for.
            rested_ = std::min({rested_, k_frames_to_finest, std::max(frame_.accumulate_limit, 1u) - 1});
            averaged_ = 0;
        }
        if (rested_ == 0) averaged_ = 0;
        settled_ = keep_ && rested_ >= frame_.accumulate_limit;
        report_.rested_frames = rested_;
        // At rest d' falls from what the moving view's budget left it.
        FrameSettings rested_from = frame_;
        if (rested_ > 0)
            rested_from.sample_distance_px = std::max(frame_.sample_distance_px, last_solved_px_);
        resting_ = resting_frame(rested_, rested_from);
        resting_.new_share = mean_share(averaged_);
        drawn_ = frame_;
        drawn_.sample_distance_px = resting_.sample_distance_px;
        budget_ = find_budget();
        if (budget_ > 0) drawn_.sample_distance_px = last_solved_px_;
    }

    // Of the frame; 0: none.
    uint64_t find_budget() const {
        const bool by_time = frame_.time_budget_ms > 0.0f;
        if (!frame_.level_of_detail || rested_ > 0 || (frame_.vertex_budget == 0 && !by_time)) return 0;
        uint64_t budget = frame_.vertex_budget > 0 ? frame_.vertex_budget : UINT64_MAX;
        if (by_time)
            budget =
                std::min(budget, cost_.vertex_budget_for(double(frame_.time_budget_ms), counts_of(report_)));
        return std::max<uint64_t>(budget, 1);
    }

    // Where the viewer will be: as far on as it came in the slower of the last two frames, so that a cut is no motion.
    void predict_motion() {
        const dvec3 step_m =
            std::exchange(is_new_, false) ? dvec3(0.0) : camera_.position_world - last_camera_.position_world;
        const dvec3 slower_m = glm::length(step_m) < glm::length(last_step_m_) ? step_m : last_step_m_;
        motion_m_ = vec3(slower_m) * k_frames_ahead;
        last_step_m_ = step_m;
    }

    void stream_tiles(World& world) {
        const double begin = now_ms();
        predict_motion();
        frustum_ = make_frustum(camera_, rasteriser_->width(), rasteriser_->height());
        see_grounds();
        const bool waits = residency_ && frame_.wait_for_tiles && settings_.device->submits();
        if (residency_ && residency_->update(world, rows_.chunks.front(), geometry_, *rasteriser_, slot_, waits))
            note_arrivals(!waits);  // frames that waited lack nothing
        begin_frame();
        if (waits && !settled_) wait_for_tiles(world);
        report_.stream_ms = now_ms() - begin;
    }

    // And what the one that the viewer is above hides.
    void see_grounds() {
        const float error_px = ground_error_px(frame_);
        ground_list_.list(grounds_, frustum_, camera_.position_world, error_px);
        const Terrain* below = nullptr;
        dvec3 camera_space(0.0);
        for (const GroundInView& at : ground_list_.in_view()) {
            const Box& bounds = grounds_[at.ground].bounds;
            const vec3 viewer = vec3(-at.space_camera);
            if (at.coarse_level != k_in_full || viewer.x < bounds.min.x || viewer.x > bounds.max.x ||
                viewer.z < bounds.min.z || viewer.z > bounds.max.z)
                continue;
            below = grounds_[at.ground].terrain.get();
            camera_space = -at.space_camera;
            break;
        }
        above_ground_m_ = INFINITY;
        if (below) {
            const dvec3 local = camera_space - below->origin_world();
            above_ground_m_ = std::fabs(float(local.y) - below->height_at(float(local.x), float(local.z)));
        }
        horizon_.build(frame_.occlusion ? below : nullptr, camera_space, frustum_, error_px);
    }

    // What arrives shows what else is needed: once for each level of the hierarchy.
    void wait_for_tiles(World& world) {
        const TileList::Tiles tiles(world);
        const TileList::Plants plants(world);
        for (int round = 0; round < k_most_rounds; ++round) {
            list(tiles, plants, drawn_.sample_distance_px);
            if (budget_ > 0) solve(tiles, plants);
            list_casters(tiles, plants);
            wish();
            residency_->wait();
            if (!residency_->update(world, rows_.chunks.front(), geometry_, *rasteriser_, slot_, true)) return;
        }
    }

    void list_tiles(const TileList::Tiles& tiles, const TileList::Plants& plants) {
        double begin = now_ms();
        if (settled_) return;
        list(tiles, plants, drawn_.sample_distance_px);
        report_.cull_ms = now_ms() - begin;
    }

    // For d' and what is a little coarser.
    void list(const TileList::Tiles& tiles, const TileList::Plants& plants, float sample_distance_px) {
        listed_px_ = sample_distance_px;
        FrameSettings coarsest = drawn_;
        coarsest.sample_distance_px *= k_list_reach;
        coarsest.line_sample_distance_px *= k_list_reach;
        spread_for_px_ = coarsest.sample_distance_px;
        const Horizon* horizon = horizon_.empty() ? nullptr : &horizon_;
        const float spread_px =
            widest_spread_px(geometry_.least_importance, geometry_.most_line_width, coarsest);
        FrameSettings points_of_1px = drawn_;
        points_of_1px.level_of_detail = true;  // clouds stand in for missing triangles too
        points_of_1px.sample_distance_px = 1.0f;
        points_of_1px.line_sample_distance_px = 1e-3f;
        const float stand_in_spread =
            residency_
                ? std::sqrt(drawn_.splat_factor) *
                      widest_spread_px(geometry_.least_importance, geometry_.most_line_width, points_of_1px)
                : 0.0f;
        tile_list_.list(tiles, plants, frustum_, camera_.position_world,
                        {drawn_.level_of_detail ? sample_distance_px / std::sqrt(drawn_.splat_factor) : 0.0f,
                         motion_m_, horizon, spread_px, stand_in_spread});
        frame_plants_.see(tile_list_, geometry_, frustum_, horizon, spread_px);
    }

    // Which tiles are clouds and what plants' gains are depends on d' itself, so it is looked for until it is what it was
    // found with. Where a tile hands over, the count jumps, and there may be no such d': after a second try tiles are only
    // listed for finer ones, since plants can be drawn as coarsely as their cloud, but no cloud finer than it is.
    float solve(const TileList::Tiles& tiles, const TileList::Plants& plants) {
        int passes = 0;
        double vertices = 0.0;
        auto settle = [&] {
            drawn_.sample_distance_px = settle_sample_distance(drawn_.sample_distance_px, [&](float at_px) {
                drawn_.sample_distance_px = at_px;
                if (at_px < listed_px_ || (++passes <= 2 && at_px > listed_px_)) list(tiles, plants, at_px);
                const BudgetHistogram& measured =
                    frame_plants_.measure(tile_list_, geometry_, frustum_, drawn_);
                const float found_px = solve_sample_distance(measured, 0, budget_, frame_.sample_distance_px,
                                                             frame_.most_sample_distance_px);
                vertices = vertices_at(measured, found_px);
                return found_px;
            });
        };
        settle();
        const float solved_px = drawn_.sample_distance_px;
        constexpr double k_tolerance = 0.006;  // of the budget: solve_sample_distance's and rounding
        if (vertices < (1.0 - k_tolerance) * double(budget_) && solved_px > frame_.sample_distance_px) {
            drawn_.line_sample_distance_px = solved_px;
            settle();
        }
        // What is hidden was found for splats of a size.
        if (drawn_.sample_distance_px > spread_for_px_ || drawn_.line_sample_distance_px > spread_for_px_)
            list(tiles, plants, listed_px_);
        return solved_px;
    }

    // After what is seen has been found, and its d'.
    void list_casters(const TileList::Tiles& tiles, const TileList::Plants& plants) {
        const uint64_t pixel_count = uint64_t(rasteriser_->width()) * rasteriser_->height();
        casters_.list(tiles, plants, geometry_, grounds_,
                      {frustum_, camera_.position_world, tile_list_.origin_world(), motion_m_, pixel_count, scene_bounds(),
                       std::min(frame_plants_.nearest_m(tile_list_), above_ground_m_),
                       settings_.device->limits.storage_range_bytes, refused_map_bytes_},
                      light_, drawn_);
    }

    void wish() {
        wishes_.assign(tile_list_.wishes().begin(), tile_list_.wishes().end());
        casters_.add_wishes(wishes_);
        residency_->wish(wishes_);
    }

    void note_arrivals(bool changed) {
        changed_ = changed_ || changed;
        casters_.note_arrivals();
    }

    void expand(const TileList::Tiles& tiles, const TileList::Plants& plants) {
        if (settled_) return;
        double begin = now_ms();
        if (rested_ == 0) last_solved_px_ = budget_ > 0 ? solve(tiles, plants) : frame_.sample_distance_px;
        list_casters(tiles, plants);
        casters_.see(geometry_);
        const size_t run_count = tile_list_.runs().size();
        // The first part is the terrain's: should memory run out, the ground stays. The clouds' is behind the runs', and behind
        // that the casters' are, which go first.
        work_.begin(run_count + 2, casters_.part_counts());
        frame_plants_.draw(tile_list_, geometry_, frustum_, drawn_, resting_.index, work_, 1);
        report_.terrain_triangles = ground_expander_.expand(ground_list_.in_view(), geometry_, frustum_,
                                                            ground_error_px(drawn_), work_.part(0));
        casters_.draw(geometry_, resting_.index, work_, run_count + 2);
        if (residency_) wish();
        report_.lod_ms = now_ms() - begin;
    }

    // All that there is, relative to the camera.
    Box scene_bounds() const {
        Box bounds = tile_list_.bounds_camera();
        if (!grounds_.empty()) {
            const vec3 space = vec3(-camera_.position_world);
            bounds.include(grounds_[0].bounds.min + space);
            bounds.include(grounds_[0].bounds.max + space);
        }
        return bounds;
    }

    void write_work_list() {
        if (settled_) return rasteriser_->skip_frame();
        double begin = now_ms();
        WorkList::Size size = work_.size();
        bool fits = size.instances <= rasteriser_->instances(slot_).size() &&
                    size.entries <= rasteriser_->entries(slot_).size();
        if (!fits && size.entries < refused_entries_) {
            // Half as much again, so that a slowly growing list does not stop every frame. Where there is no memory for
            // it, what fits is drawn, the rest counted as dropped, and so much is not asked for again.
            if (auto grown = rasteriser_->grow(slot_, size.instances + size.instances / 2,
                                               size.entries + size.entries / 2);
                !grown) {
                refused_entries_ = size.entries;
                log_warning("{}", to_string(grown.error()));
            }
            if (size.instances > rasteriser_->instances(slot_).size() ||
                size.entries > rasteriser_->entries(slot_).size())
                refused_entries_ = std::min(refused_entries_, size.entries);
        }
        if (auto maps = rasteriser_->make_shadow_maps(casters_.side_texels(),
                                                      casters_.any() ? casters_.map_count() : 0);
            !maps) {
            refused_map_bytes_ = casters_.map_bytes();
            log_warning("{}", to_string(maps.error()));
            casters_.drop();
        }
        layout_ = work_.gather(rasteriser_->instances(slot_), rasteriser_->entries(slot_));
        rasteriser_->set_frame(
            slot_, layout_, camera_, light_,
            {drawn_.view, resting_.shift_px, keep_ ? resting_.new_share : 0.0f, resting_.filter_radius_px,
             host_picture_ ? &*host_picture_ : nullptr},
            casters_.maps());
        made_maps_ = casters_.changed_kept_maps();
        changed_ = changed_ || made_maps_;
        casters_.commit(layout_.whole_maps);
        if (rasteriser_->dropped_shadows()) casters_.forget();
        report_.write_ms = now_ms() - begin;
    }

    void count() {
        if (settled_) return;
        counted_ = true;
        report_.tiles = tile_list_.tile_count;
        report_.tiles_touched = tile_list_.touched_tile_count;
        report_.tiles_expanded = tile_list_.expanded_tile_count;
        report_.tiles_missing = tile_list_.stand_in_count;
        report_.clouds = uint32_t(tile_list_.clouds().size());
        report_.plants = tile_list_.plant_count;
        report_.tiles_hidden = tile_list_.hidden_tile_count;
        report_.cloud_plants = 0;
        report_.plants_expanded = 0;
        for (const PlantRun& run : tile_list_.runs())
            report_.plants_expanded += uint32_t(run.positions.size());
        frame_plants_.count(report_.plants_visible, report_.plants_hidden, report_.full_triangles);
        for (const CloudTile& tile : tile_list_.clouds()) {
            report_.cloud_plants += tile.plant_count;
            report_.full_triangles += tile.triangle_count;
        }
        const size_t part_count = tile_list_.runs().size() + 2;
        const PrimitiveCounts seen = work_.count(1, part_count);
        report_.triangles = seen.triangles;
        report_.lines = seen.lines;
        report_.points = seen.points;
        report_.leaves = seen.leaves;
        const PrimitiveCounts casters = work_.count(part_count, work_.part_count());
        report_.shadow_maps = casters_.drawn_map_count();
        report_.shadow_side_texels = casters_.side_texels();
        report_.shadow_plants = casters_.plant_count();
        report_.shadow_triangles = casters.triangles;
        report_.shadow_lines = casters.lines;
        report_.shadow_points = casters.points;
        report_.shadow_leaves = casters.leaves;
        report_.vertices = report_.points + 2 * report_.lines + 3 * report_.triangles + 4 * report_.leaves;
        slot_counts_[slot_] = {counts_of(report_), true};
        report_.sample_distance_px = drawn_.sample_distance_px;
        report_.vertex_budget = budget_;
        report_.scene_triangles = rows_.triangle_count;
        report_.work_entries = layout_.entry_count;
        report_.dropped_entries = layout_.dropped_entries;
        report_.dropped_triangles = rasteriser_->dropped_triangles();
        report_.gpu_bytes = rasteriser_->gpu_bytes();
        if (!residency_) return;
        const ResidencyStatistics streamed = residency_->statistics();
        report_.streamed_clouds = streamed.clouds;
        report_.streamed_plant_tiles = streamed.plant_tiles;
        report_.stream_bytes_read = streamed.stream.bytes_read;
        report_.stream_resident_bytes = streamed.stream.resident_bytes;
        report_.stream_errors = streamed.stream.errors;
    }

    VegetationSettings settings_;
    std::unique_ptr<Rasteriser> rasteriser_;
    SceneGeometry geometry_;
    std::vector<SceneModel> models_;  // of geometry_, for explain_frame
    std::vector<Ground> grounds_;
    Rows rows_;
    static constexpr Tile k_empty_tile{dvec3(0.0), {vec3(0.0f), vec3(0.0f)}, 0};
    LooseRows loose_rows_;
    std::unique_ptr<TileResidency> residency_;

    std::optional<HostPicture> host_picture_;
    Camera camera_;
    Light light_;
    FrameSettings frame_;
    uint32_t slot_ = 0;

    // A view at rest (lod/rest.h).
    Camera last_camera_;
    Light last_light_;
    FrameSettings last_frame_;
    uint32_t rested_ = 0;
    bool moved_ = true;   // what is drawn changed in another way
    bool is_new_ = true;  // the scene: nobody has been anywhere in it
    bool keep_ = false, keep_refused_ = false;
    uint32_t averaged_ = 0;       // frames that the mean is of, before this one
    bool made_maps_ = false;      // that stay, in the last frame
    bool changed_ = false;        // those, or tiles of a streamed world: the mean is of what was before
    bool settled_ = false;        // the picture shows the mean of all frames there will be
    RestingFrame resting_;
    FrameSettings drawn_;  // frame_, with the d' of the resting view

    static constexpr float k_frames_ahead = 30.0f;
    static constexpr int k_most_rounds = 64;
    dvec3 last_step_m_{0.0};
    vec3 motion_m_{0.0f};
    Frustum frustum_{};
    Horizon horizon_;
    float above_ground_m_ = INFINITY;  // the viewer; infinite where there is none below
    TileList tile_list_;
    GroundList ground_list_;
    GroundExpander ground_expander_;
    FramePlants frame_plants_;
    FrameCasters casters_;
    std::vector<TileWish> wishes_;
    uint64_t refused_map_bytes_ = UINT64_MAX;  // so much found no room
    static constexpr float k_list_reach = 1.25f;
    float listed_px_ = 0.0f,
          spread_for_px_ = 0.0f;   // d' that the tiles were listed for, and the largest for what is hidden
    uint64_t budget_ = 0;          // vertices; 0: none
    float last_solved_px_ = 1.0f;  // d' of the last frame in which the view moved
    LearnedCost cost_;
    struct SlotCounts {
        PrimitiveCounts counts;
        bool drawn = false;  // and not learned yet
    };
    std::vector<SlotCounts> slot_counts_;
    WorkList work_;
    WorkList::Layout layout_;
    uint32_t refused_entries_ = UINT32_MAX;  // a list this long found no memory
    FrameReport report_;
    bool counted_ = false;  // of a frame of this scene
};

}  // namespace

Result<std::unique_ptr<Vegetation>> create_vegetation(const VegetationSettings& settings) {
    auto systems = std::make_unique<VegetationSystems>(settings);
    COPPICE_CHECK(systems->start());
    return std::unique_ptr<Vegetation>(std::move(systems));
}

}  // namespace coppice
