// Plants made by hand for clouds: every stored point and line can be told by its surface, also where a cloud shows it.
#pragma once
#include <algorithm>
#include <bit>
#include <vector>
#include "plugins/vegetation/components.h"
#include "plugins/vegetation/plant/plant.h"
#include "runtime/core/random.h"

namespace coppice {

// Above the normal, which turning changes: 20 bits of a surface are the item's number.
inline uint32_t numbered_surface(uint32_t item) { return item << 12 | 32u << 6 | 32u; }
inline uint32_t item_of(const PackedVertex& vertex) { return vertex.surface >> 12; }

class HandPlant {
  public:
    // The same from all sides, each in a place of its own within a metre of the origin.
    PackedPart& add_points(uint32_t count, float projected_area_m2, uint32_t first_item = 0) {
        PackedPart& part = add_part(PackedPartKind::points, projected_area_m2);
        part.first_point = uint32_t(points_.size());
        part.point_count = count;
        for (uint32_t i = 0; i < count; ++i)
            points_.push_back({random_.next_around(0, 1), random_.next_around(0, 1),
                               random_.next_around(0, 1), numbered_surface(first_item + i)});
        return part;
    }
    // One behind the other up the first metre.
    PackedPart& add_lines(const std::vector<float>& widths, float projected_area_m2,
                          uint32_t first_item = 0) {
        PackedPart& part = add_part(PackedPartKind::lines, projected_area_m2);
        part.first_line = uint32_t(lines_.size() / 2);
        part.line_count = uint32_t(widths.size());
        const float length_m = 0.1f * float(widths.size());
        part.line_length_m = length_m / (0.25f * k_pi);
        part.projected_length_m.m = {length_m * length_m, length_m * length_m, length_m * length_m, 0, 0, 0};
        for (uint32_t i = 0; i < widths.size(); ++i) {
            const float step_m = 1.0f / float(widths.size()), y = step_m * float(i);
            lines_.push_back({0.0f, y, 0.0f, numbered_surface(first_item + i)});
            lines_.push_back({0.0f, y + step_m, 0.0f, std::bit_cast<uint32_t>(widths[i])});
        }
        return part;
    }
    // Valid until the next part is added.
    Plant view() const {
        Plant plant;
        plant.bounds_plant = {vec3(-1.0f), vec3(1.0f)};
        plant.parts = parts_;
        plant.points = points_;
        plant.line_vertices = lines_;
        return plant;
    }
    std::vector<PackedPart>& parts() { return parts_; }

  private:
    PackedPart& add_part(PackedPartKind kind, float area_m2) {
        PackedPart part{};
        part.kind = kind;
        part.importance = 1.0f;
        part.triangle_count = 1000;
        part.area_m2 = 2.0f * area_m2;
        part.projected_area_m2.m = {area_m2 * area_m2, area_m2 * area_m2, area_m2 * area_m2, 0, 0, 0};
        part.coverage_gain.fill(1.0f);
        parts_.push_back(part);
        return parts_.back();
    }
    std::vector<PackedPart> parts_;
    std::vector<PackedVertex> points_, lines_;
    Random random_{7};
};

// Gains as measured ones are: they change slowly with size.
inline void roughen_gains(PackedPart& part, Random& random) {
    float gain = random.next_in(0.7f, 1.4f);
    for (float& level : part.coverage_gain) {
        level = gain;
        gain = std::clamp(gain * random.next_in(0.85f, 1.18f), 0.5f, 2.5f);
    }
}

}  // namespace coppice
