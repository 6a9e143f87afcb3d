#include "plugins/vegetation/draw/work_list.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace coppice {
namespace {

size_t lane_bucket(uint32_t count) { return count <= 4 ? 0 : count <= 8 ? 1 : count <= 16 ? 2 : 3; }

}  // namespace

WorkInstance instance_of(const mat3& rotation, float scale, vec3 position_camera) {
    WorkInstance instance{};
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) instance.rows[row][column] = rotation[column][row] * scale;
        instance.rows[row][3] = position_camera[row];
    }
    return instance;
}

void WorkPart::clear() {
    triangles = lines = points = 0;
    instances_.clear();
    for (auto& list : groups_) list.clear();
    for (auto& buckets : lanes_)
        for (auto& list : buckets) list.clear();
}

uint32_t WorkPart::add_instance(const WorkInstance& instance) {
    instances_.push_back(instance);
    return uint32_t(instances_.size() - 1);
}

void WorkPart::add_run(WorkKind kind, WorkEntry entry, uint32_t vertices_a_primitive) {
    if (entry.count == 0) return;
    if (entry.count <= k_primitives_a_lane) {
        lanes_[size_t(kind)][lane_bucket(entry.count)].push_back(entry);
        return;
    }
    uint32_t left = entry.count;
    while (left > 0) {
        entry.count = std::min(left, k_primitives_a_group);
        groups_[size_t(kind)].push_back(entry);
        entry.first_vertex += entry.count * vertices_a_primitive;
        entry.first_owner += entry.count;
        left -= entry.count;
    }
}

void WorkPart::add_triangles(uint32_t first_vertex, uint32_t count, uint32_t instance, bool cull_back) {
    add_run(WorkKind::triangles, {first_vertex, count, instance, 0, 0.0f, 0, cull_back ? 1u : 0u, 0.0f}, 3);
}

void WorkPart::add_ground(uint32_t first_vertex, uint32_t triangle_count, uint32_t instance) {
    add_triangles(first_vertex, triangle_count, instance | k_ground_bit, false);
}

void WorkPart::add(const PartGeometry& geometry, const PartChoice& choice, uint32_t instance, float start) {
    add_triangles(geometry.first_triangle_vertex, choice.triangles, instance, geometry.cull_back);
    // The part of a run of `count` from `start` on, and what is left for the list's beginning.
    auto cut = [start](uint32_t count, uint32_t stored) {
        uint32_t first = std::min(uint32_t(start * float(stored)), stored);
        return std::pair(first, std::min(count, stored - first));
    };
    auto [first_line, lines_from_start] = cut(choice.lines, geometry.line_count);
    WorkEntry line{geometry.first_line_vertex,
                   0,
                   instance,
                   0,
                   choice.line_width_px,
                   std::bit_cast<uint32_t>(choice.turned_share),
                   0,
                   0.0f};
    line.count = choice.lines - lines_from_start;
    add_run(WorkKind::lines, line, 2);
    line.first_vertex += 2 * first_line;
    line.count = lines_from_start;
    add_run(WorkKind::lines, line, 2);
    // A side a rounding error over a whole pixel must not cost four times the pixels.
    constexpr float k_slack = 1.0e-3f;
    float side = choice.splat_px;
    WorkKind kind = choice.point_owner_min > 0 || choice.density_limit_m2 > 0.0f ? WorkKind::points_blend
                    : side <= 1.0f + k_slack                                     ? WorkKind::points_1
                    : side <= 2.0f + k_slack                                     ? WorkKind::points_2
                                                                                 : WorkKind::points_any;
    auto [first_point, points_from_start] = cut(choice.points, geometry.point_count);
    WorkEntry point{geometry.first_point,
                    0,
                    instance,
                    geometry.first_owner,
                    side,
                    choice.point_owner_min,
                    std::bit_cast<uint32_t>(choice.density_limit_m2),
                    choice.mean_facing};
    point.count = choice.points - points_from_start;
    add_run(kind, point, 1);
    point.first_vertex += first_point;
    point.first_owner += first_point;
    point.count = points_from_start;
    add_run(kind, point, 1);
    triangles += choice.triangles;
    lines += choice.lines;
    points += choice.points - choice.skipped_points;
}

void WorkList::begin(size_t part_count) {
    if (parts_.size() < part_count) parts_.resize(part_count);
    part_count_ = part_count;
    for (size_t i = 0; i < part_count; ++i) parts_[i].clear();
}

WorkList::Size WorkList::size() const {
    Size size;
    for (size_t i = 0; i < part_count_; ++i) {
        size.instances += uint32_t(parts_[i].instances_.size());
        for (const auto& list : parts_[i].groups_) size.entries += uint32_t(list.size());
        for (const auto& buckets : parts_[i].lanes_)
            for (const auto& list : buckets) size.entries += uint32_t(list.size());
    }
    return size;
}

WorkList::Layout WorkList::gather(std::span<WorkInstance> instances, std::span<WorkEntry> entries) {
    Layout layout;
    first_instance_.resize(part_count_);
    uint32_t wanted_instances = 0;
    for (size_t i = 0; i < part_count_; ++i) {
        const auto& list = parts_[i].instances_;
        first_instance_[i] = wanted_instances;
        size_t room = instances.size() - layout.instance_count;
        size_t taken = std::min(room, list.size());
        if (taken) std::memcpy(&instances[layout.instance_count], list.data(), taken * sizeof(WorkInstance));
        layout.instance_count += uint32_t(taken);
        wanted_instances += uint32_t(list.size());
    }
    auto append = [&](const std::vector<WorkEntry>& list, size_t part) {
        for (WorkEntry entry : list) {
            entry.instance += first_instance_[part];
            if (layout.entry_count >= entries.size() ||
                (entry.instance & ~k_ground_bit) >= layout.instance_count) {
                ++layout.dropped_entries;
                continue;
            }
            entries[layout.entry_count++] = entry;
        }
    };
    for (size_t kind = 0; kind < k_work_kinds; ++kind) {
        layout.groups[kind].first_entry = layout.entry_count;
        for (size_t i = 0; i < part_count_; ++i) append(parts_[i].groups_[kind], i);
        layout.groups[kind].entry_count = layout.entry_count - layout.groups[kind].first_entry;
        layout.lanes[kind].first_entry = layout.entry_count;
        for (size_t bucket = 0; bucket < k_lane_buckets; ++bucket)
            for (size_t i = 0; i < part_count_; ++i) append(parts_[i].lanes_[kind][bucket], i);
        layout.lanes[kind].entry_count = layout.entry_count - layout.lanes[kind].first_entry;
    }
    return layout;
}

}  // namespace coppice
