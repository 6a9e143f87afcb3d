// The frame's work list: what the kernels draw, written by the CPU straight into mapped buffers (DESIGN section 4).
// Jobs fill lists of their own; gather() lays them out one behind the other, so the result does not depend on the
// number of threads.
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/lod/choose_part.h"
#include "plugins/vegetation/lod/learn_cost.h"

namespace coppice {

// One dispatch each. Points by the pixels a splat can touch along one axis; blend: of any size, leaving out points
// whose triangle is drawn, and of clouds those beyond the density their place asks for; each may have a size of its own.
enum class WorkKind : uint8_t { triangles, lines, points_1, points_2, points_any, points_blend, leaves };
inline constexpr size_t k_work_kinds = 7;

// 32 bytes, two texels; raster.glsl reads it.
struct WorkEntry {
    uint32_t first_vertex;  // in the geometry buffer
    uint32_t count;         // primitives
    uint32_t instance;      // its highest bit: k_ground_bit
    uint32_t first_owner;   // points_blend only; of clouds the points' densities
    float size_px;          // splat side or line width; of casters in metres of the plant, but of points that carry a density
    uint32_t
        owner_min;  // points_blend; of those that carry a density PartChoice::height_gain, of lines the bits of its turned_share;
              // of leaves the level
    uint32_t
        cull_back;  // triangles: 1: those that turn their back are left out; points: bits of density_limit_m2;
                         // leaves: where the part's LeafGrid is
    float mean_facing;  // PartChoice's
};
static_assert(sizeof(WorkEntry) == 32);

inline constexpr uint32_t k_ground_bit = 1u << 31;  // not a plant

// 32 bytes, two texels: how a plant stands, relative to the camera; raster.glsl makes a matrix of it.
struct WorkInstance {
    float x_camera = 0.0f, y_camera = 0.0f, z_camera = 0.0f;  // m, its foot
    float scale = 1.0f;
    float turn_x = 0.0f, turn_y = 0.0f, turn_z = 0.0f, turn_w = 1.0f;  // quaternion
};
static_assert(sizeof(WorkInstance) == 32);
// In scenes of which some plants have tints (eco/vary_color.h), in the last six bits of the quaternion's parts, where they move
// nothing that could be seen.
inline void set_tint(WorkInstance& instance, uint32_t tint) {
    for (float* part : {&instance.turn_x, &instance.turn_y, &instance.turn_z, &instance.turn_w}) {
        // Not in a nought, which would become a denormal number: CPUs calculate slowly with these.
        constexpr uint32_t k_next_to_nothing = 0x30000000u;  // 2^-31
        const uint32_t bits = *part == 0.0f ? k_next_to_nothing : std::bit_cast<uint32_t>(*part) & ~63u;
        *part = std::bit_cast<float>(bits | (tint & 63u));
        tint >>= 6;
    }
}
// Neither turned nor scaled.
inline WorkInstance instance_at(vec3 origin_camera) {
    return {origin_camera.x, origin_camera.y, origin_camera.z};
}

inline constexpr uint32_t k_primitives_a_group = 256;  // larger runs are cut, so that groups are alike
inline constexpr uint32_t k_primitives_a_lane = 32;    // runs up to this long are drawn by a single lane
inline constexpr size_t k_lane_buckets = 4;  // up to 4, 8, 16, 32 primitives: lanes of a group are alike

// A part's place in the geometry buffer.
struct PartGeometry {
    uint32_t first_triangle_vertex, first_point, first_line_vertex, first_owner;
    bool cull_back;  // the triangles are wound and closed so that their backs are never seen
    uint32_t point_count, line_count;  // stored
    uint32_t point_turn_mask;          // plant/point_run.h; 0: all plants begin with the first
    // Two texels a leaf, in bands; before them two for the part's LeafGrid.
    uint32_t first_leaf_vertex;
    LeafLevels leaves;
};

// What one job adds. Kept from frame to frame, so that a warm frame allocates nothing. Entries stand as they came; gather
// sorts them by the dispatch they belong to.
class WorkPart {
  public:
    WorkPart() = default;
    WorkPart(WorkPart&&) = default;
    WorkPart& operator=(WorkPart&&) = default;
    // is_caster: drawn into the shadow map.
    void clear(bool is_caster = false);
    // Index of the instance within this part, for add().
    uint32_t add_instance(const WorkInstance& instance);
    // All there are, which stay where they are until they have been gathered; their indices are those of the span.
    void share_instances(std::span<const WorkInstance> instances) {
        assert(own_instances_.empty());
        instances_ = instances;
    }
    // start in [0, 1): where in their lists the points and lines begin; they go on at the lists' beginning.
    // first_point: of the plant's run of points, which is moved by start.
    // pixels_per_meter: of the picture, where the plant is; only casters need it.
    void add(const PartGeometry& geometry, const PartChoice& choice, uint32_t instance, float start = 0.0f,
             uint32_t first_point = 0, float pixels_per_meter = 1.0f);
    // Choice i of as many as there are in left_out, where that is 0, for instance first_instance + i.
    void add(const PartGeometry& geometry, const PartRule& rule, const PartDemands& demands,
             const PartChoices& choices, const PlantColumn<uint32_t>& first_points,
             std::span<const uint8_t> left_out, uint32_t first_instance, float start);
    void add_ground(uint32_t first_vertex, uint32_t triangle_count, uint32_t instance);

