#include "plugins/vegetation/draw/work_list.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include "plugins/vegetation/plant/leaf_bands.h"
#include "plugins/vegetation/plant/point_run.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr size_t k_parts_a_job = 16;

// Four times a normalised number of 16 bits each; splat_points.comp reads it.
uint32_t pack_height_gain(HeightGain gain) {
    auto pack = [](float value) {
        return uint32_t(uint16_t(int16_t(std::clamp(value * 0.25f, -1.0f, 1.0f) * 32767.0f)));
    };
    return pack(gain.second) | pack(gain.fourth) << 16;
}

size_t lane_bucket(uint32_t count) { return count <= 4 ? 0 : count <= 8 ? 1 : count <= 16 ? 2 : 3; }

}  // namespace

// Texels of the shadow map are not pixels, so casters are all of any size.
WorkKind WorkPart::kind_of_points(float side_px) const {
    constexpr float k_slack =
        1.0e-3f;  // a rounding error over a whole pixel must not cost four times the pixels
    return is_caster_                ? WorkKind::points_any
           : side_px <= 1.0f + k_slack ? WorkKind::points_1
           : side_px <= 2.0f + k_slack ? WorkKind::points_2
                                       : WorkKind::points_any;
}

void WorkPart::clear(bool is_caster) {
    is_caster_ = is_caster;
    triangles = lines = points = leaves = 0;
    own_instances_.clear();
    instances_ = {};
    entry_count_ = 0;
    counts_ = {};
}

uint32_t WorkPart::add_instance(const WorkInstance& instance) {
    own_instances_.push_back(instance);
    instances_ = own_instances_;
    return uint32_t(own_instances_.size() - 1);
}

void WorkPart::add_run(WorkKind kind, WorkEntry entry, uint32_t vertices_a_primitive) {
    if (entry.count == 0) return;
    const size_t groups = size_t(kind) * k_bins_of_kind;
    make_room(entry.count / k_primitives_a_group + 1);
    if (entry.count <= k_primitives_a_lane) return write(groups + 1 + lane_bucket(entry.count), entry);
    uint32_t left = entry.count;
    while (left > 0) {
        entry.count = std::min(left, k_primitives_a_group);
        write(groups, entry);
        entry.first_vertex += entry.count * vertices_a_primitive;
        entry.first_owner += entry.count;
        left -= entry.count;
    }
}

WorkPart::BinCounts WorkPart::count_with(uint32_t instance_count) const {
    if (instance_count >= instances_.size()) return counts_;
    BinCounts counts{};
    for (size_t e = 0; e < entry_count_; ++e)
        counts[bins_[e]] += (entries_[e].instance & ~k_ground_bit) < instance_count;
    return counts;
}

void WorkPart::add_triangles(uint32_t first_vertex, uint32_t count, uint32_t instance, bool cull_back) {
    add_run(WorkKind::triangles, {first_vertex, count, instance, 0, 0.0f, 0, cull_back ? 1u : 0u, 0.0f}, 3);
}

void WorkPart::add_ground(uint32_t first_vertex, uint32_t triangle_count, uint32_t instance) {
    add_triangles(first_vertex, triangle_count, instance | k_ground_bit, false);
}

void WorkPart::add_leaves(const PartGeometry& geometry, uint32_t count, uint32_t instance) {
    const LeafLevels levels = geometry.leaves;
    const LeafRun run = leaves_of_level(levels.full_count, levels.least_count, count);
    leaves += count;
    add_run(WorkKind::leaves,
            {geometry.first_leaf_vertex + 2 + 2 * run.first, run.count, instance, 0, 0.0f,
             levels.full_count - count, geometry.first_leaf_vertex, 0.0f},
            2);
}

void WorkPart::add_from(WorkKind kind, WorkEntry entry, uint32_t vertices_a_primitive, uint32_t first,
                        uint32_t stored, uint32_t count, bool has_owners) {
    const uint32_t from_start = std::min(count, stored - first);
    // What is left for the list's beginning, and the run from `first` on.
    entry.count = count - from_start;
    add_run(kind, entry, vertices_a_primitive);
    entry.first_vertex += vertices_a_primitive * first;
    if (has_owners) entry.first_owner += first;
    entry.count = from_start;
    add_run(kind, entry, vertices_a_primitive);
}

