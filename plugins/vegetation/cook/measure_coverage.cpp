#include "plugins/vegetation/cook/measure_coverage.h"

#include <algorithm>
#include <bit>
#include "plugins/vegetation/cook/coverage_raster.h"
#include "plugins/vegetation/plant/line_points.h"
#include "plugins/vegetation/plant/point_run.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr uint32_t k_truth_side = 640, k_truth_views = 120;
constexpr float k_largest_side = 2048.0f;
// Of a level, over all its views.
constexpr double k_wanted_pixels = 100000.0, k_primitive_budget = 3.0e6;
constexpr double k_least_views = 24.0, k_most_views = 65536.0;
constexpr double k_least_pixels = 300.0;  // of a part, in the views of a band: less says nothing
constexpr double k_least_seen_px2 = 0.4;  // of the plant: below, hardly any two points meet
constexpr int k_rounds = 4;
constexpr size_t k_jobs = 16;  // of a level
constexpr float k_least_gain = 1.0f / 16.0f, k_largest_gain = 4.0f;

// Views from the side, from higher up and from above: by the sine of their height, in which directions are even.
constexpr size_t k_bands = 3;
constexpr std::array<float, k_bands + 1> k_band_begin{0.0f, 0.5f, 0.85f, 1.0f};
using Bands = std::array<double, k_bands>;

double share_of(size_t band) { return double(k_band_begin[band + 1] - k_band_begin[band]); }
double mean_of(const Bands& bands) {
    double mean = 0.0;
    for (size_t band = 0; band < k_bands; ++band) mean += share_of(band) * bands[band];
    return mean;
}

struct View {
    vec3 right, up, direction;
    size_t band;
    vec2 shift;
};

// As many of each band, well spread.
View view_of(uint32_t index, uint32_t count) {
    View view;
    view.band = index % k_bands;
    const float low = k_band_begin[view.band], high = k_band_begin[view.band + 1];
    const float height =
        low + (high - low) * (float(index / k_bands) + 0.5f) / float((count + k_bands - 1) / k_bands);
    const float around = 2.0f * k_pi * 0.61803399f * float(index), level = std::sqrt(1.0f - height * height);
    view.direction = vec3(-level * portable_cos(around), -height, -level * portable_sin(around));
    view.right = perpendicular_to(view.direction);
    view.up = glm::cross(view.right, view.direction);
    Random random(17, index);
    view.shift.x = random.next_unit();  // one after the other: arguments of a call have no order
    view.shift.y = random.next_unit();
    return view;
}

// What a part is drawn with from each band of directions; as plant.h keeps it: a mean, and how it goes with height.
struct Gain {
    Bands of_band{1.0, 1.0, 1.0};

    float mean() const { return float(mean_of(of_band)); }
    // The two of which the means over the bands are of_band. The mean over all is right by itself.
    HeightGain by_height() const {
        auto second = [](size_t band) {  // integral of P_2
            auto upto = [](double x) { return 0.5 * x * (x * x - 1.0); };
            return (upto(double(k_band_begin[band + 1])) - upto(double(k_band_begin[band]))) / share_of(band);
        };
        auto fourth = [](size_t band) {
            auto upto = [](double x) { return x * (0.875 * x * x * x * x - 1.25 * x * x + 0.375); };
            return (upto(double(k_band_begin[band + 1])) - upto(double(k_band_begin[band]))) / share_of(band);
        };
        const double low = of_band[0] / mean_of(of_band) - 1.0, high = of_band[2] / mean_of(of_band) - 1.0;
        const double a = second(0), b = fourth(0), c = second(2), d = fourth(2), determinant = a * d - b * c;
        return {float((low * d - b * high) / determinant), float((a * high - low * c) / determinant)};
    }
};

struct Part {
    const PlantBlocks* blocks;
    const PackedPart* packed;
    bool lines;
    float area_m2, length_m;  // in the mean over directions
    float top_density;        // where the table of gains ends, in square pixels a square metre
    std::vector<LinePoint> line_points;
    Bands seen_m2{};  // of the triangles
    Bands limit{};    // the gain where points do not meet
};

