// A tree of tiles with clouds and plants that mean nothing but differ everywhere, and a folder for its pack.
#pragma once
#include <array>
#include <cstring>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <vector>
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/tile_pack.h"
#include "plugins/vegetation/plant/pack.h"
#include "runtime/core/random.h"

namespace coppice {

struct MadeTiles {
    Scene scene;
    std::vector<Plant> plants;
    std::vector<std::vector<PackedVertex>> triangles;  // of the plants
    std::vector<TileNode> nodes;
};

inline TileCloud make_cloud(uint32_t point_count, Random& random) {
    TileCloud cloud;
    if (point_count == 0) return cloud;
    copy_name("cloud", cloud.part.name, sizeof cloud.part.name);
    cloud.part.importance = 1.0f;
    cloud.part.coverage_gain.fill(1.0f);
    cloud.part.point_count = point_count;
    cloud.part.area_m2 = random.next_in(1.0f, 2.0f);
    for (int axis = 0; axis < 3; ++axis)
        cloud.part.bounds_min[axis] = -50.0f, cloud.part.bounds_max[axis] = 50.0f;
    for (uint32_t p = 0; p < point_count; ++p) {
        cloud.points.push_back({random.next_in(-50, 50), random.next_in(0, 10), random.next_in(-50, 50),
                                uint32_t(random.next_bits())});
        cloud.densities.push_back(float(p + 1));
    }
    for (int part = 0; part < 3; ++part)
        cloud.exhausted_area_m2[random.next_below(k_density_steps)] = random.next_in(1.0f, 2.0f);
    cloud.exhausted_density = 0.75f * float(point_count);
    return cloud;
}

inline void add_plants(Scene& scene, uint32_t count, Random& random) {
    SceneTile& tile = scene.tiles.emplace_back();
    tile.first_plant = uint32_t(scene.positions.size());
    tile.plant_count = tile.tile.plant_count = count;
    for (uint32_t p = 0; p < count; ++p) {
        scene.positions.push_back({random.next_in(-50, 50), random.next_in(0, 1), random.next_in(-50, 50),
                                   random.next_in(0.5f, 2.0f)});
        scene.turns.push_back(pack_turn_about_y(random.next_in(0.0f, 6.0f)));
        scene.plant_models.push_back(
            {random.next_below(uint32_t(scene.models.size())), uint32_t(random.next_bits())});
    }
}

// A root, its children, and theirs: breadth first, as build_tile_tree has them. Clouds of about `points`, leaves of about
// `plants`; every third leaf has no cloud.
inline MadeTiles make_tile_tree(uint32_t children, uint32_t grandchildren, uint32_t points, uint32_t plants,
                                uint64_t seed = 1) {
    MadeTiles made;
    Random random(seed);
    made.scene.models = {{"oak 0", "plants/oak.plant", 0, 1.0f}, {"fern", "plants/fern.plant", 0, 1.5f}};
    made.triangles = {std::vector<PackedVertex>(3 * 1000), std::vector<PackedVertex>(3 * 7)};
    for (size_t m = 0; m < 2; ++m) {
        made.plants.emplace_back().triangle_vertices = made.triangles[m];
        made.plants.back().content_hash = 100 + m;
    }
    auto add_node = [&] {
        TileNode& node = made.nodes.emplace_back();
        node.origin_world =
            dvec3(double(random.next_in(-1e4f, 1e4f)), 1e7 + double(random.next_below(100)), -3.25);
        node.bounds_tile = {vec3(-60.0f), vec3(random.next_in(50.0f, 60.0f))};
    };
    auto add_children = [&](size_t parent, uint32_t count) {
        made.nodes[parent].first_child = uint32_t(made.nodes.size());
        made.nodes[parent].child_count = count;
        for (uint32_t c = 0; c < count; ++c) add_node();
    };
    add_node();
    if (children) add_children(0, children);
    if (grandchildren)
        for (uint32_t c = 1; c <= children; ++c) add_children(c, grandchildren);
    for (TileNode& node : made.nodes) {
        const bool leaf = node.child_count == 0;
        const bool bare = leaf && made.scene.tiles.size() % 3 == 2;
        node.cloud = make_cloud(bare ? 0 : points + random.next_below(points), random);
        if (!leaf) continue;
        node.tile = uint32_t(made.scene.tiles.size());
        add_plants(made.scene, plants + random.next_below(plants), random);
        node.plant_count = made.scene.tiles.back().plant_count;
    }
    for (size_t n = made.nodes.size(); n-- > 0;)
        for (uint32_t c = 0; c < made.nodes[n].child_count; ++c)
            made.nodes[n].plant_count += made.nodes[made.nodes[n].first_child + c].plant_count;
    return made;
}

// Removed with what is in it.
class ScratchFolder {
  public:
    explicit ScratchFolder(const char* name)
        : folder_(testing::TempDir() + name + std::to_string(::getpid())) {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    std::string path_of(const std::string& name) const { return folder_ + "/" + name; }
    size_t file_count() const {
        return size_t(std::distance(std::filesystem::directory_iterator(folder_), {}));
    }

  private:
    std::string folder_;
};

inline bool same_clouds(const TileCloud& a, const TileCloud& b) {
    return std::memcmp(&a.part, &b.part, sizeof a.part) == 0 && a.points.size() == b.points.size() &&
           (a.points.empty() ||
            std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(PackedVertex)) == 0) &&
           a.densities == b.densities && a.exhausted_area_m2 == b.exhausted_area_m2 &&
           a.exhausted_density == b.exhausted_density;
}

inline TilePack write_and_open(const MadeTiles& made, const std::string& path, uint64_t key = 7) {
    const Status written = write_tile_pack(path, made.nodes, made.scene, made.plants, key);
    EXPECT_TRUE(written) << (written ? "" : to_string(written.error()));
    auto pack = open_tile_pack(path);
    EXPECT_TRUE(pack) << (pack ? "" : to_string(pack.error()));
    return pack ? std::move(*pack) : TilePack{};
}

}  // namespace coppice