void WorkPart::add(const PartGeometry& geometry, const PartChoice& choice, uint32_t instance, float start,
                   uint32_t first_point, float pixels_per_meter) {
    auto place_of = [start](uint32_t stored) { return std::min(uint32_t(start * float(stored)), stored); };
    triangles += choice.triangles;
    lines += choice.lines;
    points += choice.points - choice.skipped_points;
    if (choice.triangles > 0)
        add_triangles(geometry.first_triangle_vertex, choice.triangles, instance, geometry.cull_back);
    if (choice.leaves > 0) add_leaves(geometry, choice.leaves, instance);
    if (choice.lines > 0)
        add_from(WorkKind::lines,
                 {geometry.first_line_vertex, 0, instance, 0,
                  choice.line_width_px * unit_of(pixels_per_meter, false),
                  std::bit_cast<uint32_t>(choice.turned_share), 0, 0.0f},
                 2, place_of(geometry.line_count), geometry.line_count, choice.lines, false);
    if (choice.points == 0) return;
    uint32_t first = place_of(geometry.point_count) + run_begin(first_point, choice.points);
    if (first >= geometry.point_count) first -= geometry.point_count;
    WorkEntry entry = entry_of_points(geometry, choice);
    entry.instance = instance;
    entry.size_px *= unit_of(pixels_per_meter, choice.density_limit_m2 > 0.0f);
    const bool differ = choice.point_owner_min > 0 || choice.density_limit_m2 > 0.0f;
    add_from(differ ? WorkKind::points_blend : kind_of_points(choice.splat_px), entry, 1, first,
             geometry.point_count, choice.points, true);
}

WorkEntry WorkPart::entry_of_points(const PartGeometry& geometry, const PartChoice& choice) {
    const bool carry_density = choice.density_limit_m2 > 0.0f;
    return {geometry.first_point,
            0,
            0,
            geometry.first_owner,
            choice.splat_px,
            carry_density ? pack_height_gain(choice.height_gain) : choice.point_owner_min,
            std::bit_cast<uint32_t>(choice.density_limit_m2),
            choice.mean_facing};
}

void WorkPart::add(const PartGeometry& geometry, const PartRule& rule, const PartDemands& demands,
                   const PartChoices& choices, const PlantColumn<uint32_t>& first_points,
                   std::span<const uint8_t> left_out, uint32_t first_instance, float start) {
    using Form = PartRule::Form;
    // Short runs of points, which most are, differ in little.
    const WorkEntry of_points = entry_of_points(geometry, rule.expand({Form::points, 1, 0.0f}, 1.0f));
    const WorkEntry of_line_points =
        entry_of_points(geometry, rule.expand({Form::line_points, 1, 0.0f}, 1.0f));
    for (size_t i = 0; i < left_out.size(); ++i) {
        if (left_out[i]) continue;
        const Form form = choices.form[i];
        const uint32_t count = choices.count[i];
        if (count == 0 && form != Form::triangles && form != Form::blend) continue;
        const uint32_t instance = first_instance + uint32_t(i);
        const bool is_points = form == Form::points;
        if (!(is_points || form == Form::line_points) || count > k_primitives_a_lane || start > 0.0f) {
            add(geometry, rule.expand(choices[i], demands.side_gain[i]), instance, start, first_points[i],
                demands.pixels_per_meter[i]);
            continue;
        }
        make_room(1);
        WorkEntry entry = is_points ? of_points : of_line_points;
        const uint32_t first = run_begin(first_points[i], count);
        entry.first_vertex += first;
        entry.first_owner += first;
        entry.count = count;
        entry.instance = instance;
        entry.size_px *= demands.side_gain[i];
        const WorkKind kind = is_points ? kind_of_points(entry.size_px) : WorkKind::points_blend;
        entry.size_px *= unit_of(demands.pixels_per_meter[i], !is_points);
        write(size_t(kind) * k_bins_of_kind + 1 + lane_bucket(count), entry);
        points += count;
    }
}