class PlantCoverage {
  public:
    explicit PlantCoverage(std::span<const PlantBlocks> plant) {
        for (const PlantBlocks& blocks : plant) {
            const PackedPart& packed = blocks.parts[0];
            Part part{&blocks,
                      &packed,
                      packed.kind == PackedPartKind::lines,
                      mean_projected_area_m2(packed),
                      mean_projected_length_m(packed),
                      0.0f,
                      {},
                      {},
                      {}};
            const float fill_m = part.lines ? part.length_m / part.area_m2 : 0.0f;
            part.top_density = part.lines ? fill_m * fill_m : float(packed.point_count) / part.area_m2;
            for (uint32_t i = 0; i < line_point_count(packed); ++i)
                part.line_points.push_back(line_point(packed, blocks.line_vertices, i));
            part.top_density = std::max(part.top_density, 1.0e-12f);  // of a part that has no points or lines
            parts_.push_back(std::move(part));
            bounds_.include(blocks.bounds_plant);
        }
        radius_m_ = 0.5f * glm::length(bounds_.size());
        measure_seen();
        for (Part& part : parts_) find_limit(part);
    }

    // Finest first; densities fall by half from one to the next, and the last one is where points no longer meet.
    void measure() {
        double seen_m2 = 0.0;
        float top_density = 0.0f;
        for (const Part& part : parts_) {
            seen_m2 += mean_of(part.seen_m2);
            top_density = std::max(top_density, part.top_density);
        }
        const float most_per_meter = 0.5f * (k_largest_side - 6.0f) / std::max(radius_m_, 1.0e-6f);
        top_density_ = std::min(top_density, most_per_meter * most_per_meter);
        size_t count = 1;
        for (double seen_px2 = seen_m2 * double(top_density_); seen_px2 >= k_least_seen_px2; seen_px2 *= 0.5)
            ++count;
        levels_.assign(count, std::vector<Gain>(parts_.size()));
        for (size_t p = 0; p < parts_.size(); ++p) levels_.back()[p].of_band = parts_[p].limit;
        for (size_t level = count - 1; level-- > 0;) {
            levels_[level] = levels_[level + 1];
            measure_level(top_density_ * portable_exp2(-float(level)), levels_[level]);
        }
    }

    void tell(size_t index, PackedPart& packed) const {
        const Part& part = parts_[index];
        for (uint32_t level = 0; level < k_gain_levels; ++level) {
            const float octave = float(k_gain_levels - 1 - level) * (part.lines ? 2.0f : 1.0f);
            const float at = std::clamp(portable_log2(top_density_ / part.top_density) + octave, 0.0f,
                                        float(levels_.size() - 1));
            const size_t before = std::min(size_t(at), levels_.size() - 1),
                         behind = std::min(before + 1, levels_.size() - 1);
            const float share = at - float(before);
            const Gain &a = levels_[before][index], &b = levels_[behind][index];
            const float gain = a.mean() + (b.mean() - a.mean()) * share;
            packed.coverage_gain[level] = std::clamp(gain, k_least_gain, k_largest_gain);
            if (level % 2 == 0) continue;
            const HeightGain low = a.by_height(), high = b.by_height();
            packed.height_gain[level / 2] =
                round_height_gain({low.second + (high.second - low.second) * share,
                                   low.fourth + (high.fourth - low.fourth) * share});
        }
    }

  private:
    vec3 place(const View& view, const PackedVertex& v, float pixels_per_meter, float side) const {
        const vec3 p = vec3(v.x_plant, v.y_plant, v.z_plant) - bounds_.center();
        return {glm::dot(view.right, p) * pixels_per_meter + view.shift.x + 0.5f * side,
                glm::dot(view.up, p) * pixels_per_meter + view.shift.y + 0.5f * side,
                glm::dot(view.direction, p)};
    }
    void draw_triangles(CoverageRaster& raster, const Part& part, const View& view, float pixels_per_meter,
                        float side) const {
        const std::vector<PackedVertex>& vertices = part.blocks->triangle_vertices;
        for (size_t i = 0; i + 2 < vertices.size(); i += 3)
            raster.triangle(place(view, vertices[i], pixels_per_meter, side),
                            place(view, vertices[i + 1], pixels_per_meter, side),
                            place(view, vertices[i + 2], pixels_per_meter, side));
    }

    // Pixels that show each part, over all views of each band.
    template <class Draw>
    std::vector<Bands> count_seen(uint32_t side, uint32_t views, Draw&& draw) const {
        const size_t jobs = std::min<size_t>(k_jobs, views);
        std::vector<std::vector<Bands>> of_job(jobs);
        parallel_for(jobs, 1, [&](size_t first, size_t last) {
            for (size_t job = first; job < last; ++job) {
                of_job[job].resize(parts_.size());
                CoverageRaster raster(side, uint32_t(parts_.size()));
                for (size_t i = views * job / jobs; i < views * (job + 1) / jobs; ++i) {
                    const View view = view_of(uint32_t(i), views);
                    raster.begin();
                    draw(raster, view, uint32_t(i));
                    for (size_t p = 0; p < parts_.size(); ++p)
                        of_job[job][p][view.band] += double(raster.seen()[p]);
                }
            }
        });
        std::vector<Bands> sum(parts_.size());
        for (const std::vector<Bands>& seen : of_job)
            for (size_t p = 0; p < parts_.size(); ++p)
                for (size_t band = 0; band < k_bands; ++band) sum[p][band] += seen[p][band];
        return sum;
    }

