#include "plugins/vegetation/plant/direction_form.h"

#include <algorithm>

namespace coppice {
namespace {

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

DirectionForm fit_direction_form(const DirectionValues& values) {
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

double mean_over_directions(const DirectionForm& form) {
    double sum = 0.0;
    for (vec3 d : projection_directions()) sum += double(form.evaluate(d));
    return sum / double(k_projection_direction_count);
}

}  // namespace coppice