void WorkList::begin(size_t picture_part_count, std::span<const size_t> map_part_counts) {
    assert(map_part_counts.size() <= k_most_work_maps);
    part_count_ = picture_part_count_ = picture_part_count;
    map_count_ = map_part_counts.size();
    for (size_t map = 0; map < map_count_; ++map) map_ends_[map] = part_count_ += map_part_counts[map];
    if (parts_.size() < part_count_) parts_.resize(part_count_);
    for (size_t i = 0; i < part_count_; ++i) parts_[i].clear(i >= picture_part_count_);
}

PrimitiveCounts WorkList::count(size_t first, size_t end) const {
    PrimitiveCounts counts;
    for (size_t i = first; i < end; ++i) {
        counts.triangles += parts_[i].triangles;
        counts.lines += parts_[i].lines;
        counts.points += parts_[i].points;
        counts.leaves += parts_[i].leaves;
    }
    return counts;
}

WorkList::Size WorkList::size() const {
    Size size;
    for (size_t i = 0; i < part_count_; ++i) {
        size.instances += uint32_t(parts_[i].instances_.size());
        size.entries += uint32_t(parts_[i].entry_count_);
    }
    return size;
}

uint32_t WorkList::place_entries(size_t first_part, size_t end_part, uint32_t next, uint32_t capacity,
                                 WorkRanges& ranges) {
    for (size_t bin = 0; bin < WorkPart::k_bins; ++bin) {
        const uint32_t first = std::min(next, capacity);
        for (size_t i = first_part; i < end_part; ++i) {
            const uint32_t count = places_[i].next[bin];
            places_[i].next[bin] = next;
            next += count;
        }
        const size_t kind = bin / WorkPart::k_bins_of_kind, bucket = bin % WorkPart::k_bins_of_kind;
        WorkRange& range = bucket == 0 ? ranges.groups[kind] : ranges.lanes[kind];
        if (bucket <= 1) range.first_entry = first;
        range.entry_count += std::min(next, capacity) - first;
    }
    return next;
}

WorkList::Layout WorkList::gather(std::span<WorkInstance> instances, std::span<WorkEntry> entries) {
    Layout layout;
    if (places_.size() < part_count_) places_.resize(part_count_);
    for (size_t i = 0; i < part_count_; ++i) {
        const size_t room = instances.size() - layout.instance_count;
        Place& place = places_[i];
        place.first_instance = layout.instance_count;
        place.instance_count = uint32_t(std::min(room, parts_[i].instances_.size()));
        place.next = parts_[i].count_with(place.instance_count);
        layout.instance_count += place.instance_count;
    }
    const uint32_t capacity = uint32_t(std::min<size_t>(entries.size(), UINT32_MAX));
    uint32_t next = place_entries(0, picture_part_count_, 0, capacity, layout.picture);
    for (size_t map = 0, first = picture_part_count_; map < map_count_; first = map_ends_[map++]) {
        next = place_entries(first, map_ends_[map], next, capacity, layout.maps[map]);
        bool is_whole = layout.whole_maps == map && next <= capacity;
        for (size_t i = first; i < map_ends_[map]; ++i)
            is_whole = is_whole && places_[i].instance_count == parts_[i].instances_.size();
        layout.whole_maps += is_whole;
    }
    layout.entry_count = std::min(next, capacity);
    layout.dropped_entries = size().entries - layout.entry_count;

    parallel_for(part_count_, k_parts_a_job, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
            const WorkPart& part = parts_[i];
            Place& place = places_[i];
            if (place.instance_count > 0)
                std::memcpy(&instances[place.first_instance], part.instances_.data(),
                            place.instance_count * sizeof(WorkInstance));
            for (size_t e = 0; e < part.entry_count_; ++e) {
                WorkEntry entry = part.entries_[e];
                if ((entry.instance & ~k_ground_bit) >= place.instance_count) continue;
                const uint32_t at = place.next[part.bins_[e]]++;
                if (at >= capacity) continue;
                entry.instance += place.first_instance;
                entries[at] = entry;
            }
        }
    });
    return layout;
}

}  // namespace coppice