    // In the mean over places of the pixel grid a picture of any resolution shows the same share.
    void measure_seen() {
        const float side = float(k_truth_side),
                    pixels_per_meter = 0.5f * (side - 4.0f) / std::max(radius_m_, 1.0e-6f);
        const std::vector<Bands> seen =
            count_seen(k_truth_side, k_truth_views, [&](CoverageRaster& raster, const View& view, uint32_t) {
                for (size_t p = 0; p < parts_.size(); ++p) {
                    raster.set_part(uint32_t(p));
                    draw_triangles(raster, parts_[p], view, pixels_per_meter, side);
                }
            });
        const double to_m2 =
            double(k_bands) / k_truth_views / (double(pixels_per_meter) * double(pixels_per_meter));
        for (size_t p = 0; p < parts_.size(); ++p)
            for (size_t band = 0; band < k_bands; ++band) parts_[p].seen_m2[band] = seen[p][band] * to_m2;
    }

    static float facing_of(const PackedVertex& vertex, vec3 direction) {
        return std::fabs(glm::dot(decode_surface(vertex.surface).normal, direction));
    }

    void find_limit(Part& part) const {
        Bands drawn_m2{};
        for (uint32_t i = 0; i < k_truth_views; ++i) {
            const View view = view_of(i, k_truth_views);
            double facing = 0.0, count = 0.0;
            auto add = [&](const PackedVertex& vertex, float share) {
                facing += 2.0 * double(facing_of(vertex, view.direction) * share);
                count += 1.0;
            };
            for (const LinePoint& point : part.line_points) add(point.vertex, point.width_share);
            const uint32_t points = part.packed->point_count;
            for (uint32_t k = 0; k < points && k <= point_turn_mask(points); ++k)
                add(part.blocks->points[k], 1.0f);
            if (count > 0.0)
                drawn_m2[view.band] +=
                    double(part.area_m2) * facing / count * (double(k_bands) / k_truth_views);
        }
        for (size_t band = 0; band < k_bands; ++band)
            part.limit[band] = drawn_m2[band] > 0.0 ? std::clamp(part.seen_m2[band] / drawn_m2[band],
                                                                 double(k_least_gain), double(k_largest_gain))
                                                    : 1.0;
    }

    // What lod/choose_part.cpp would draw at a sample distance of one pixel, were there no triangles but of parts that
    // are nearer than their gains tell.
    void draw_part(CoverageRaster& raster, const Part& part, const Gain& of_part, const View& view,
                   uint32_t draw, float density, float side) const {
        const float per_meter = std::sqrt(density), importance = part.packed->importance;
        if (density > 1.001f * part.top_density) return draw_triangles(raster, part, view, per_meter, side);
        const float height = view.direction.y, gain = of_part.mean();
        const float size_gain = seen_gain(of_part.by_height(), height);
        const float chance = random_of(draw, part, 0);
        const float area_px2 = gain * part.area_m2 * density;
        if (!part.lines) {
            // The mean over all directions asks for points; |n . v|, a half in the mean, sizes them.
            const uint32_t stored = part.packed->point_count;
            const float p = std::min(importance * area_px2, float(stored));
            const float splat_px2 = 2.0f * area_px2 / std::max(p, 1.0e-6f) * size_gain;
            const uint32_t count = std::min(stored, uint32_t(p + chance));
            const uint32_t begin = run_begin(mix_bits(draw) & point_turn_mask(stored), count);
            for (uint32_t i = begin; i < begin + count; ++i) {
                const PackedVertex& point = part.blocks->points[i];
                raster.square(place(view, point, per_meter, side),
                              std::sqrt(splat_px2 * facing_of(point, view.direction)));
            }
            return;
        }
        const uint32_t stored = part.packed->line_count, stored_points = uint32_t(part.line_points.size());
        const float points = importance * area_px2;
        const float points_from_px =
            std::min(part.packed->line_length_m / float(stored) * per_meter, std::sqrt(points / 8.0f));
        if (0.75f + 0.5f * random_of(draw, part, 1) >= points_from_px) {
            const uint32_t count = std::min(stored_points, uint32_t(points + chance));
            const uint32_t begin = run_begin(mix_bits(draw) & point_turn_mask(stored_points), count);
            for (uint32_t i = begin; i < begin + count; ++i) {
                const LinePoint& point = part.line_points[i];
                raster.square(place(view, point.vertex, per_meter, side),
                              std::sqrt(2.0f * size_gain / importance * point.width_share *
                                        facing_of(point.vertex, view.direction)));
            }
            return;
        }
        const float area = gain * part.packed->projected_area_m2.evaluate(view.direction) * density;
        const float length = part.packed->projected_length_m.evaluate(view.direction) * per_meter;
        const float q = std::min(importance * area / std::max(length, 1.0e-6f), 1.0f);
        const uint32_t count = std::min(stored, uint32_t(q * float(stored) + chance));
        const float width = size_gain * area / std::max(length * q, 1.0e-6f);
        const std::vector<PackedVertex>& ends = part.blocks->line_vertices;
        for (size_t i = 0; i < 2 * size_t(count); i += 2)
            raster.line(place(view, ends[i], per_meter, side), place(view, ends[i + 1], per_meter, side),
                        width * std::bit_cast<float>(ends[i + 1].surface));
    }
    // In [0, 1), of any run of draws well spread.
    float random_of(uint32_t draw, const Part& part, uint32_t number) const {
        const uint32_t begin = mix_bits(uint32_t(&part - parts_.data()) * 2 + number);
        return float((begin + draw * (number == 0 ? 2654435769u : 3242174889u)) >> 8) * 0x1p-24f;
    }

