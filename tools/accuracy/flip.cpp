// Four stages: opponent colours; what the eye resolves of them; colour and feature differences; their combination.
// The first runs over the pictures, the others together row by row. All filters are separable, the blue-yellow one as
// a sum of two.
#include "tools/accuracy/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include "runtime/core/jobs.h"
#include "runtime/core/math.h"
#include "tools/accuracy/check_pictures.h"
#include "tools/accuracy/flip_filters.h"

namespace coppice {
namespace {

constexpr float k_color_exponent = 0.7f;     // q_c
constexpr float k_color_knee = 0.4f;         // p_c: share of the largest colour difference ...
constexpr float k_color_knee_error = 0.95f;  // p_t: ... that is already this much error
constexpr float k_min_pixels_per_degree = 1.0f, k_max_pixels_per_degree = 1000.0f;

// XYZ of linear sRGB (primaries and white of IEC 61966-2-1), each over white's.
glm::dmat3 rgb_to_relative_xyz() {
    glm::dmat3 rows(0.41239080, 0.35758434, 0.18048079,   // X
                    0.21263901, 0.71516868, 0.07219232,   // Y
                    0.01933082, 0.11919478, 0.95053215);  // Z
    for (int row = 0; row < 3; ++row) rows[row] /= rows[row].x + rows[row].y + rows[row].z;
    return glm::transpose(rows);
}

struct Conversion {
    mat3 to_xyz = mat3(rgb_to_relative_xyz()), to_rgb = mat3(glm::inverse(rgb_to_relative_xyz()));
};

float clamp_to_unit(float x) { return x > 0.0f ? std::min(x, 1.0f) : 0.0f; }  // not a number: 0

float lab_curve(float t) {
    constexpr float k_knee = 216.0f / 24389.0f;  // (6/29)^3
    return t > k_knee ? std::cbrt(t) : t * (841.0f / 108.0f) + 4.0f / 29.0f;
}

// L, a, b; a and b weaker in the dark, as Hunt found them to be.
vec3 hunt_lab(vec3 relative_xyz) {
    const float x = lab_curve(relative_xyz.x), y = lab_curve(relative_xyz.y), z = lab_curve(relative_xyz.z);
    const float lightness = 116.0f * y - 16.0f, hunt = 0.01f * lightness;
    return {lightness, hunt * 500.0f * (x - y), hunt * 200.0f * (y - z)};
}

float color_distance(vec3 a, vec3 b) {
    const vec3 d = a - b;
    return std::pow(std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z), k_color_exponent);
}

// Y, Cx and Cz without their scales and offset, which weights that add up to 1 hand through: Y / Yn, the paper's
// (Y + 16) / 116; X / Xn - Y / Yn; Y / Yn - Z / Zn.
struct Opponent {
    uint32_t width, height;
    std::vector<float> achromatic, red_green, blue_yellow;
};

Opponent to_opponent(const FloatPicture& picture, const Conversion& conversion) {
    const std::vector<float> plane(size_t(picture.width) * picture.height);
    Opponent opponent{picture.width, picture.height, plane, plane, plane};
    parallel_for(picture.height, 16, [&](size_t first, size_t last) {
        for (size_t y = first; y < last; ++y)
            for (size_t x = 0; x < picture.width; ++x) {
                const size_t i = y * picture.width + x;
                const float* rgb = &picture.rgb[i * 3];
                const vec3 xyz = conversion.to_xyz *
                                 vec3(clamp_to_unit(rgb[0]), clamp_to_unit(rgb[1]), clamp_to_unit(rgb[2]));
                opponent.achromatic[i] = xyz.y;
                opponent.red_green[i] = xyz.x - xyz.y;
                opponent.blue_yellow[i] = xyz.y - xyz.z;
            }
    });
    return opponent;
}

// out[0, count) += sum of weights[k] row_of(k)[0, count). Four taps at a time: fewer passes over out, and a loop that
// compilers make vectors of.
template <class RowOf>
void add_weighted(const FlipKernel& kernel, RowOf&& row_of, uint32_t count, float* out) {
    const size_t taps = kernel.weights.size();
    for (size_t k = 0; k < taps; k += 4) {
        std::array<const float*, 4> in;
        std::array<float, 4> weight;
        for (size_t i = 0; i < 4; ++i) {
            in[i] = row_of(std::min(k + i, taps - 1));
            weight[i] = k + i < taps ? kernel.weights[k + i] : 0.0f;
        }
        for (uint32_t x = 0; x < count; ++x)
            out[x] +=
                (weight[0] * in[0][x] + weight[1] * in[1][x]) + (weight[2] * in[2][x] + weight[3] * in[3][x]);
    }
}

// One row of one picture, filtered.
class RowFilter {
  public:
    RowFilter(const FlipFilters& filters, const Opponent& picture)
        : filters_(filters), picture_(picture), column_(picture.width + 2 * filters.largest_radius) {}

