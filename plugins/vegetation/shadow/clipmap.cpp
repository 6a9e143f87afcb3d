#include "plugins/vegetation/shadow/clipmap.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include "plugins/vegetation/shadow/shadow_scene.h"

namespace coppice {
namespace {

using glm::dvec2;
using glm::dvec4;

// Of a map's side: as far around the viewer it is looked up. The rest is room to move.
constexpr float k_reach = 0.35f;
// Where a map ends, its texels are so many pixels large.
constexpr float k_texel_px = 2.3f;
// The sun moves on by so much before the maps that were made for another have to be made again at once; before that they are, one by
// one: half the angle that the sun is wide.
constexpr double k_most_sun_turn = 0.005, k_least_sun_turn = 0.0005;  // rad
// Of the motion that is foreseen: maps that the viewer leaves within that are made again before they have to be, a frame each.
constexpr double k_lookahead = 0.2;
constexpr float k_soon = 0.5f;  // how stale such maps are at least
// Of the same motion: maps that the viewer would have left by then, made as far ahead as may be, are too fine for so fast a viewer.
constexpr float k_least_lasting = 0.3f;
constexpr float k_ahead = 0.9f;  // of the room to move, so far ahead maps are made

float room_texels(uint32_t side_texels) {
    return std::max((0.5f - k_reach) * float(side_texels) - k_shadow_border_texels, 1.0f);
}

// Of all that there is, towards the sun, m from the origin; of nothing none.
struct Heights {
    double low_m, high_m;
};

Heights heights_of(const ClipmapFrame& frame, dvec3 origin_world, dvec3 to_sun) {
    const double viewer_m = glm::dot(to_sun, frame.camera_world - origin_world);
    const Box& b = frame.bounds_camera;
    if (b.empty()) return {INFINITY, -INFINITY};
    double low_m = INFINITY, high_m = -INFINITY;
    for (uint32_t i = 0; i < 8; ++i) {
        const dvec3 corner(i & 1 ? b.max.x : b.min.x, i & 2 ? b.max.y : b.min.y, i & 4 ? b.max.z : b.min.z);
        low_m = std::min(low_m, glm::dot(to_sun, corner));
        high_m = std::max(high_m, glm::dot(to_sun, corner));
    }
    return {viewer_m + std::max(low_m, -k_farthest_m), viewer_m + std::min(high_m, k_farthest_m)};
}

dvec2 on_plane(dvec3 across, dvec3 along, dvec3 p) { return dvec2(glm::dot(across, p), glm::dot(along, p)); }

}  // namespace

uint32_t Clipmap::most_side(uint64_t most_bytes) {
    const double room = std::sqrt(double(most_bytes) / (4.0 * k_shadow_map_places));
    return std::max(uint32_t(std::min(room, 4096.0) / 64.0), 2u) * 64u;
}

uint32_t Clipmap::side_for(float focal_px, uint64_t most_bytes) {
    const double side = std::min(double(focal_px) / double(k_texel_px * k_reach), 4096.0);
    return std::clamp(uint32_t(side / 64.0 + 0.5) * 64u, 128u, most_side(most_bytes));
}

float Clipmap::texel_m(uint32_t map) {
    constexpr int k_centimetre_map = 14;
    return std::ldexp(0.01f, int(map) - k_centimetre_map);
}

float Clipmap::reach_m(uint32_t map, uint32_t side_texels) {
    return texel_m(map) * k_reach * float(side_texels);
}

Clipmap::Level Clipmap::level_for(const ClipmapFrame& frame, uint32_t map) const {
    ShadowScene scene{};
    scene.to_sun = frame.to_sun;
    scene.side_texels = frame.side_texels;
    const CheckedShadowScene checked = check_shadow_scene(scene);
    Level level;
    level.map = map;
    level.to_sun = checked.to_sun;
    level.across = checked.across;
    level.along = checked.along;
    level.side_texels = frame.side_texels;
    level.origin_world = frame.origin_world;
    const double texel = texel_m(map);
    // Ahead of the viewer, by what leaves all that is needed now within the map.
    const dvec3 ahead = dvec3(frame.motion_m);
    const double room_m = k_ahead * double(room_texels(frame.side_texels)) * texel;
    const dvec2 step = glm::clamp(on_plane(level.across, level.along, ahead), dvec2(-room_m), dvec2(room_m));
    const dvec3 viewer = frame.camera_world - frame.origin_world;
    // Whole texels from the origin: texels stand for the same places whenever the map is made.
    level.center = glm::floor((on_plane(level.across, level.along, viewer) + step) / texel + 0.5) * texel;
    Heights heights = heights_of(frame, level.origin_world, level.to_sun);
    if (frame.bounds_camera.empty()) heights.low_m = heights.high_m = glm::dot(level.to_sun, viewer);
    // Bounds are rounded anew in each frame, and plants grow.
    const double margin_m = 1e-3 + 0.02 * (heights.high_m - heights.low_m);
    level.low_m = heights.low_m - margin_m;
    level.high_m = heights.high_m + margin_m;
    return level;
}

float Clipmap::staleness(const ClipmapFrame& frame, uint32_t map) const {
    const Level& level = levels_[place_of(map)];
    if (level.map != map || level.side_texels != frame.side_texels) return INFINITY;
    // What has come since would be cut off at the map's depths.
    const Heights heights = heights_of(frame, level.origin_world, level.to_sun);
    if (heights.low_m < level.low_m || heights.high_m > level.high_m) return INFINITY;
    const double turn = glm::length(level.to_sun - dvec3(frame.to_sun));
    // Of the room to move, what a viewer there has used up.
    auto used_at = [&](dvec3 viewer_world) {
        const dvec2 off =
            glm::abs(on_plane(level.across, level.along, viewer_world - level.origin_world) - level.center);
        return float(std::max(off.x, off.y) / (double(room_texels(frame.side_texels)) * texel_m(map)));
    };
    const float used = used_at(frame.camera_world);
    if (used >= 1.0f) return used;
    const float used_soon = used_at(frame.camera_world + dvec3(frame.motion_m) * k_lookahead);
    const float leaving = used_soon >= 1.0f ? k_soon + (1.0f - k_soon) * used : 0.0f;
    const float turned =
        turn > k_least_sun_turn ? k_soon + (1.0f - k_soon) * float(turn / k_most_sun_turn) : 0.0f;
    // Of several the oldest goes first, so that each has its turn while changes go on.
    const float age = std::min(float(commit_count_ - level.made_at) / 256.0f, 0.99f);
    const float outdated = level.outdated ? k_soon + (1.0f - k_soon) * age : 0.0f;
    return std::max({leaving, turned, outdated});
}

void Clipmap::update(const ClipmapFrame& frame) {
    auto map_at = [&](float distance_m) {
        uint32_t map = 0;
        while (map + 1 < k_shadow_map_count && reach_m(map, frame.side_texels) < distance_m) ++map;
        return map;
    };
    auto lasts = [&](uint32_t map) {
        return (1.0f + k_ahead) * room_texels(frame.side_texels) * texel_m(map) >=
               k_least_lasting * glm::length(frame.motion_m);
    };
    last_ = map_at(frame.far_m);
    first_ = std::min(map_at(frame.nearest_m), last_);
    first_ = std::max(first_ + k_shadow_map_places, last_ + 1) - k_shadow_map_places;
    while (first_ < last_ && !lasts(first_)) ++first_;
    due_count_ = 0;
    float stalest = 0.0f;
    uint32_t soon = k_shadow_map_count;
    for (uint32_t map = first_; map <= last_; ++map) {
        const float stale = staleness(frame, map);
        if (stale >= 1.0f) {
            due_[due_count_++] = map;
        } else if (stale >= k_soon && stale > stalest) {  // of equals the nearest
            stalest = stale;
            soon = map;
        }
    }
    if (due_count_ == 0 && soon < k_shadow_map_count) due_[due_count_++] = soon;
    for (uint32_t map : due()) next_[place_of(map)] = level_for(frame, map);
}

bool Clipmap::is_due(uint32_t map) const { return std::ranges::find(due(), map) != due().end(); }

void Clipmap::commit(std::span<const Drawn> drawn) {
    assert(drawn.size() <= due_count_);
    for (size_t i = 0; i < drawn.size(); ++i) {
        Level& level = levels_[place_of(due_[i])];
        level = next_[place_of(due_[i])];
        level.incomplete = drawn[i] == Drawn::lacking_tiles;
        level.outdated = drawn[i] == Drawn::cut;
        level.made_at = commit_count_;
    }
    due_count_ = 0;
    ++commit_count_;
}

void Clipmap::note_arrivals() {
    for (Level& level : levels_) level.outdated = level.outdated || level.incomplete;
}

void Clipmap::note_changes() {
    for (Level& level : levels_) level.outdated = true;
}

ShadowView Clipmap::view(uint32_t map, dvec3 camera_world) const {
    const Level& level = this->level(map);
    const double texels_per_m = 1.0 / double(texel_m(map)), half = 0.5 * double(level.side_texels);
    const dvec2 viewer =
        on_plane(level.across, level.along, camera_world - level.origin_world) - level.center;
    const double depth_per_m = 0.5 / std::max(level.high_m - level.low_m, 1e-6);
    ShadowView view;
    view.row_x = vec4(dvec4(level.across * texels_per_m, viewer.x * texels_per_m + half));
    view.row_y = vec4(dvec4(level.along * texels_per_m, viewer.y * texels_per_m + half));
    view.row_z =
        vec4(dvec4(level.to_sun * depth_per_m,
                   (glm::dot(level.to_sun, camera_world - level.origin_world) - level.low_m) * depth_per_m));
    view.row_w = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    view.least_w = 0.5f;
    return view;
}

Frustum Clipmap::casters(uint32_t map, const Frustum& view, dvec3 camera_world,
                         float least_distance_m) const {
    const Level& level = this->level(map);
    Frustum column = view;
    column.right = column.up = column.forward = vec3(0.0f);
    column.corner_cos = 1.0f;  // it looks everywhere: nothing is off its axis
    column.near_m = least_distance_m;
    const dvec2 viewer =
        on_plane(level.across, level.along, camera_world - level.origin_world) - level.center;
    const double half_m = 0.5 * double(level.side_texels) * double(texel_m(map));
    column.plane_count = 4;
    column.planes[0] = vec4(dvec4(level.across, half_m + viewer.x));
    column.planes[1] = vec4(dvec4(-level.across, half_m - viewer.x));
    column.planes[2] = vec4(dvec4(level.along, half_m + viewer.y));
    column.planes[3] = vec4(dvec4(-level.along, half_m - viewer.y));
    return column;
}

}  // namespace coppice
