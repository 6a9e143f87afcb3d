#include "plugins/vegetation/draw/frame_casters.h"

#include <algorithm>
#include <cmath>
#include "plugins/vegetation/cull/caster_frustum.h"
#include "plugins/vegetation/cull/ground_level.h"

namespace coppice {
namespace {

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

float farthest_along(const Box& box, vec3 direction) {
    const vec3 corner(direction.x > 0.0f ? box.max.x : box.min.x, direction.y > 0.0f ? box.max.y : box.min.y,
                      direction.z > 0.0f ? box.max.z : box.min.z);
    return glm::dot(corner, direction);
}

}  // namespace

void FrameCasters::list(const TileList::Tiles& tiles, const TileList::Plants& plants,
                       const SceneGeometry& geometry, std::span<const Ground> grounds, const Frustum& view,
                       dvec3 camera_world, const Light& light, const FrameSettings& settings,
                       uint64_t pixel_count, uint32_t refused_side_texels, const Box& scene_bounds, float nearest_m) {
    const vec3 to_sun = normalize_or(light.direction_to_sun, vec3(0.0f));
    const bool has_sun = to_sun != vec3(0.0f) && light.sun_color != vec3(0.0f);
    const float far_m = std::min(settings.shadow_distance_m, farthest_along(scene_bounds, view.forward));
    const bool is_lit = settings.view == RepresentationView::lit;
    side_texels_ = settings.shadows != ShadowKind::none && is_lit && has_sun && far_m > view.near_m
                       ? side_of(settings.shadow_side_texels, pixel_count)
                       : 0;
    if (side_texels_ >= refused_side_texels) side_texels_ = 0;
    if (!any()) return;
    to_sun_ = to_sun;
    frustum_ = make_caster_frustum(view, to_sun, far_m);
    const FrameSettings of_casters = caster_settings(settings);
    spread_px_ = widest_spread_px(geometry.least_importance, geometry.most_line_width, of_casters);
    tiles_.list(tiles, plants, frustum_, camera_world,
                {of_casters.level_of_detail
                     ? of_casters.sample_distance_px / std::sqrt(of_casters.splat_factor)
                     : 0.0f,
                 vec3(0.0f), nullptr, spread_px_, 0.0f});
    grounds_.list(grounds, frustum_, camera_world, ground_error_px(settings));

    // Sides of the picture, from its planes.
    const vec3 right = vec3(view.planes[1]), top = vec3(view.planes[3]);
    const float tangent_x = glm::dot(right, view.forward) / glm::dot(right, view.right);
    const float tangent_y = glm::dot(top, view.forward) / glm::dot(top, view.up);
    // Along the view, what lies at a distance is nearer. What is nearer still, as single leaves around the viewer are, is lit as without a
    // map: it would be finer there than leaves are bent.
    const float near_m = std::isfinite(nearest_m)
                             ? std::clamp(nearest_m * view.corner_cos, view.near_m, 0.5f * (view.near_m + far_m))
                             : view.near_m;
    view_ = fit_shadow(settings.shadows, {view.right, view.up, view.forward, tangent_x, tangent_y, near_m, far_m,
                                          scene_bounds, scene_bounds, to_sun, side_texels_});
}

void FrameCasters::see(const SceneGeometry& geometry) {
    if (any()) plants_.see(tiles_, geometry, frustum_, nullptr, spread_px_);
}

uint32_t FrameCasters::plant_count() const {
    uint32_t visible = 0, hidden = 0;
    uint64_t triangles = 0;
    if (any()) plants_.count(visible, hidden, triangles);
    return visible;
}

void FrameCasters::draw(const SceneGeometry& geometry, const FrameSettings& settings, uint32_t rest_index,
                        WorkList& work, size_t first_part) {
    if (!any()) return;
    plants_.draw(tiles_, geometry, frustum_, caster_settings(settings), rest_index, work, first_part + 1);
    // Where a ray to the sun enters the ground, the ground rises more than the ray.
    const float level_m = std::sqrt(to_sun_.x * to_sun_.x + to_sun_.z * to_sun_.z);
    const float rise = to_sun_.y > 0.0f ? to_sun_.y / std::max(level_m, 1e-6f) : 0.0f;
    ground_expander_.expand(grounds_.in_view(), geometry, frustum_, ground_error_px(settings),
                            work.part(first_part), rise);
}

}  // namespace coppice
