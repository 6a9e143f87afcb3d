#include "plugins/vegetation/cook/triangle_areas.h"

#include "plugins/vegetation/cook/clean_mesh.h"
#include "runtime/core/jobs.h"

namespace coppice {

std::vector<double> triangle_areas(const PartDescription& part) {
    std::vector<double> areas(part.indices.size() / 3);
    parallel_for(areas.size(), 1 << 14, [&](size_t first, size_t last) {
        for (size_t t = first; t < last; ++t) {
            vec3 corner[3];
            for (size_t k = 0; k < 3; ++k) corner[k] = part.vertices[part.indices[3 * t + k]].position_plant;
            dvec3 n = doubled_area_vector(corner[0], corner[1], corner[2]);
            areas[t] = 0.5 * std::sqrt(glm::dot(n, n));
        }
    });
    return areas;
}

std::pair<double, vec3> measure_area_and_color(const PartDescription& part) {
    std::vector<double> areas = triangle_areas(part);
    dvec3 color(0);
    double area_m2 = 0.0;
    for (size_t t = 0; t < areas.size(); ++t) {
        area_m2 += areas[t];
        for (size_t k = 0; k < 3; ++k)
            color += dvec3(part.vertices[part.indices[3 * t + k]].color_linear) * (areas[t] / 3.0);
    }
    return {area_m2, vec3(color * (1.0 / area_m2))};
}

}  // namespace coppice