    void measure_level(float density, std::vector<Gain>& gains) const {
        double seen_px2 = 0.0, primitives = 1.0;
        for (const Part& part : parts_) {
            seen_px2 += mean_of(part.seen_m2) * double(density);
            primitives += density > part.top_density
                              ? double(part.packed->triangle_count)
                              : std::min(double(part.area_m2 * density * part.packed->importance),
                                         double(part.packed->point_count + part.packed->line_count));
        }
        const double affordable = k_primitive_budget / primitives;
        const uint32_t views = uint32_t(std::clamp(std::min(k_wanted_pixels / seen_px2, affordable),
                                                   k_least_views, k_most_views)) /
                               k_bands * k_bands;
        const float side = std::ceil(2.0f * radius_m_ * std::sqrt(density)) + 6.0f;
        std::vector<Bands> last_gain(parts_.size()), last_drawn(parts_.size());
        for (int round = 0; round < k_rounds; ++round) {
            const std::vector<Bands> drawn = count_seen(
                uint32_t(side), views, [&](CoverageRaster& raster, const View& view, uint32_t draw) {
                    for (size_t p = 0; p < parts_.size(); ++p) {
                        raster.set_part(uint32_t(p));
                        draw_part(raster, parts_[p], gains[p], view, draw, density, side);
                    }
                });
            for (size_t p = 0; p < parts_.size(); ++p) {
                if (density > 1.001f * parts_[p].top_density) continue;
                for (size_t band = 0; band < k_bands; ++band) {
                    const double wanted = parts_[p].seen_m2[band] * double(density) * views / double(k_bands);
                    if (wanted < k_least_pixels || drawn[p][band] < 1.0) continue;
                    // Coverage grows by a power of the area drawn that falls where points lie on each other: secants
                    // in logarithms.
                    double& gain = gains[p].of_band[band];
                    const double log_gain = double(portable_log2(float(gain)));
                    const double log_drawn = double(portable_log2(float(drawn[p][band])));
                    double power = 1.0;
                    if (round > 0 && log_gain != last_gain[p][band])
                        power = std::clamp(
                            (log_drawn - last_drawn[p][band]) / (log_gain - last_gain[p][band]), 0.4, 1.0);
                    last_gain[p][band] = log_gain;
                    last_drawn[p][band] = log_drawn;
                    const double missing = double(portable_log2(float(wanted))) - log_drawn;
                    gain = std::clamp(gain * double(portable_exp2(float(missing / power))),
                                      double(k_least_gain), double(k_largest_gain));
                }
            }
        }
    }

    std::vector<Part> parts_;
    Box bounds_;
    float radius_m_ = 0.0f, top_density_ = 1.0f;
    std::vector<std::vector<Gain>> levels_;
};

}  // namespace

void measure_coverage(std::span<PlantBlocks> parts) {
    PlantCoverage coverage(parts);
    coverage.measure();
    for (size_t i = 0; i < parts.size(); ++i) coverage.tell(i, parts[i].parts[0]);
}

}  // namespace coppice
