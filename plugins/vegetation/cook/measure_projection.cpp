#include "plugins/vegetation/cook/measure_projection.h"

#include <algorithm>
#include "plugins/vegetation/cook/clean_mesh.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

using Values = std::array<double, k_projection_direction_count>;

// Sums of many terms, in pieces of fixed size, so that neither rounding nor the number of threads matters.
template <class AddItem>
Values sum_over(size_t count, AddItem&& add_item) {
    constexpr size_t k_grain = 1 << 12;
    std::vector<Values> pieces((count + k_grain - 1) / k_grain, Values{});
    parallel_for(count, k_grain, [&](size_t first, size_t last) {
        Values& piece = pieces[first / k_grain];
        for (size_t i = first; i < last; ++i) add_item(i, piece);
    });
    Values sum{};
    for (const Values& piece : pieces)
        for (size_t d = 0; d < sum.size(); ++d) sum[d] += piece[d];
    return sum;
}

// Gaussian elimination with pivoting; a direction without weight stays zero.
std::array<double, 6> solve(std::array<std::array<double, 7>, 6> rows) {
    for (size_t column = 0; column < 6; ++column) {
        size_t pivot = column;
        for (size_t r = column + 1; r < 6; ++r)
            if (std::fabs(rows[r][column]) > std::fabs(rows[pivot][column])) pivot = r;
        std::swap(rows[column], rows[pivot]);
        if (!(std::fabs(rows[column][column]) > 1e-300)) continue;
        for (size_t r = 0; r < 6; ++r) {
            if (r == column) continue;
            double factor = rows[r][column] / rows[column][column];
            for (size_t c = column; c < 7; ++c) rows[r][c] -= factor * rows[column][c];
        }
    }
    std::array<double, 6> x{};
    for (size_t i = 0; i < 6; ++i)
        if (std::fabs(rows[i][i]) > 1e-300) x[i] = rows[i][6] / rows[i][i];
    return x;
}

}  // namespace

const std::array<vec3, k_projection_direction_count>& projection_directions() {
    static const auto directions = [] {
        std::array<vec3, k_projection_direction_count> d;
        for (int i = 0; i < k_projection_direction_count; ++i) {
            float y = (float(i) + 0.5f) / float(k_projection_direction_count);
            float around = float(i) * 2.39996323f, r = std::sqrt(1.0f - y * y);
            d[size_t(i)] = vec3(r * portable_cos(around), y, r * portable_sin(around));
        }
        return d;
    }();
    return directions;
}

Values projected_areas_m2(const PartDescription& part, bool closed) {
    const auto& directions = projection_directions();
    Values areas = sum_over(part.indices.size() / 3, [&](size_t t, Values& sum) {
        vec3 corner[3];
        for (size_t k = 0; k < 3; ++k) corner[k] = part.vertices[part.indices[3 * t + k]].position_plant;
        vec3 n = vec3(doubled_area_vector(corner[0], corner[1], corner[2]) * 0.5);
        for (size_t d = 0; d < sum.size(); ++d) sum[d] += double(std::fabs(glm::dot(n, directions[d])));
    });
    if (closed)
        for (double& area : areas) area *= 0.5;
    return areas;
}

Values projected_lengths_m(std::span<const vec3> line_ends_plant) {
    const auto& directions = projection_directions();
    return sum_over(line_ends_plant.size() / 2, [&](size_t i, Values& sum) {
        vec3 along = line_ends_plant[2 * i + 1] - line_ends_plant[2 * i];
        for (size_t d = 0; d < sum.size(); ++d) {
            vec3 across = along - directions[d] * glm::dot(along, directions[d]);
            sum[d] += double(std::sqrt(glm::dot(across, across)));
        }
    });
}

DirectionForm fit_direction_form(const Values& values) {
    const auto& directions = projection_directions();
    double mean = 0.0;
    for (double v : values) mean += v / double(values.size());
    DirectionForm form;
    if (!(mean > 0.0)) return form;
    // In squares the problem is linear: (d^T M d - v^2), weighted by 1 / 2v, is the error of v to first
    // order. The floor keeps directions in which nothing is seen from ruling the fit.
    std::array<std::array<double, 7>, 6> normal_equations{};
    for (size_t i = 0; i < values.size(); ++i) {
        dvec3 d(directions[i]);
        double row[6] = {d.x * d.x, d.y * d.y, d.z * d.z, 2 * d.x * d.y, 2 * d.x * d.z, 2 * d.y * d.z};
        double v = values[i] / mean, floor = std::max(v, 0.1), weight = 1.0 / (floor * floor);
        for (size_t r = 0; r < 6; ++r) {
            for (size_t c = 0; c < 6; ++c) normal_equations[r][c] += weight * row[r] * row[c];
            normal_equations[r][6] += weight * row[r] * v * v;
        }
    }
    std::array<double, 6> m = solve(normal_equations);
    for (size_t k = 0; k < 6; ++k) form.m[k] = float(m[k]);
    double fitted_mean = 0.0;
    for (vec3 d : directions) fitted_mean += double(form.evaluate(d)) / double(values.size());
    double scale = fitted_mean > 0.0 ? mean / fitted_mean : 0.0;
    for (size_t k = 0; k < 6; ++k) form.m[k] = float(m[k] * scale * scale);
    return form;
}

}  // namespace coppice
