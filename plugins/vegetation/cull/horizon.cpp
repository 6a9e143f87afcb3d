#include "plugins/vegetation/cull/horizon.h"

#include <algorithm>
#include "plugins/vegetation/cull/ground_level.h"

namespace coppice {
namespace {

// Beyond this many blocks, rings are this share of their distance apart.
constexpr float k_even_rings = 48.0f;
// Places of segments are known to this share of a block.
constexpr float k_place_slack = 1.0f / 256.0f;

struct Ray {
    float x, z;
};
float cross(Ray a, Ray b) { return a.x * b.z - a.z * b.x; }
float dot(Ray a, Ray b) { return a.x * b.x + a.z * b.z; }

// Face f has the axis f / 2 (x or z) and looks along it, or against it where f is odd.
Ray edge_of(uint32_t face, float across) {
    const float along = face % 2 == 0 ? 1.0f : -1.0f;
    return face < 2 ? Ray{along, across} : Ray{across, along};
}

}  // namespace

// Where the camera stands on the terrain. Blocks are counted from the field's corner.
struct Horizon::Place {
    TerrainLayout layout;
    uint32_t patches_across;
    float block_m;
    float end_block[2];     // of the field, along x and z; the last block may be a part of one
    float camera_block[2];  // likewise
    vec3 camera_local;
    float slack_m;  // of heights: what rounding of coordinates can do
};

void Horizon::build(const Terrain* terrain, dvec3 camera_world, const Frustum& frustum, float error_px) {
    ring_count_ = 0;
    if (!terrain) return;
    Place place;
    place.layout = terrain->layout();
    const TerrainLayout& layout = place.layout;
    if (layout.cells_x == 0 || layout.cells_z == 0 || !(layout.cell_m > 0.0f)) return;
    place.patches_across = (layout.cells_x + k_patch_cells - 1) / k_patch_cells;
    place.block_m = layout.cell_m * float(k_block_cells);
    place.end_block[0] = float(layout.cells_x) / float(k_block_cells);
    place.end_block[1] = float(layout.cells_z) / float(k_block_cells);
    place.camera_local = vec3(camera_world - terrain->origin_world());
    place.camera_block[0] = (place.camera_local.x - layout.corner_local.x) / place.block_m;
    place.camera_block[1] = (place.camera_local.z - layout.corner_local.y) / place.block_m;
    const Box bounds = terrain->bounds_local();
    const vec3 extent = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
    place.slack_m = 0x1p-20f * (extent.x + extent.y + extent.z + std::fabs(place.camera_local.y));
    if (!choose_levels(*terrain, place, frustum, error_px)) return;

    focal_px_ = frustum.focal_px;
    see_columns(frustum);
    rings_m_.clear();
    const float last = std::max(place.end_block[0], place.end_block[1]);
    for (float ring = 0.5f; ring < last; ring += std::max(1.0f, ring * (1.0f / k_even_rings)))
        rings_m_.push_back(ring * place.block_m);
    constexpr size_t k_all_columns = 4 * k_columns;
    if (slopes_.size() < rings_m_.size() * k_all_columns) slopes_.resize(rings_m_.size() * k_all_columns);
    line_.resize(size_t(std::max(place.end_block[0], place.end_block[1])) + 1);

    for (size_t ring = 0; ring < rings_m_.size(); ++ring) {
        float* slopes = &slopes_[ring * k_all_columns];
        bool any = false;
        for (uint32_t face = 0; face < 4; ++face) {
            const ColumnRange seen = seen_[face];
            float* first = slopes + face * k_columns + seen.first;
            if (ring == 0)
                std::fill_n(first, seen.end - seen.first, -INFINITY);
            else
                std::copy_n(first - k_all_columns, seen.end - seen.first, first);
            if (seen.first < seen.end)
                any |= add_ring(*terrain, place, face, rings_m_[ring] / place.block_m,
                                slopes + face * k_columns);
        }
        if (!any) break;
        ring_count_ = uint32_t(ring) + 1;
    }
}

// False where the camera is not certainly above all ground that the near plane might cut.
bool Horizon::choose_levels(const Terrain& terrain, const Place& place, const Frustum& frustum,
                            float error_px) {
    const vec3 camera = place.camera_local;
    const float reach_m = 1.01f * frustum.near_m / frustum.corner_cos + place.slack_m;
    const std::span<const TerrainPatch> patches = terrain.patches();
    drawn_level_.resize(patches.size());
    bool beside_ground = false;
    for (size_t p = 0; p < patches.size(); ++p) {
        const TerrainPatch& patch = patches[p];
        const Box bounds{patch.bounds_local.min - camera, patch.bounds_local.max - camera};
        const uint32_t level = choose_ground_level(patch, terrain.levels(), bounds, frustum, error_px);
        drawn_level_[p] = patch.first_level + level;
        const bool near = bounds.min.x <= reach_m && bounds.max.x >= -reach_m && bounds.min.z <= reach_m &&
                          bounds.max.z >= -reach_m && bounds.max.y >= -reach_m;
        if (near && level > 0) return false;
        beside_ground |= near;
    }
    // Beyond the field there is no ground to be above of.
    const TerrainLayout& layout = place.layout;
    uint32_t first[2], last[2];  // cells
    for (int axis = 0; axis < 2; ++axis) {
        const float cell = place.camera_block[axis] * float(k_block_cells);
        const float reach = reach_m / layout.cell_m + k_place_slack;
        const float end = float(axis == 0 ? layout.cells_x : layout.cells_z);
        if (!(cell - reach > 0.0f && cell + reach < end)) return false;
        first[axis] = uint32_t(cell - reach);
        last[axis] = uint32_t(cell + reach);
    }
    if (!beside_ground) return true;
    constexpr uint32_t k_most_cells = 32;
    if (last[0] - first[0] > k_most_cells || last[1] - first[1] > k_most_cells) return false;
    // Within reach the ground rises by no more than its steepest triangle there.
    auto height = [&](uint32_t column, uint32_t row) {
        return terrain.height_at(layout.corner_local.x + float(column) * layout.cell_m,
                                 layout.corner_local.y + float(row) * layout.cell_m);
    };
    float steepest = 0.0f;
    for (uint32_t row = first[1]; row <= last[1]; ++row)
        for (uint32_t column = first[0]; column <= last[0]; ++column) {
            const float corner = height(column, row), opposite = height(column + 1, row + 1);
            for (const float beside : {height(column + 1, row), height(column, row + 1)})
                steepest = std::max(steepest, glm::length(vec2(beside - corner, opposite - beside)));
        }
    const float rise_m = steepest / layout.cell_m * (reach_m + layout.cell_m * k_place_slack);
    return camera.y - reach_m > terrain.height_at(camera.x, camera.z) + rise_m + place.slack_m;
}

// The frustum seen from above is a wedge, or all directions if the vertical is in view.
void Horizon::see_columns(const Frustum& frustum) {
    const vec4* sides = &frustum.planes[1];
    bool up = true, down = true;
    for (int s = 0; s < 4; ++s) {
        up = up && sides[s].y > -0.01f;
        down = down && sides[s].y < 0.01f;
    }
    Ray low{}, high{};
    for (int corner = 0; corner < 4; ++corner) {
        vec3 ray = glm::cross(vec3(sides[corner / 2]), vec3(sides[2 + corner % 2]));
        if (glm::dot(ray, frustum.forward) < 0.0f) ray = -ray;
        const Ray flat{ray.x, ray.z};
        if (corner == 0 || cross(low, flat) < 0.0f) low = flat;
        if (corner == 0 || cross(high, flat) > 0.0f) high = flat;
    }
    const bool wide =
        dot(low, high) <= 0.0f && cross(low, high) <= 0.1f * std::sqrt(dot(low, low) * dot(high, high));
    const bool all = up || down || wide;
    constexpr float k_wider = 1e-3f;  // rounding
    low = {low.x + k_wider * low.z, low.z - k_wider * low.x};
    high = {high.x - k_wider * high.z, high.z + k_wider * high.x};
    auto in_view = [&](Ray ray) { return cross(low, ray) >= 0.0f && cross(ray, high) >= 0.0f; };

    for (uint32_t face = 0; face < 4; ++face) {
        ColumnRange& seen = seen_[face];
        seen = {all ? 0u : k_columns, all ? k_columns : 0u};
        for (uint32_t column = 0; !all && column < k_columns; ++column) {
            const Ray a = edge_of(face, float(column) * (2.0f / k_columns) - 1.0f);
            const Ray b = edge_of(face, float(column + 1) * (2.0f / k_columns) - 1.0f);
            const float turn = cross(a, b);  // its sign is the face's
            const bool holds_low = cross(a, low) * turn >= 0.0f && cross(low, b) * turn >= 0.0f;
            if (!in_view(a) && !in_view(b) && !holds_low) continue;
            seen.first = std::min(seen.first, column);
            seen.end = column + 1;
        }
        if (seen.first >= seen.end) seen = {};
    }
}

// Raises the slopes of a face's columns to what the ground at a ring tells. ring: u in blocks. False where all of it is
// beyond the field.
bool Horizon::add_ring(const Terrain& terrain, const Place& place, uint32_t face, float ring, float* slopes) {
    const uint32_t axis = face / 2, other = 1 - axis;
    const ColumnRange seen = seen_[face];
    const float along = place.camera_block[axis] + (face % 2 == 0 ? ring : -ring);
    const float middle = place.camera_block[other], end = place.end_block[other];
    if (!(along - k_place_slack > 0.0f && along + k_place_slack < place.end_block[axis])) return false;
    auto across = [&](uint32_t column) {
        return middle + ring * (float(column) * (2.0f / k_columns) - 1.0f);
    };

    // Of the blocks across, the lower of the one or two that the ring passes through.
    const float from = std::max(across(seen.first) - k_place_slack, 0.0f);
    const float to = std::min(across(seen.end) + k_place_slack, end);
    if (!(from < to)) return false;
    const uint32_t line_end = std::min(uint32_t(to) + 1, uint32_t(std::ceil(end)));
    const std::span<const float> least = terrain.least_heights();
    auto height_of = [&](uint32_t u, uint32_t v) {
        const uint32_t x = axis == 0 ? u : v, z = axis == 0 ? v : u;
        const uint32_t patch = z / k_blocks_across * place.patches_across + x / k_blocks_across;
        return least[(size_t(drawn_level_[patch]) * k_blocks_across + z % k_blocks_across) * k_blocks_across +
                     x % k_blocks_across];
    };
    const uint32_t u0 = uint32_t(along - k_place_slack), u1 = uint32_t(along + k_place_slack);
    for (uint32_t v = uint32_t(from); v < line_end; ++v)
        line_[v] = u0 == u1 ? height_of(u0, v) : std::min(height_of(u0, v), height_of(u1, v));

    const float eye_m = place.camera_local.y + place.slack_m, per_m = 1.0f / (ring * place.block_m);
    for (uint32_t column = seen.first; column < seen.end; ++column) {
        const float begin = across(column) - k_place_slack, stop = across(column + 1) + k_place_slack;
        if (!(begin >= 0.0f && stop < end)) continue;
        float lowest = INFINITY;
        for (uint32_t v = uint32_t(begin); v <= uint32_t(stop); ++v) lowest = std::min(lowest, line_[v]);
        slopes[column] = std::max(slopes[column], (lowest - eye_m) * per_m);
    }
    return true;
}

// False where nothing of the box is there.
bool Horizon::span_of(const Box& box, uint32_t face, Span& span) const {
    const ColumnRange seen = seen_[face];
    const int axis = face < 2 ? 0 : 2, other = 2 - axis;
    const bool against = face % 2 != 0;
    span.u_end = against ? -box.min[axis] : box.max[axis];
    const float v_low = box.min[other], v_high = box.max[other];
    span.u_begin = std::max({against ? -box.max[axis] : box.min[axis], v_low, -v_high, 0.0f});  // |v| <= u
    if (seen.first >= seen.end || !(span.u_begin <= span.u_end && span.u_end > 0.0f)) return false;
    // Infinite where u_begin is 0 and the box goes to that side: then to the face's border.
    const float low = v_low / (v_low < 0.0f ? span.u_begin : span.u_end);
    const float high = v_high / (v_high > 0.0f ? span.u_begin : span.u_end);
    auto column_at = [](float across) {
        return uint32_t((glm::clamp(across, -1.0f, 1.0f) + 1.0f) * (0.5f * k_columns));
    };
    span.first = std::max(column_at(low), seen.first);
    span.last = std::min(column_at(high), seen.end - 1);
    return span.first <= span.last;
}

const float* Horizon::slopes_at(uint32_t face, float u) const {
    const size_t nearer =
        size_t(std::upper_bound(rings_m_.begin(), rings_m_.begin() + ring_count_, u) - rings_m_.begin());
    return nearer > 0 ? &slopes_[((nearer - 1) * 4 + face) * k_columns] : nullptr;
}

bool Horizon::hidden(const Box& bounds_camera, float spread_px) const {
    if (ring_count_ == 0 || bounds_camera.empty()) return false;
    const vec3 far = glm::max(glm::abs(bounds_camera.min), glm::abs(bounds_camera.max));
    // Diagonally, and a pixel more: what rounding moves on the picture.
    const float a_pixel_m = 1.4143f / focal_px_ * glm::length(far), beside_m = a_pixel_m * (spread_px + 1.0f);
    // draw/splat_points.comp: twice as far as it reaches a square comes nearer along the ray, which keeps its slope.
    const float nearer_m = 2.0f * a_pixel_m * spread_px;
    const Box box{bounds_camera.min - beside_m, bounds_camera.max + beside_m};
    if (!is_finite(box.min) || !is_finite(box.max)) return false;

    bool in_view = false;
    for (uint32_t face = 0; face < 4; ++face) {
        Span span;
        if (!span_of(box, face, span)) continue;
        in_view = true;
        const float* horizon = slopes_at(face, span.u_begin - nearer_m);
        if (!horizon) return false;
        const float top = box.max.y, slope = top / (top > 0.0f ? span.u_begin : span.u_end);
        for (uint32_t column = span.first; column <= span.last; ++column)
            if (!(slope < horizon[column])) return false;
    }
    return in_view;
}

bool Horizon::hides_some(const Box& bounds_camera) const {
    if (ring_count_ == 0 || bounds_camera.empty() || !is_finite(bounds_camera.min) ||
        !is_finite(bounds_camera.max))
        return false;
    for (uint32_t face = 0; face < 4; ++face) {
        Span span;
        if (!span_of(bounds_camera, face, span)) continue;
        // Where it is farthest: there the most ground stands before it.
        const float* horizon = slopes_at(face, span.u_end);
        const float slope = bounds_camera.min.y / span.u_end;
        for (uint32_t column = span.first; horizon && column <= span.last; ++column)
            if (slope < horizon[column]) return true;
    }
    return false;
}

}  // namespace coppice