    void run(uint32_t y) {
        filter_each(filters_.achromatic, picture_.achromatic, y, achromatic);
        filter_each(filters_.red_green, picture_.red_green, y, red_green);
        filter_each(filters_.blue_yellow, picture_.blue_yellow, y, blue_yellow);
        std::array<std::vector<float>*, 4> slopes{&edge_x_, &edge_y_, &point_x_, &point_y_};
        for (std::vector<float>* slope : slopes) slope->assign(picture_.width, 0.0f);
        filter_down(filters_.smooth, picture_.achromatic, y);
        filter_across(filters_.edge, edge_x_);
        filter_across(filters_.point, point_x_);
        filter_down(filters_.edge, picture_.achromatic, y);
        filter_across(filters_.smooth, edge_y_);
        filter_down(filters_.point, picture_.achromatic, y);
        filter_across(filters_.smooth, point_y_);
        edge.resize(picture_.width);
        point.resize(picture_.width);
        for (uint32_t x = 0; x < picture_.width; ++x) {
            edge[x] = std::sqrt(edge_x_[x] * edge_x_[x] + edge_y_[x] * edge_y_[x]);
            point[x] = std::sqrt(point_x_[x] * point_x_[x] + point_y_[x] * point_y_[x]);
        }
    }

    std::vector<float> achromatic, red_green, blue_yellow;  // as the eye resolves them
    std::vector<float> edge, point;                         // magnitudes

  private:
    void filter_each(const std::vector<FlipKernel>& kernels, const std::vector<float>& plane, uint32_t y,
                     std::vector<float>& out) {
        out.assign(picture_.width, 0.0f);
        for (const FlipKernel& kernel : kernels) {
            filter_down(kernel, plane, y);
            filter_across(kernel, out);
        }
    }
    // Into column_, with what lies beyond the borders: the nearest pixel.
    void filter_down(const FlipKernel& kernel, const std::vector<float>& plane, uint32_t y) {
        const int64_t top = int64_t(y) - kernel.radius(), last_row = int64_t(picture_.height) - 1;
        std::fill(column_.begin(), column_.end(), 0.0f);
        float* first = column_.data() + filters_.largest_radius;
        auto row_of = [&](size_t k) {
            return plane.data() + size_t(std::clamp<int64_t>(top + int64_t(k), 0, last_row)) * picture_.width;
        };
        add_weighted(kernel, row_of, picture_.width, first);
        std::fill(column_.data(), first, first[0]);
        std::fill(first + picture_.width, column_.data() + column_.size(), first[picture_.width - 1]);
    }
    void filter_across(const FlipKernel& kernel, std::vector<float>& out) {
        const float* first = column_.data() + filters_.largest_radius - kernel.radius();
        add_weighted(
            kernel, [&](size_t k) { return first + k; }, picture_.width, out.data());
    }

    const FlipFilters& filters_;
    const Opponent& picture_;
    std::vector<float> column_, edge_x_, edge_y_, point_x_, point_y_;
};

vec3 seen_color(const RowFilter& row, uint32_t x, const Conversion& conversion) {
    const float y = row.achromatic[x];
    const vec3 rgb = conversion.to_rgb * vec3(y + row.red_green[x], y, y - row.blue_yellow[x]);
    return hunt_lab(conversion.to_xyz *
                    vec3(clamp_to_unit(rgb.x), clamp_to_unit(rgb.y), clamp_to_unit(rgb.z)));
}

// largest: between green and blue, the two colours of a screen that are farthest apart.
float color_error(float distance, float largest) {
    const float knee = k_color_knee * largest;
    if (distance < knee) return distance * (k_color_knee_error / knee);
    return k_color_knee_error + (distance - knee) / (largest - knee) * (1.0f - k_color_knee_error);
}

float feature_error(const RowFilter& a, const RowFilter& b, uint32_t x) {
    const float difference = std::max(std::abs(a.edge[x] - b.edge[x]), std::abs(a.point[x] - b.point[x]));
    return std::sqrt(std::min(difference * 0.70710678f, 1.0f));  // q_f = 1/2
}

}  // namespace

Result<std::vector<float>> flip_map(const FloatPicture& a, const FloatPicture& b, float pixels_per_degree) {
    COPPICE_CHECK(check_same_size(a, b));
    if (!(pixels_per_degree >= k_min_pixels_per_degree && pixels_per_degree <= k_max_pixels_per_degree))
        return fail(ErrorId::value_out_of_range, "", "",
                    std::to_string(pixels_per_degree) + " pixels a degree", "from 1 to 1000");
    const Conversion conversion;
    const FlipFilters filters = make_flip_filters(double(pixels_per_degree));
    const Opponent opponent_a = to_opponent(a, conversion), opponent_b = to_opponent(b, conversion);
    const float largest = color_distance(hunt_lab(conversion.to_xyz * vec3(0.0f, 1.0f, 0.0f)),
                                         hunt_lab(conversion.to_xyz * vec3(0.0f, 0.0f, 1.0f)));
    std::vector<float> map(size_t(a.width) * a.height);
    parallel_for(a.height, 8, [&](size_t first, size_t last) {
        RowFilter row_a(filters, opponent_a), row_b(filters, opponent_b);
        for (size_t y = first; y < last; ++y) {
            row_a.run(uint32_t(y));
            row_b.run(uint32_t(y));
            for (uint32_t x = 0; x < a.width; ++x) {
                const float distance =
                    color_distance(seen_color(row_a, x, conversion), seen_color(row_b, x, conversion));
                const float color = std::min(color_error(distance, largest), 1.0f);
                map[y * a.width + x] = std::min(std::pow(color, 1.0f - feature_error(row_a, row_b, x)), 1.0f);
            }
        }
    });
    return map;
}

}  // namespace coppice
