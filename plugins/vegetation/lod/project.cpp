#include "plugins/vegetation/lod/project.h"

#include "runtime/core/vector_clones.h"

namespace coppice {
namespace {

// Whether what asks for points is the mean over all directions.
bool is_mean(const PackedPart& part, const FrameSettings& settings) {
    return part.kind == PackedPartKind::points && settings.projection == ProjectionMode::measured &&
           settings.weigh_by_facing;
}

float unmeasured_area_m2(const PackedPart& part) {
    return 0.5f * part.area_m2;  // paper Eq. (1): mean |cos| = 1/2
}

float unmeasured_length_m(const PackedPart& part, ProjectionMode mode) {
    // paper Eq. (2) prints 1/2; the mean |sin| is pi/4 (ERRATA 2)
    return (mode == ProjectionMode::printed ? 0.5f : k_pi / 4.0f) * part.line_length_m;
}

// A length a metre, or an area a square metre, in pixels.
COPPICE_VECTOR_CLONES
void to_pixels(float of_one, bool is_area, const PlantViews& views, float* out) {
    const float* per_meter = views.pixels_per_meter.data();
    for (size_t i = 0; i < views.size(); ++i)
        out[i] = of_one * (is_area ? per_meter[i] * per_meter[i] : per_meter[i]);
}

COPPICE_VECTOR_CLONES
void to_pixels(const DirectionForm& form, bool is_area, const PlantViews& views, float* out) {
    const DirectionForm local = form;
    const float *x = views.direction_x.data(), *y = views.direction_y.data(), *z = views.direction_z.data();
    const float* per_meter = views.pixels_per_meter.data();
    for (size_t i = 0; i < views.size(); ++i)
        out[i] =
            local.evaluate(vec3(x[i], y[i], z[i])) * (is_area ? per_meter[i] * per_meter[i] : per_meter[i]);
}

}  // namespace

float projected_area_px2(const PackedPart& part, const PlantView& view, ProjectionMode mode) {
    const float of_one = mode == ProjectionMode::measured
                             ? part.projected_area_m2.evaluate(view.direction_plant)
                             : unmeasured_area_m2(part);
    return of_one * (view.pixels_per_meter * view.pixels_per_meter);
}

float projected_length_px(const PackedPart& part, const PlantView& view, ProjectionMode mode) {
    const float of_one = mode == ProjectionMode::measured
                             ? part.projected_length_m.evaluate(view.direction_plant)
                             : unmeasured_length_m(part, mode);
    return of_one * view.pixels_per_meter;
}

PartProjection project_part(const PackedPart& part, const PlantView& view, const FrameSettings& settings) {
    const float per_meter = view.pixels_per_meter;
    PartProjection projection{per_meter};
    projection.area_px2 = is_mean(part, settings) ? mean_projected_area_m2(part) * (per_meter * per_meter)
                                                  : projected_area_px2(part, view, settings.projection);
    if (part.kind == PackedPartKind::lines)
        projection.length_px = projected_length_px(part, view, settings.projection);
    projection.height = view.direction_plant.y;
    return projection;
}

void project_parts(const PackedPart& part, const PlantViews& views, const FrameSettings& settings,
                   PartColumns& out) {
    const bool measured = settings.projection == ProjectionMode::measured;
    if (is_mean(part, settings))
        to_pixels(mean_projected_area_m2(part), true, views, out.area_px2.data());
    else if (measured)
        to_pixels(part.projected_area_m2, true, views, out.area_px2.data());
    else
        to_pixels(unmeasured_area_m2(part), true, views, out.area_px2.data());
    if (part.kind != PackedPartKind::lines) return;
    if (measured)
        to_pixels(part.projected_length_m, false, views, out.length_px.data());
    else
        to_pixels(unmeasured_length_m(part, settings.projection), false, views, out.length_px.data());
}

}  // namespace coppice
