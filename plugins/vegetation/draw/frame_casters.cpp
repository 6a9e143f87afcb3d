#include "plugins/vegetation/draw/frame_casters.h"

#include <algorithm>
#include <cmath>
#include "plugins/vegetation/cull/caster_frustum.h"
#include "plugins/vegetation/cull/ground_level.h"

namespace coppice {
namespace {

static_assert(k_shadow_map_places == k_most_work_maps);

// Of d': what throws shadows is drawn with so much coarser primitives than what is seen. Measured: twice as coarse takes half
// the time and adds nothing to the picture's error (docs/shadows.md).
constexpr float k_caster_coarseness = 2.0f;

FrameSettings caster_settings(const FrameSettings& settings) {
    FrameSettings of_casters = settings;
    of_casters.sample_distance_px *= k_caster_coarseness;
    of_casters.line_sample_distance_px *= k_caster_coarseness;
    return of_casters;
}

// Not in steps of one texel: a window that is drawn larger would make a new map in every frame.
uint32_t side_of(uint32_t wanted_texels, uint64_t pixel_count) {
    constexpr uint32_t k_step = 64, k_most = 4096, k_least = 16, k_limit = 16384;
    if (wanted_texels > 0) return std::clamp(wanted_texels, k_least, k_limit);
    return std::min((uint32_t(std::sqrt(double(pixel_count))) / k_step + 1) * k_step, k_most);
}

// Of nested maps: one lies behind the other where buffers may be bound.
uint32_t nested_side_of(uint32_t wanted_texels, float focal_px, uint64_t most_bytes) {
    constexpr uint32_t k_step = 64;
    if (wanted_texels == 0) return Clipmap::side_for(focal_px, most_bytes);
    const uint32_t most = Clipmap::most_side(most_bytes);
    return std::clamp((std::min(wanted_texels, most) + k_step - 1) / k_step * k_step, k_step, most);
}

float farthest_along(const Box& box, vec3 direction) {
    const vec3 corner(direction.x > 0.0f ? box.max.x : box.min.x, direction.y > 0.0f ? box.max.y : box.min.y,
                      direction.z > 0.0f ? box.max.z : box.min.z);
    return glm::dot(corner, direction);
}

float farthest(const Box& box) {
    return box.empty() ? 0.0f : glm::length(glm::max(glm::abs(box.min), glm::abs(box.max)));
}

}  // namespace

void MapCasters::list(const TileList::Tiles& tiles, const TileList::Plants& plants,
                      const SceneGeometry& geometry, std::span<const Ground> grounds, const Frustum& frustum,
                      dvec3 camera_world, const FrameSettings& settings) {
    frustum_ = frustum;
    settings_ = caster_settings(settings);
    spread_px_ = widest_spread_px(geometry.least_importance, geometry.most_line_width, settings_);
    tiles_.list(tiles, plants, frustum_, camera_world,
                {settings_.level_of_detail ? settings_.sample_distance_px / std::sqrt(settings_.splat_factor)
                                           : 0.0f,
                 vec3(0.0f), nullptr, spread_px_, 0.0f});
    grounds_.list(grounds, frustum_, camera_world, ground_error_px(settings_));
}

void MapCasters::draw(const SceneGeometry& geometry, uint32_t rest_index, float least_slope, WorkList& work,
                      size_t first_part) {
    plants_.draw(tiles_, geometry, frustum_, settings_, rest_index, work, first_part + 1);
    ground_expander_.expand(grounds_.in_view(), geometry, frustum_, ground_error_px(settings_),
                            work.part(first_part), least_slope);
}

uint32_t MapCasters::plant_count() const {
    uint32_t visible = 0, hidden = 0;
    uint64_t triangles = 0;
    plants_.count(visible, hidden, triangles);
    return visible;
}

void FrameCasters::list(const TileList::Tiles& tiles, const TileList::Plants& plants,
                        const SceneGeometry& geometry, std::span<const Ground> grounds, const View& view,
                        const Light& light, const FrameSettings& settings) {
    const vec3 to_sun = normalize_or(light.direction_to_sun, vec3(0.0f));
    const bool has_sun = to_sun != vec3(0.0f) && light.sun_color != vec3(0.0f);
    const float far_m =
        std::min(settings.shadow_distance_m, farthest_along(view.scene_bounds, view.frustum.forward));
    const bool is_lit = settings.view == RepresentationView::lit;
    drop();
    is_nested_ = settings.shadows == ShadowKind::clipmap;
    // Where others, or none, are drawn, these do not stay.
    if (!is_nested_) clipmap_.forget();
    if (settings.shadows == ShadowKind::none || !is_lit || !has_sun || !(far_m > view.frustum.near_m))
        return clipmap_.forget();
    to_sun_ = to_sun;
    far_m_ = settings.shadow_distance_m;
    side_texels_ = is_nested_ ? nested_side_of(settings.shadow_side_texels, view.frustum.focal_px, view.most_map_bytes)
                              : side_of(settings.shadow_side_texels, view.pixel_count);
    map_count_ = is_nested_ ? k_shadow_map_places : 1;
    if (map_bytes() >= view.refused_map_bytes) {
        clipmap_.forget();
        return drop();
    }
    if (is_nested_)
        list_nested(tiles, plants, geometry, grounds, view, settings, far_m);
    else
        list_warped(tiles, plants, geometry, grounds, view, settings, far_m);
}

// With the viewer's level of detail at twice its d', in the view's shift towards the sun.
void FrameCasters::list_warped(const TileList::Tiles& tiles, const TileList::Plants& plants,
                               const SceneGeometry& geometry, std::span<const Ground> grounds,
                               const View& view, const FrameSettings& settings, float far_m) {
    const Frustum& of = view.frustum;
    casters_[0].list(tiles, plants, geometry, grounds, make_caster_frustum(of, to_sun_, far_m),
                     view.camera_world, settings);
    // Sides of the picture, from its planes.
    const vec3 right = vec3(of.planes[1]), top = vec3(of.planes[3]);
    const float tangent_x = glm::dot(right, of.forward) / glm::dot(right, of.right);
    const float tangent_y = glm::dot(top, of.forward) / glm::dot(top, of.up);
    // Along the view, what lies at a distance is nearer. What is nearer still, as single leaves around the viewer are, is lit as without a
    // map: it would be finer there than leaves are bent.
    const float near_m = std::isfinite(view.nearest_m)
                             ? std::clamp(view.nearest_m * of.corner_cos, of.near_m, 0.5f * (of.near_m + far_m))
                             : of.near_m;
    seen_.push_back(fit_shadow(settings.shadows, {of.right, of.up, of.forward, tangent_x, tangent_y, near_m, far_m,
                                                  view.scene_bounds, view.scene_bounds, to_sun_, side_texels_}));
    drawn_.push_back({0, seen_[0], vec4(of.forward, of.corner_cos), 0.0f});
}

// As fine as the maps' texels, wherever the viewer is, so that a map shows the same whenever it is made.
void FrameCasters::list_nested(const TileList::Tiles& tiles, const TileList::Plants& plants,
                               const SceneGeometry& geometry, std::span<const Ground> grounds,
                               const View& view, const FrameSettings& settings, float far_m) {
    // Along the view a place is nearer than it is; off the axis as much farther as corners are.
    const float farthest_m = std::min(far_m / view.frustum.corner_cos, farthest(view.scene_bounds));
    clipmap_.update({view.camera_world, view.origin_world, view.motion_m, to_sun_, view.frustum.focal_px, 0.5f * view.nearest_m,
                     farthest_m, view.scene_bounds, side_texels_});
    FrameSettings of_maps = settings;
    of_maps.level_of_detail = true;
    of_maps.sample_distance_px = 1.0f;
    of_maps.line_sample_distance_px = 0.0f;
    for (uint32_t map : clipmap_.due()) {
        // At that distance 2 px are a texel.
        const float least_distance_m = Clipmap::texel_m(map) * view.frustum.focal_px / k_caster_coarseness;
        const uint32_t place = Clipmap::place_of(map);
        casters_[place].list(tiles, plants, geometry, grounds,
                             clipmap_.casters(map, view.frustum, view.camera_world, least_distance_m),
                             view.camera_world, of_maps);
        drawn_.push_back({place, clipmap_.view(map, view.camera_world), vec4(0.0f, 0.0f, 0.0f, 1.0f), least_distance_m});
    }
    for (uint32_t map = clipmap_.first(); map <= clipmap_.last(); ++map)
        seen_.push_back(clipmap_.view(map, view.camera_world));
}

void FrameCasters::drop() {
    side_texels_ = 0;
    drawn_.clear();
    seen_.clear();
    part_counts_.clear();
}

ShadowSettings FrameCasters::maps() const {
    ShadowSettings maps;
    maps.side_texels = side_texels_;
    maps.drawn = drawn_;
    maps.seen = seen_;
    maps.far_m = far_m_;
    if (!is_nested_) return maps;
    maps.first_map = Clipmap::place_of(clipmap_.first());
    maps.first_reach_m = Clipmap::reach_m(clipmap_.first(), side_texels_);
    maps.first_texel_m = Clipmap::texel_m(clipmap_.first());
    return maps;
}

void FrameCasters::see(const SceneGeometry& geometry) {
    part_counts_.clear();
    for (const ShadowMapDraw& draw : drawn_) {
        casters_[draw.map].see(geometry);
        part_counts_.push_back(casters_[draw.map].part_count());
    }
}

uint32_t FrameCasters::plant_count() const {
    uint32_t count = 0;
    for (const ShadowMapDraw& draw : drawn_) count += casters_[draw.map].plant_count();
    return count;
}

void FrameCasters::add_wishes(std::vector<TileWish>& wishes) const {
    // What only throws shadows comes behind what is seen.
    constexpr float k_caster_share = 0.25f;
    const uint32_t first = is_nested_ ? clipmap_.first() : 0, last = is_nested_ ? clipmap_.last() : 0;
    for (uint32_t map = first; any() && map <= last; ++map)
        for (TileWish wish : casters_[Clipmap::place_of(map)].wishes()) {
            wish.priority *= k_caster_share;
            wishes.push_back(wish);
        }
}

void FrameCasters::draw(const SceneGeometry& geometry, uint32_t rest_index, WorkList& work, size_t first_part) {
    // Where a ray to the sun enters the ground, the ground rises more than the ray.
    const float level_m = std::sqrt(to_sun_.x * to_sun_.x + to_sun_.z * to_sun_.z);
    const float rise = to_sun_.y > 0.0f ? to_sun_.y / std::max(level_m, 1e-6f) : 0.0f;
    for (size_t i = 0; i < drawn_.size(); ++i) {
        // Maps that stay are of no frame in particular.
        casters_[drawn_[i].map].draw(geometry, is_nested_ ? 0 : rest_index, rise, work, first_part);
        first_part += part_counts_[i];
    }
}

// One map counts as drawn at least, so that lists too short for all do not mean all in every frame.
void FrameCasters::commit(uint32_t whole_maps) {
    if (!is_nested_ || !any()) return;
    std::array<Clipmap::Drawn, k_most_work_maps> made{};
    const size_t count = std::min<size_t>(std::max(whole_maps, 1u), drawn_.size());
    for (size_t i = 0; i < count; ++i)
        made[i] = i >= whole_maps                             ? Clipmap::Drawn::cut
                  : casters_[drawn_[i].map].is_incomplete() ? Clipmap::Drawn::lacking_tiles
                                                              : Clipmap::Drawn::whole;
    clipmap_.commit(std::span(made).first(count));
}

}  // namespace coppice
