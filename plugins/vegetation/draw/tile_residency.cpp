#include "plugins/vegetation/draw/tile_residency.h"

#include <algorithm>
#include <bit>
#include "runtime/core/log.h"

namespace coppice {
namespace {

constexpr uint64_t k_cloud_bytes = k_cloud_points * (sizeof(PackedVertex) + sizeof(uint32_t));

std::span<const uint32_t> bits_of(const std::vector<float>& densities) {
    static_assert(sizeof(float) == sizeof(uint32_t));
    return {reinterpret_cast<const uint32_t*>(densities.data()), densities.size()};
}

}  // namespace

uint32_t TileResidency::cloud_count(const ResidencySettings& settings) {
    return uint32_t(std::clamp<uint64_t>(settings.gpu_bytes / k_cloud_bytes, 1, 1u << 17));
}

TileResidency::TileResidency(TileForest& forest, const ResidencySettings& settings, uint32_t pinned_clouds)
    : streamer_(std::move(forest.packs), {settings.host_bytes, 1}),
      rows_(forest.rows.size()),
      first_model_(forest.first_model),
      places_(cloud_count(settings)),
      pinned_clouds_(pinned_clouds) {
    for (const TilePack& pack : streamer_.packs()) {
        first_node_.push_back(uint32_t(row_of_node_.size()));
        row_of_node_.resize(row_of_node_.size() + pack.nodes.size(), k_none);
    }
    for (uint32_t r = 0; r < rows_.size(); ++r) {
        const ForestRow& row = forest.rows[r];
        if (row.pack == k_no_row) continue;
        rows_[r].pack = row.pack;
        rows_[r].node = row.node;
        rows_[r].cloud_is_pinned = row.cloud != k_no_row;
        row_of_node_[first_node_[row.pack] + row.node] = r;
    }
    for (uint32_t p = uint32_t(places_.size()); p-- > 0;) free_places_.push_back(p);
}

void TileResidency::set_cloud_of(World& world, ChunkId tiles, uint32_t row, uint32_t cloud) {
    world.get<TileLevels>(world.chunk(tiles).entity(row))->cloud = cloud;
}

// A free one, or that whose cloud has not been wished for for longest.
uint32_t TileResidency::find_place(World& world, ChunkId tiles) {
    if (free_places_.empty()) {
        uint32_t oldest = k_none;
        for (uint32_t p = 0; p < places_.size(); ++p) {
            const uint32_t wished_at = rows_[places_[p].row].cloud_wished_at;
            if (wished_at != turn_ && places_[p].filled_at != updates_ &&
                (oldest == k_none || wished_at < rows_[places_[oldest].row].cloud_wished_at))
                oldest = p;
        }
        if (oldest == k_none) return k_none;
        const Row& row = rows_[places_[oldest].row];
        drop(world, tiles, {row.pack, row.node, TileBlockKind::cloud});
    }
    const uint32_t place = free_places_.back();
    free_places_.pop_back();
    return place;
}

// False: it has to wait for the next frame.
bool TileResidency::add_cloud(World& world, ChunkId tiles, SceneGeometry& geometry, Rasteriser& rasteriser,
                              uint32_t slot, bool at_once, const FinishedTileBlock& block, uint32_t row) {
    if (block.cloud.points.size() > k_cloud_points) {
        log_warning("{}: a cloud of {} points; {} are drawn at most",
                    streamer_.packs()[block.block.pack].path, block.cloud.points.size(), k_cloud_points);
        return true;  // held, but never drawn
    }
    const uint32_t place = find_place(world, tiles);
    if (place == k_none) {
        streamer_.release(block.block);
        return true;
    }
    const uint32_t cloud = pinned_clouds_ + place;
    const PartGeometry& at = geometry.clouds[cloud].geometry;
    const std::span<const uint32_t> owners = bits_of(block.cloud.densities);
    if (at_once) {
        if (auto done = rasteriser.upload_points(at.first_point, block.cloud.points, at.first_owner, owners);
            !done) {
            log_warning("{}", to_string(done.error()));
            free_places_.push_back(place);
            streamer_.release(block.block);
            return true;
        }
    } else if (!rasteriser.stream_points(slot, at.first_point, block.cloud.points, at.first_owner, owners)) {
        free_places_.push_back(place);
        return false;
    }
    set_cloud(geometry, cloud, block.cloud);
    places_[place] = {row, updates_};
    rows_[row].place = place;
    set_cloud_of(world, tiles, row, cloud);
    return true;
}

void TileResidency::add_plants(World& world, ChunkId tiles, const FinishedTileBlock& block, uint32_t row) {
    const TilePlants& plants = block.plants;
    if (plants.positions.empty()) return;
    auto [chunk, positions, turns, models] = world.create_chunk<PlantPosition, PlantTurn, PlantModel>(
        uint32_t(plants.positions.size()), world.chunk(tiles).entity(row));
    if (!chunk) return;
    std::copy(plants.positions.begin(), plants.positions.end(), positions.begin());
    std::copy(plants.turns.begin(), plants.turns.end(), turns.begin());
    const uint32_t first_model = first_model_[block.block.pack];
    for (size_t i = 0; i < models.size(); ++i)
        models[i] = {plants.models[i].model + first_model, plants.models[i].seed};
    rows_[row].plants = chunk;
    ++plant_tiles_;
}

void TileResidency::drop(World& world, ChunkId tiles, TileBlockName block) {
    const uint32_t row = row_of(block);
    if (block.kind == TileBlockKind::plants) {
        if (rows_[row].plants) {
            world.destroy_chunk(rows_[row].plants);
            --plant_tiles_;
        }
        rows_[row].plants = {};
    } else if (rows_[row].place != k_none) {
        set_cloud_of(world, tiles, row, k_none);
        places_[rows_[row].place].row = k_none;
        free_places_.push_back(rows_[row].place);
        rows_[row].place = k_none;
    }
    streamer_.release(block);
}

void TileResidency::drop_plants(World& world) {
    for (Row& row : rows_) {
        if (row.plants) world.destroy_chunk(row.plants);
        row.plants = {};
    }
    plant_tiles_ = 0;
}

bool TileResidency::update(World& world, ChunkId tiles, SceneGeometry& geometry, Rasteriser& rasteriser,
                           uint32_t slot, bool at_once) {
    ++updates_;
    streamer_.take_finished(finished_);
    for (FinishedTileBlock& block : finished_)
        if (block.status)
            arrived_.push_back(std::move(block));
        else
            log_warning("{}; the tile above stands in for it", to_string(block.status.error()));
    finished_.clear();

    size_t done = 0;
    for (; done < arrived_.size(); ++done) {
        const FinishedTileBlock& block = arrived_[done];
        const uint32_t row = row_of(block.block);
        if (block.block.kind == TileBlockKind::plants)
            add_plants(world, tiles, block, row);
        else if (!add_cloud(world, tiles, geometry, rasteriser, slot, at_once, block, row))
            break;
    }
    arrived_.erase(arrived_.begin(), arrived_.begin() + ptrdiff_t(done));

    streamer_.suggest_evictions(evictions_);
    size_t missed = 0;
    for (const TileBlockName& block : evictions_) {
        // What has arrived but has not been put anywhere yet stays for the frame that does.
        const bool waits = std::any_of(arrived_.begin(), arrived_.end(),
                                       [&](const FinishedTileBlock& other) { return other.block == block; });
        if (waits) continue;
        const Row& row = rows_[row_of(block)];
        missed += turn_ == (block.kind == TileBlockKind::cloud ? row.cloud_wished_at : row.plants_wished_at);
        drop(world, tiles, block);
    }
    return done + missed > 0;
}

void TileResidency::wish(std::span<const TileWish> wishes) {
    ++turn_;
    requests_.clear();
    uint32_t cloud_count = 0;
    for (const TileWish& wish : wishes) {
        Row& row = rows_[wish.row];
        if (row.pack == k_none) continue;
        if (wish.kind == TileBlockKind::cloud) {
            if (row.cloud_is_pinned) continue;
            cloud_count += row.cloud_wished_at != turn_;
            row.cloud_wished_at = turn_;
        } else {
            row.plants_wished_at = turn_;
        }
        requests_.push_back({{row.pack, row.node, wish.kind}, wish.priority});
    }
    // More clouds than there are places would push each other out, so the least urgent are not asked for.
    if (cloud_count > places_.size()) {
        std::sort(requests_.begin(), requests_.end(), [](const TileRequest& a, const TileRequest& b) {
            return std::tuple(a.block.kind, -a.priority, a.block.pack, a.block.node) <
                   std::tuple(b.block.kind, -b.priority, b.block.pack, b.block.node);
        });
        ++turn_;
        for (const TileRequest& request : requests_)
            if (request.block.kind == TileBlockKind::plants)
                rows_[row_of(request.block)].plants_wished_at = turn_;
        cloud_count = 0;
        std::erase_if(requests_, [&](const TileRequest& request) {
            if (request.block.kind != TileBlockKind::cloud) return false;
            Row& row = rows_[row_of(request.block)];
            if (row.cloud_wished_at == turn_) return true;
            if (cloud_count == places_.size()) return true;
            ++cloud_count;
            row.cloud_wished_at = turn_;
            return false;
        });
    }
    streamer_.wanted(requests_);
}

ResidencyStatistics TileResidency::statistics() const {
    return {streamer_.statistics(), uint32_t(places_.size() - free_places_.size()), plant_tiles_};
}

}  // namespace coppice
