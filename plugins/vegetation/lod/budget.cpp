#include "plugins/vegetation/lod/budget.h"

#include "plugins/vegetation/plant/line_points.h"

namespace coppice {
namespace {

constexpr double k_tolerance = 0.005;  // of the budget

// The least d' whose square is px2 or more, so that what is below px2 squared is below it.
float edge_px(float px2) {
    const float px = std::sqrt(px2);
    return px * px < px2 ? std::bit_cast<float>(std::bit_cast<uint32_t>(px) + 1) : px;
}

// Between two edges of a bin V falls from `finer`, above the budget, to `coarser`.
//
// Without jumps it falls by 1 - 256/257 at most, 0.39 %, since no part falls faster than 1/d'^2: any d' in the bin is
// within the tolerance. Each part's count is concave in 1/d'^2, so V lies above its chord, by 0.1 % at most: a quarter of
// the fall, where all parts have their kink in the middle. Where V falls by more, something jumps, and only the edges are
// known. (With fewer than two points a triangle, points fall faster past their last; that is taken for a jump.)
float choose_in_bin(float finer_px2, float coarser_px2, double finer, double coarser, double budget) {
    const double tolerance = k_tolerance * budget;
    if (finer - coarser <= tolerance) {
        const double share = std::clamp((budget - coarser) / (finer - coarser), 0.0, 1.0);
        const double fine = 1.0 / double(finer_px2), coarse = 1.0 / double(coarser_px2);
        return float(1.0 / std::sqrt(coarse + share * (fine - coarse)));
    }
    const bool finer_fits = finer - budget <= tolerance && budget - coarser > tolerance;
    return edge_px(finer_fits ? finer_px2 : coarser_px2);
}

}  // namespace

// V at an edge of a bin: what reaches its last level there or coarser draws that; the rest draws by d'.
struct BudgetSums {
    using H = BudgetHistogram;
    double per_area = 0.0, per_length = 0.0;  // of the rest
    uint64_t most = 0;                        // of what is at its last level
    void pass(const H::Bin& bin, int exponent) {
        per_area += double(int64_t(bin.per_area)) * double(H::power_of_two(exponent));
        per_length += double(int64_t(bin.per_length)) * double(H::power_of_two(H::halve(exponent)));
        most -= bin.most;
    }
    double vertices_at(double px2) const {
        return (double(int64_t(most)) + per_area / px2 + per_length / std::sqrt(px2)) / double(H::k_quanta);
    }
    static float edge_px2(uint32_t bin) {
        return std::bit_cast<float>((H::k_first_key - 1 + int(bin)) << (23 - H::k_bin_bits));
    }
};

void BudgetHistogram::add(const BudgetHistogram& other) {
    for (size_t i = 0; i < bins_.size(); ++i) {
        bins_[i].most += other.bins_[i].most;
        bins_[i].per_area += other.bins_[i].per_area;
        bins_[i].per_length += other.bins_[i].per_length;
    }
}

float solve_sample_distance(const BudgetHistogram& histogram, uint64_t fixed_vertices,
                            uint64_t budget_vertices, float least_px, float most_px) {
    using H = BudgetHistogram;
    using Sums = BudgetSums;
    constexpr auto px2_of = &BudgetSums::edge_px2;
    const float least = least_px > k_finest_sample_distance_px
                            ? std::min(least_px, k_coarsest_sample_distance_px)
                            : k_finest_sample_distance_px;
    const float most =
        most_px < k_coarsest_sample_distance_px ? std::max(most_px, least) : k_coarsest_sample_distance_px;
    if (budget_vertices == 0) return most;
    const double budget = double(budget_vertices);

    // Bins of an octave share their units, so it is added up in integers first, and only the octave in which V crosses
    // the budget bin by bin.
    H::Bin octaves[H::k_octave_count];
    Sums sums;
    for (uint32_t octave = 0; octave < H::k_octave_count; ++octave) {
        H::Bin& sum = octaves[octave];
        for (uint32_t i = 0; i < H::k_bins_per_octave; ++i) {
            const H::Bin& bin = histogram.bins_[1 + octave * H::k_bins_per_octave + i];
            sum.most += bin.most;
            sum.per_area += bin.per_area;
            sum.per_length += bin.per_length;
        }
        sums.most += sum.most;
    }
    const H::Bin& before = histogram.bins_.front();
    sums.most += before.most + histogram.bins_.back().most;
    const int first_exponent = H::exponent_of(H::k_first_key);
    sums.pass(before, first_exponent - 1);

    const double fixed = double(fixed_vertices);
    auto vertices_at_edge = [&](const Sums& at, uint32_t bin) {
        return fixed + at.vertices_at(double(px2_of(bin)));
    };
    uint32_t crossed = H::k_octave_count;  // the coarsest octave whose finer end draws too much
    Sums at_crossed;
    for (uint32_t octave = 0; octave < H::k_octave_count; ++octave) {
        if (vertices_at_edge(sums, 1 + octave * H::k_bins_per_octave) > budget) {
            crossed = octave;
            at_crossed = sums;
        }
        sums.pass(octaves[octave], first_exponent + int(octave));
    }
    if (vertices_at_edge(sums, H::k_bin_count - 1) > budget) return most;
    if (crossed == H::k_octave_count) return least;

    const uint32_t first_bin = 1 + crossed * H::k_bins_per_octave;
    double finer = vertices_at_edge(at_crossed, first_bin);
    double edge_finer = 0.0, edge_coarser = 0.0;
    uint32_t found = first_bin;
    for (uint32_t bin = first_bin; bin < first_bin + H::k_bins_per_octave; ++bin) {
        at_crossed.pass(histogram.bins_[bin], first_exponent + int(crossed));
        const double coarser = vertices_at_edge(at_crossed, bin + 1);
        // The octave's sums said that its end fits; by the bins' it may be a rounding off.
        if (finer > budget && (coarser <= budget || bin + 1 == first_bin + H::k_bins_per_octave)) {
            found = bin;
            edge_finer = finer;
            edge_coarser = coarser;
        }
        finer = coarser;
    }
    return std::clamp(choose_in_bin(px2_of(found), px2_of(found + 1), edge_finer, edge_coarser, budget),
                      least, most);
}

double vertices_at(const BudgetHistogram& histogram, float sample_distance_px) {
    using H = BudgetHistogram;
    const float px2 = sample_distance_px * sample_distance_px;
    BudgetSums sums;
    for (const H::Bin& bin : histogram.bins_) sums.most += bin.most;
    for (uint32_t bin = 0; bin + 1 < H::k_bin_count && BudgetSums::edge_px2(bin) <= px2; ++bin)
        sums.pass(histogram.bins_[bin], H::exponent_of(H::k_first_key - 1 + int(bin)));
    return sums.vertices_at(double(px2));
}

namespace {

// Leaves have the vertices of the points in their place up to p = 4 L, keep those up to p = leaves_to, and from there on
// points and triangles are what they are without them.
void add_leaves(BudgetHistogram& histogram, const PackedPart& part, const PartRule& rule, float wanted,
                bool blend) {
    const float all = 3.0f * float(part.triangle_count), stored = std::max(float(part.point_count), 1.0f);
    const float to = rule.leaves_to(), most_leaves = std::min(k_points_a_leaf * rule.full_leaves(), to);
    const float triangles_from = blend ? 1.5f * stored : stored;
    // Vertices for p > stored, up to triangles_from.
    const float slope = blend ? (all - stored) / (0.5f * stored) : 0.0f;
    auto without_leaves = [&](float p) {
        return p >= triangles_from ? all : std::min(p, stored) + slope * std::max(p - stored, 0.0f);
    };
    histogram.add_saturating(wanted, most_leaves, 1.0f);
    histogram.add_jump(wanted, to, without_leaves(to) - most_leaves);
    if (to < stored) {
        histogram.add_saturating(wanted, stored, 1.0f);
        histogram.add_saturating(wanted, to, -1.0f);
    }
    if (to >= triangles_from) return;
    if (!blend) return histogram.add_jump(wanted, stored, all - stored);
    histogram.add_saturating(wanted, triangles_from, slope);
    histogram.add_saturating(wanted, std::max(stored, to), -slope);
}

}  // namespace

void add_part(BudgetHistogram& histogram, const PackedPart& part, const PartRule& rule,
              const PartDemand& demand, const FrameSettings& settings) {
    const float all = 3.0f * float(part.triangle_count);
    if (!settings.level_of_detail) return histogram.add_always(all);
    if (part.triangle_count == 0) return;
    const bool any = demand.area_px2 > 0.0f;
    if (rule.is_points()) {
        if (!any) return;
        const float wanted = rule.at_1px(rule.point_count(demand.area_px2));
        if (rule.leaves_count_apart()) return add_leaves(histogram, part, rule, wanted, settings.blend);
        if (part.point_count == 0) return histogram.add_always(all);
        if (settings.blend) return histogram.add_points(wanted, float(part.point_count), all);
        return histogram.add_switching_points(wanted, float(part.point_count), all);
    }
    // On edge nothing is seen of a part, but the points that stand for it are those of all directions.
    if (!any && !(demand.line_points > 0.0f)) return;
    if (any && (part.line_count == 0 || !(demand.length_px > 0.0f))) return histogram.add_always(all);
    // The d' of q = 1.
    const float all_lines_px = any ? part.importance * demand.area_px2 / demand.length_px : 0.0f;
    const float error_px = part.line_error_m * demand.pixels_per_meter;
    const float points_from_px = rule.line_points_from_px(demand);
    if (settings.line_sample_distance_px > 0.0f) {  // lines are held there
        const float d = std::max(settings.line_sample_distance_px, 1.0e-3f);
        if (any && (d < all_lines_px || d <= error_px)) return histogram.add_always(all);
        if (d >= points_from_px)
            return histogram.add_saturating(rule.at_1px(demand.line_points), float(line_point_count(part)),
                                            1.0f);
        return histogram.add_always(2.0f * float(part.line_count) * all_lines_px / d);
    }
    histogram.add_lines_and_points(2.0f * float(part.line_count) * all_lines_px,
                                   any ? std::max(all_lines_px, error_px) : 0.0f, all,
                                   rule.at_1px(demand.line_points), points_from_px);
}

void add_cloud(BudgetHistogram& histogram, std::span<const float> densities, float pixels_per_meter,
               const FrameSettings& settings) {
    // T of the first point not drawn, times d'^2.
    const float density_at_1px = settings.splat_factor * pixels_per_meter * pixels_per_meter;
    if (!(density_at_1px > 0.0f)) return;
    // From the densest down: each line's slope less the next one's is the weight of the kink between them. Where many
    // points appear at once the line is steep, but no jump.
    float slope_above = 0.0f, density = densities.empty() ? 0.0f : std::min(densities.back(), 1.0e30f);
    for (size_t count = densities.size(); count > 0 && density > 0.0f;) {
        const size_t fewer = count * 7 / 10;
        const float density_of_fewer =
            fewer > 0 ? std::min(std::max(0.0f, densities[fewer - 1]), 0.999f * density) : 0.0f;
        const float slope = float(count - fewer) / (density - density_of_fewer);
        histogram.add_saturating(density_at_1px, density, slope - slope_above);
        slope_above = slope;
        count = fewer;
        density = density_of_fewer;
    }
}

}  // namespace coppice