    uint64_t triangles = 0, lines = 0, points = 0, leaves = 0;

  private:
    friend class WorkList;
    void add_triangles(uint32_t first_vertex, uint32_t count, uint32_t instance, bool cull_back);
    void add_leaves(const PartGeometry& geometry, uint32_t count, uint32_t instance);
    void add_run(WorkKind kind, WorkEntry entry, uint32_t vertices_a_primitive);
    void add_from(WorkKind kind, WorkEntry entry, uint32_t vertices_a_primitive, uint32_t first,
                  uint32_t stored, uint32_t count, bool has_owners);
    // Of points, all but their place, number and instance.
    static WorkEntry entry_of_points(const PartGeometry& geometry, const PartChoice& choice);
    // What an entry's size is to be multiplied with.
    float unit_of(float pixels_per_meter, bool carries_density) const {
        return is_caster_ && !carries_density && pixels_per_meter > 0.0f ? 1.0f / pixels_per_meter : 1.0f;
    }
    // Of one size and all there are.
    WorkKind kind_of_points(float side_px) const;
    void make_room(size_t count) {
        if (entries_.size() - entry_count_ >= count) return;
        entries_.resize(std::max(2 * entries_.size(), entry_count_ + count));
        bins_.resize(entries_.size());
    }
    // Requires room.
    void write(size_t bin, const WorkEntry& entry) {
        entries_[entry_count_] = entry;
        bins_[entry_count_++] = uint8_t(bin);
        ++counts_[bin];
    }

    // Of each kind first the groups, then the lanes' buckets: the order of a layout.
    static constexpr size_t k_bins_of_kind = 1 + k_lane_buckets;
    static constexpr size_t k_bins = k_work_kinds * k_bins_of_kind;
    using BinCounts = std::array<uint32_t, k_bins>;
    // Entries whose instance is among the first instance_count.
    BinCounts count_with(uint32_t instance_count) const;

    bool is_caster_ = false;
    std::vector<WorkInstance> own_instances_;
    std::span<const WorkInstance> instances_;
    size_t entry_count_ = 0;
    std::vector<WorkEntry> entries_;  // and room for more
    std::vector<uint8_t> bins_;       // of each entry
    BinCounts counts_{};
};

// Where one dispatch finds its entries.
struct WorkRange {
    uint32_t first_entry = 0, entry_count = 0;
};

// Of each kind what is drawn by groups, and what by lanes.
struct WorkRanges {
    std::array<WorkRange, k_work_kinds> groups, lanes;
    bool any(WorkKind kind) const {
        return groups[size_t(kind)].entry_count > 0 || lanes[size_t(kind)].entry_count > 0;
    }
};

// A list has what one picture draws, and what so many shadow maps do.
inline constexpr size_t k_most_work_maps = 12;

class WorkList {
  public:
    // Parts for so many jobs, cleared: the picture's, behind them those of each shadow map.
    void begin(size_t picture_part_count, std::span<const size_t> map_part_counts = {});
    WorkPart& part(size_t index) { return parts_[index]; }

    size_t part_count() const { return part_count_; }
    // Of plants, in the parts [first, end).
    PrimitiveCounts count(size_t first, size_t end) const;

    struct Size {
        uint32_t instances = 0, entries = 0;
    };
    // What gather() needs room for.
    Size size() const;

    struct Layout {
        WorkRanges picture;
        std::array<WorkRanges, k_most_work_maps> maps;
        uint32_t instance_count = 0, entry_count = 0;
        uint32_t dropped_entries = 0;  // beyond the capacity of the buffers
        uint32_t whole_maps = 0;       // from the first: nothing of them was dropped
    };
    // Copies all parts, in parallel; entries and instances that do not fit are dropped and counted.
    Layout gather(std::span<WorkInstance> instances, std::span<WorkEntry> entries);

  private:
    // A part's share of the layout.
    struct Place {
        uint32_t first_instance, instance_count;
        WorkPart::BinCounts next;  // where its next entry of each bin goes
    };
    // Entries of the parts [first, end) from next on, sorted by dispatch; gives where the next would go.
    uint32_t place_entries(size_t first, size_t end, uint32_t next, uint32_t capacity, WorkRanges& ranges);

    std::vector<WorkPart> parts_;
    size_t part_count_ = 0, picture_part_count_ = 0, map_count_ = 0;
    std::array<size_t, k_most_work_maps> map_ends_{};  // one past each map's last part
    std::vector<Place> places_;
};

}  // namespace coppice
