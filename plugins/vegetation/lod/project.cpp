#include "plugins/vegetation/lod/project.h"

namespace coppice {

float projected_area_px2(const PackedPart& part, const PlantView& view, ProjectionMode mode) {
    float square = view.pixels_per_meter * view.pixels_per_meter;
    if (mode == ProjectionMode::measured)
        return part.projected_area_m2.evaluate(view.direction_plant) * square;
    return 0.5f * part.area_m2 * square;  // paper Eq. (1): mean |cos| = 1/2
}

float projected_length_px(const PackedPart& part, const PlantView& view, ProjectionMode mode) {
    if (mode == ProjectionMode::measured)
        return part.projected_length_m.evaluate(view.direction_plant) * view.pixels_per_meter;
    // paper Eq. (2) prints 1/2; the mean |sin| is pi/4 (ERRATA 2)
    float share = mode == ProjectionMode::printed ? 0.5f : k_pi / 4.0f;
    return share * part.line_length_m * view.pixels_per_meter;
}

PartProjection project_part(const PackedPart& part, const PlantView& view, const FrameSettings& settings) {
    const float per_meter = view.pixels_per_meter;
    if (part.kind == PackedPartKind::lines)
        return {per_meter, projected_area_px2(part, view, settings.projection),
                projected_length_px(part, view, settings.projection), view.direction_plant.y};
    if (settings.projection == ProjectionMode::measured && settings.weigh_by_facing)
        return {per_meter, mean_projected_area_m2(part) * (per_meter * per_meter), 0.0f,
                view.direction_plant.y};
    return {per_meter, projected_area_px2(part, view, settings.projection)};
}

}  // namespace coppice
