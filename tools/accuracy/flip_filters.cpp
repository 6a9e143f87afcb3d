#include "tools/accuracy/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace coppice {
namespace {

constexpr double k_pi_squared = 9.8696044010893586;
constexpr double k_feature_width_degrees = 0.082;  // w: of an edge as the eye sees it

FlipKernel kernel_of(const std::vector<double>& weights) { return {{weights.begin(), weights.end()}}; }

struct Gaussian {
    double a, b;  // a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees
};
constexpr Gaussian k_achromatic[] = {{1.0, 0.0047}};
constexpr Gaussian k_red_green[] = {{1.0, 0.0053}};
constexpr Gaussian k_blue_yellow[] = {{34.1, 0.04}, {13.5, 0.025}};
constexpr double k_widest_b = 0.04;

// A kernel a Gaussian, so scaled that the sum of their squares in two dimensions weighs 1 in all.
std::vector<FlipKernel> make_contrast_sensitivity(std::span<const Gaussian> gaussians,
                                                  double pixels_per_degree) {
    const int full_radius =
        int(std::ceil(3.0 * std::sqrt(k_widest_b / (2.0 * k_pi_squared)) * pixels_per_degree));
    std::vector<std::vector<double>> lines;
    double total = 0.0;
    for (const Gaussian& gaussian : gaussians) {
        const double height = std::sqrt(gaussian.a * std::sqrt(std::sqrt(k_pi_squared) / gaussian.b));
        double sum = 0.0;
        std::vector<double> line;
        for (int i = -full_radius; i <= full_radius; ++i) {
            const double x = i / pixels_per_degree;
            line.push_back(height * std::exp(-k_pi_squared * x * x / gaussian.b));
            sum += line.back();
        }
        total += sum * sum;
        // The radius is that of the widest. What no float can add costs only time.
        while (line.size() > 1 && line.back() < 1e-10 * height) {
            line.pop_back();
            line.erase(line.begin());
        }
        lines.push_back(std::move(line));
    }
    std::vector<FlipKernel> kernels;
    for (std::vector<double>& line : lines) {
        for (double& weight : line) weight /= std::sqrt(total);
        kernels.push_back(kernel_of(line));
    }
    return kernels;
}

// Positive weights to a sum of 1, negative ones to -1, each on its own.
FlipKernel normalize_by_sign(std::vector<double> weights) {
    double positive = 0.0, negative = 0.0;
    for (double weight : weights) (weight > 0.0 ? positive : negative) += weight;
    for (double& weight : weights)
        if (weight != 0.0) weight /= weight > 0.0 ? positive : -negative;
    return kernel_of(weights);
}

}  // namespace

FlipFilters make_flip_filters(double pixels_per_degree) {
    FlipFilters filters;
    filters.achromatic = make_contrast_sensitivity(k_achromatic, pixels_per_degree);
    filters.red_green = make_contrast_sensitivity(k_red_green, pixels_per_degree);
    filters.blue_yellow = make_contrast_sensitivity(k_blue_yellow, pixels_per_degree);
    const double sigma = 0.5 * k_feature_width_degrees * pixels_per_degree;
    const int radius = int(std::ceil(3.0 * sigma));
    std::vector<double> smooth, edge, point;
    for (int x = -radius; x <= radius; ++x) {
        const double gaussian = std::exp(-x * x / (2.0 * sigma * sigma));
        smooth.push_back(gaussian);
        edge.push_back(-x * gaussian);
        point.push_back((x * x / (sigma * sigma) - 1.0) * gaussian);
    }
    filters.smooth = normalize_by_sign(smooth);
    filters.edge = normalize_by_sign(edge);
    filters.point = normalize_by_sign(point);
    filters.largest_radius = uint32_t(radius);
    for (const auto* kernels : {&filters.achromatic, &filters.red_green, &filters.blue_yellow})
        for (const FlipKernel& kernel : *kernels)
            filters.largest_radius = std::max(filters.largest_radius, kernel.radius());
    return filters;
}

}  // namespace coppice
