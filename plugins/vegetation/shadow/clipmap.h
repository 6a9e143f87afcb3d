// Nested maps of the sun (a clipmap) around the viewer, each of texels twice as large as the one before, that stay what they are
// until the viewer or the sun has moved on: made once, from casters as fine as the map's texels, and looked up in every frame.
// Distance decides which map a place is looked up in, so texels are as large as the picture's pixels times k_texel_px at most,
// of a leaf before the lens and of a range of hills alike.
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

// Maps there are, of texels of 0.6 um to 1.3 km, and how many of them are kept at a time: neighbours, each in a place of its own.
inline constexpr uint32_t k_shadow_map_count = 32, k_shadow_map_places = 12;

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
};

class Clipmap {
  public:
    // Of maps for a picture with that focal length, a multiple of 64; fewer where all places in most_bytes, 4 a texel, have no more.
    static uint32_t side_for(float focal_px, uint64_t most_bytes);
    static uint32_t most_side(uint64_t most_bytes);
    static float texel_m(uint32_t map);
    // Where it is kept.
    static uint32_t place_of(uint32_t map) { return map % k_shadow_map_places; }
    // How far from the viewer a map is looked up at most.
    static float reach_m(uint32_t map, uint32_t side_texels);

    // Finds which maps are due: those without which places would have none, and one that will be. Until commit() what was made
    // before holds, so it may be asked again.
    void update(const ClipmapFrame& frame);
    std::span<const uint32_t> due() const { return {due_.data(), due_count_}; }
    // How much of a map there was.
    enum class Drawn : uint8_t { whole, lacking_tiles, cut };
    // The first of the maps that are due have been drawn: without tiles that are still to be read, or without what found no room
    // in the lists. The others stay due.
    void commit(std::span<const Drawn> drawn);
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
    struct Level {
        uint32_t map = k_shadow_map_count;  // none
        bool incomplete = false, outdated = false;
        uint32_t made_at = 0;  // of commit_count_
        dvec3 to_sun{0.0}, across{0.0}, along{0.0};
        glm::dvec2 center{0.0};          // of the map, on the plane at right angles to the sun, m from origin_world
        dvec3 origin_world{0.0};
        double low_m = 0.0, high_m = 0.0;  // towards the sun, likewise; depths 0 and 1/2
        uint32_t side_texels = 0;
    };
    Level level_for(const ClipmapFrame& frame, uint32_t map) const;
    bool is_due(uint32_t map) const;
    // 1 and more: places lack this map. 0: as good as new.
    float staleness(const ClipmapFrame& frame, uint32_t map) const;
    const Level& level(uint32_t map) const { return (is_due(map) ? next_ : levels_)[place_of(map)]; }

    std::array<Level, k_shadow_map_places> levels_{}, next_{};
    std::array<uint32_t, k_shadow_map_places> due_{};
    size_t due_count_ = 0;
    uint32_t commit_count_ = 0;
    uint32_t first_ = 0, last_ = 0;
};

}  // namespace coppice
