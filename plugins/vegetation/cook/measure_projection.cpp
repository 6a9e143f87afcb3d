#include "plugins/vegetation/cook/measure_projection.h"

#include "plugins/vegetation/cook/clean_mesh.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

// Sums of many terms, in pieces of fixed size, so that neither rounding nor the number of threads matters.
template <class AddItem>
DirectionValues sum_over(size_t count, AddItem&& add_item) {
    constexpr size_t k_grain = 1 << 12;
    std::vector<DirectionValues> pieces((count + k_grain - 1) / k_grain, DirectionValues{});
    parallel_for(count, k_grain, [&](size_t first, size_t last) {
        DirectionValues& piece = pieces[first / k_grain];
        for (size_t i = first; i < last; ++i) add_item(i, piece);
    });
    DirectionValues sum{};
    for (const DirectionValues& piece : pieces)
        for (size_t d = 0; d < sum.size(); ++d) sum[d] += piece[d];
    return sum;
}

}  // namespace

DirectionValues projected_areas_m2(const PartDescription& part, bool closed) {
    const auto& directions = projection_directions();
    DirectionValues areas = sum_over(part.indices.size() / 3, [&](size_t t, DirectionValues& sum) {
        vec3 corner[3];
        for (size_t k = 0; k < 3; ++k) corner[k] = part.vertices[part.indices[3 * t + k]].position_plant;
        vec3 n = vec3(doubled_area_vector(corner[0], corner[1], corner[2]) * 0.5);
        for (size_t d = 0; d < sum.size(); ++d) sum[d] += double(std::fabs(glm::dot(n, directions[d])));
    });
    if (closed)
        for (double& area : areas) area *= 0.5;
    return areas;
}

DirectionValues projected_lengths_m(std::span<const vec3> line_ends_plant) {
    const auto& directions = projection_directions();
    return sum_over(line_ends_plant.size() / 2, [&](size_t i, DirectionValues& sum) {
        vec3 along = line_ends_plant[2 * i + 1] - line_ends_plant[2 * i];
        for (size_t d = 0; d < sum.size(); ++d) {
            vec3 across = along - directions[d] * glm::dot(along, directions[d]);
            sum[d] += double(std::sqrt(glm::dot(across, across)));
        }
    });
}

}  // namespace coppice
