// Nested maps of the sun (a clipmap) around the viewer, each of texels twice as large as the one before, that stay what they are
// until the viewer or the sun has moved on: made once, from casters as fine as the map's texels, and looked up in every frame.
// Distance decides which map a place is looked up in, so texels are as large as the picture's pixels times k_texel_px at most.
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

inline constexpr uint32_t k_most_shadow_maps = 12;

// What the frame is like.
struct ClipmapFrame {
    dvec3 camera_world;
    dvec3 origin_world;     // moves with all there is: texels are counted from there
    vec3 motion_m;          // where the viewer will be soon, from where it is
    vec3 to_sun;            // unit
    float focal_px;
    float nearest_m, far_m;  // receivers lie between, about
    Box bounds_camera;       // all that there is
    uint32_t side_texels;    // of each map
    uint32_t map_count;
};

class Clipmap {
  public:
    // Of maps for a picture with that focal length, a multiple of 64.
    static uint32_t side_for(float focal_px);
    // As many as it takes to reach so far, at most k_most_shadow_maps.
    static uint32_t count_for(uint32_t side_texels, float far_m);
    static float texel_m(uint32_t map) { return k_first_texel_m * float(1u << map); }
    // How far from the viewer a map is looked up at most.
    static float reach_m(uint32_t map, uint32_t side_texels);

    // Finds which maps are due: those without which places would have none, and one that will be. Until commit() what was made
    // before holds, so it may be asked again.
    void update(const ClipmapFrame& frame);
    std::span<const uint32_t> due() const { return {due_.data(), due_count_}; }
    // The maps that are due have been drawn; incomplete[i]: due()[i] lacked what is still to be read.
    void commit(std::span<const bool> incomplete);
    // Nothing is as it was: all are due.
    void forget() { levels_ = {}; }
    // More has been read, or what is there has changed: maps that were incomplete, or all, are due, one by one.
    void note_arrivals();
    void note_changes();

    // Of the maps that are due as they will be, of others as they were made; relative to camera_world.
    ShadowView view(uint32_t map, dvec3 camera_world) const;
    // What throws shadows into a map that is due: the column of the map, without an end towards the sun, looked at as from
    // least_distance_m at least.
    Frustum casters(uint32_t map, const Frustum& view, dvec3 camera_world, float least_distance_m) const;
    // Maps [first, last] can be looked up: those that the frame needs.
    uint32_t first() const { return first_; }
    uint32_t last() const { return last_; }

  private:
    static constexpr float k_first_texel_m = 0.01f;
    struct Level {
        bool made = false, incomplete = false, outdated = false;
        uint32_t made_at = 0;  // of commit_count_
        dvec3 to_sun{0.0}, across{0.0}, along{0.0};
        glm::dvec2 center{0.0};          // of the map, on the plane at right angles to the sun, m from origin_world
        dvec3 origin_world{0.0};
        double low_m = 0.0, high_m = 0.0;  // towards the sun, likewise; depths 0 and 1/2
        uint32_t side_texels = 0, map_count = 0;
    };
    Level level_for(const ClipmapFrame& frame, uint32_t map) const;
    bool is_due(uint32_t map) const;
    // 1 and more: places lack this map. 0: as good as new.
    float staleness(const Level& level, const ClipmapFrame& frame, uint32_t map) const;

    std::array<Level, k_most_shadow_maps> levels_{}, next_{};
    std::array<uint32_t, k_most_shadow_maps> due_{};
    size_t due_count_ = 0;
    uint32_t commit_count_ = 0;
    uint32_t first_ = 0, last_ = 0;
};

}  // namespace coppice
