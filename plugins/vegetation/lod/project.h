// Projected area and length of a part on the screen, in pixels (DESIGN section 3, ERRATA 2 and 3).
#pragma once
#include <glm/common.hpp>
#include <array>
#include <span>
#include "plugins/vegetation/lod/settings.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// How a plant stands to the viewer; shared by all its parts.
struct PlantView {
    vec3 direction_plant;  // unit, from the viewer to the plant, in plant space
    float
        pixels_per_meter;  // on the image at the plant's distance, times its scale: f / r * scale. Finite, >= 0
};

// Numbers of many plants, so that loops over them are made vectors of.
inline constexpr size_t k_plants_a_batch = 256;
template <class T>
using PlantColumn = std::array<T, k_plants_a_batch>;

// Columns of one length, at most k_plants_a_batch.
struct PlantViews {
    std::span<const float> direction_x, direction_y, direction_z, pixels_per_meter;
    size_t size() const { return pixels_per_meter.size(); }
    PlantView operator[](size_t i) const {
        return {{direction_x[i], direction_y[i], direction_z[i]}, pixels_per_meter[i]};
    }
};

// pixels_per_meter for a plant of radius_m whose centre is distance_m away. Within two radii r moves from the centre
// towards the nearest point, since what is near decides what can be seen of holes; it is clamped below at r_min_m, so
// that a viewer inside a plant gets a large but finite number (ERRATA 3).
inline float pixels_per_meter(float focal_px, float distance_m, float radius_m, float r_min_m, float scale) {
    float closeness = radius_m > 0.0f ? glm::clamp(2.0f - distance_m / radius_m, 0.0f, 1.0f) : 0.0f;
    float r = distance_m - 0.7f * radius_m * closeness;
    return focal_px / (r > r_min_m ? r : r_min_m) * scale;
}

// What a part would cover, whatever d'.
struct PartProjection {
    float pixels_per_meter = 0.0f;
    float area_px2 = 0.0f;   // A'_p; of points that which asks for them
    float length_px = 0.0f;  // l'; only of lines
    float height = 0.0f;     // sine, of the plant over the viewer; its sign does not count
};

// A'_p in square pixels: what the part would cover if none of it hid another piece of it.
float projected_area_px2(const PackedPart& part, const PlantView& view, ProjectionMode mode);
// l' in pixels: length of all its lines.
float projected_length_px(const PackedPart& part, const PlantView& view, ProjectionMode mode);
// Both, as the part's kind needs them. Where splats are sized by |n . v| they show of themselves what is seen from here, so
// points are asked for by the mean area over all directions: walking around a plant takes no point away and adds none, and
// a tile's cloud, which is made for no direction, has the same points.
PartProjection project_part(const PackedPart& part, const PlantView& view, const FrameSettings& settings);
// The same of many plants of one model.
struct PartColumns {
    PlantColumn<float> area_px2;
    PlantColumn<float> length_px;  // left alone for parts of points
};
void project_parts(const PackedPart& part, const PlantViews& views, const FrameSettings& settings,
                   PartColumns& out);

}  // namespace coppice
