// The d' control: the sample distance at which a frame draws as many vertices as it may, found in the frame itself.
// V(d'), what all parts in view draw together, falls as d' grows, and each part's share is a power of d' up to the d' at
// which it becomes all its triangles. A histogram of those distances gives V exactly at its bins' edges by one prefix
// sum (DESIGN section 3: budget). Source: ours, in place of chasing the budget from frame to frame (Deussen et al. 2002).
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/lod/choose_part.h"

namespace coppice {

inline constexpr float k_finest_sample_distance_px = 0.125f;
inline constexpr float k_coarsest_sample_distance_px = 512.0f;

// What parts would draw, by d'. Adding is one thread's; histograms of several jobs add up to the same bits in any order
// and grouping, since sums are integers. They hold 2^19 items of 2^32 vertices, what one item is clamped to. Counts that
// are zero, negative or NaN draw nothing and are ignored; infinite ones are clamped. 144 KiB, allocated once.
class BudgetHistogram {
  public:
    BudgetHistogram() : bins_(k_bin_count) {}
    void clear() { std::fill(bins_.begin(), bins_.end(), Bin{}); }

    // Points that blend into triangles (PartRule::choose_points): with p = wanted_at_1px / d'^2, p vertices up to all the stored
    // ones, and from there evenly to `most` at p = 1.5 stored.
    void add_points(float wanted_at_1px, float stored, float most) {
        if (!(wanted_at_1px > 0.0f) || !(stored > 0.0f) || !(most >= 0.0f)) return;
        stored = std::clamp(stored, 1.0f, k_most_vertices);
        most = std::min(most, k_most_vertices);
        if (most == 1.5f * stored || most == stored) return add_saturating(wanted_at_1px, most, 1.0f);
        // The kinked line as two that saturate; weights may be zero, which times infinity is no number.
        wanted_at_1px = std::min(wanted_at_1px, 1.0e30f);
        const float past_stored = 2.0f * most / stored - 2.0f;
        add_saturating(wanted_at_1px, stored, 1.0f - past_stored);
        add_saturating(wanted_at_1px, 1.5f * stored, past_stored);
    }
    // Points that switch to `most` at once, at p >= stored.
    void add_switching_points(float wanted_at_1px, float stored, float most) {
        if (!(wanted_at_1px > 0.0f) || !(stored > 0.0f) || !(most >= 0.0f)) return;
        add_by_area(wanted_at_1px / std::clamp(stored, 1.0f, k_most_vertices), wanted_at_1px, most);
    }
    // Lines (PartRule::choose_lines): wanted_at_1px / d' vertices, two a line; at d' <= triangles_below_px all triangles, `most`.
    void add_lines(float wanted_at_1px, float triangles_below_px, float most) {
        if (!(wanted_at_1px > 0.0f) || !(most >= 0.0f)) return;
        const float below_px = std::max(0.0f, triangles_below_px);  // 0 for NaN
        int exponent;
        Bin& bin = bin_of(below_px * below_px, exponent);
        bin.most += quantise(most);
        bin.per_length += quantise(wanted_at_1px * power_of_two(-halve(exponent)));
    }
    // Lines up to d' = points_from_px, and from there points_at_1px / d'^2 (PartRule).
    void add_lines_and_points(float wanted_at_1px, float triangles_below_px, float most, float points_at_1px,
                              float points_from_px) {
        if (!(points_at_1px > 0.0f) || !(points_from_px < 1.0e15f))
            return add_lines(wanted_at_1px, triangles_below_px, most);
        if (points_from_px <= triangles_below_px)
            return add_by_area(triangles_below_px * triangles_below_px, points_at_1px, most);
        add_lines(wanted_at_1px, triangles_below_px, most);
        int exponent;
        Bin& bin = bin_of(points_from_px * points_from_px, exponent);
        bin.per_length += quantise(-wanted_at_1px * power_of_two(-halve(exponent)));
        bin.per_area += quantise(points_at_1px * power_of_two(-exponent));
    }
    // weight * min(wanted_at_1px / d'^2, limit): of several, any curve over 1 / d'^2 that is made of straight lines. Requires
    // finite numbers and a limit > 0.
    void add_saturating(float wanted_at_1px, float limit, float weight) {
        add_by_area(wanted_at_1px / limit, weight * wanted_at_1px, weight * limit);
    }
    // So many more, or less, at wanted_at_1px / d'^2 >= from. Requires finite numbers and from > 0.
    void add_jump(float wanted_at_1px, float from, float vertices) {
        add_by_area(wanted_at_1px / from, 0.0f, vertices);
    }
    // What is drawn at any d'.
    void add_always(float vertices) {
        if (vertices > 0.0f) bins_.back().most += quantise(vertices);
    }
    void add(const BudgetHistogram& other);

    bool operator==(const BudgetHistogram&) const = default;

  private:
    friend float solve_sample_distance(const BudgetHistogram&, uint64_t, uint64_t, float, float);
    friend double vertices_at(const BudgetHistogram&, float);
    friend struct BudgetSums;

    // Bins are of d'^2, since that needs no root: 256 for each power of two, read from the float's bits. One before and
    // one after for what lies outside. Within a bin d'^2 grows by 1/256 at most.
    static constexpr uint32_t k_bin_bits = 8;
    static constexpr uint32_t k_bins_per_octave = 1u << k_bin_bits;
    static constexpr uint32_t k_octave_count = 24;
    static constexpr uint32_t k_bin_count = k_octave_count * k_bins_per_octave + 2;
    static constexpr int k_first_key = std::bit_cast<int>(k_finest_sample_distance_px *
                                                          k_finest_sample_distance_px) >>
                                       (23 - k_bin_bits);
    static_assert(k_finest_sample_distance_px * k_finest_sample_distance_px * float(1u << k_octave_count) ==
                  k_coarsest_sample_distance_px * k_coarsest_sample_distance_px);
    static constexpr float k_most_vertices = 4294967296.0f;
    static constexpr float k_quanta = 1024.0f;  // of a vertex

    // What the items that reach their last level in the bin draw: at d' below it `most`; above it
    // per_area / d'^2 + per_length / d', in units of the bin's octave, so that they are of the size of `most`.
    struct Bin {
        uint64_t most = 0, per_area = 0, per_length = 0;  // signed, in two's complement
        bool operator==(const Bin&) const = default;
    };

    // Of d'^2, rounded down; its half is that of d'.
    static int exponent_of(int key) { return (key >> k_bin_bits) - 127; }
    static int halve(int exponent) { return exponent >> 1; }
    static float power_of_two(int exponent) { return std::bit_cast<float>((127 + exponent) << 23); }

    static uint64_t quantise(float vertices) {
        constexpr float k_limit = 4.0f * k_most_vertices * k_quanta;
        return uint64_t(int64_t(std::min(std::max(-k_limit, vertices * k_quanta), k_limit) + 0.5f));
    }

    // Requires last_level_px2 >= 0, infinity included.
    Bin& bin_of(float last_level_px2, int& exponent) {
        const int key =
            std::min(std::max(std::bit_cast<int>(last_level_px2) >> (23 - k_bin_bits), k_first_key - 1),
                     k_first_key + int(k_bin_count) - 2);
        exponent = exponent_of(key);
        return bins_[size_t(key - (k_first_key - 1))];
    }
    void add_by_area(float last_level_px2, float per_area, float most) {
        int exponent;
        Bin& bin = bin_of(last_level_px2, exponent);
        bin.most += quantise(most);
        bin.per_area += quantise(per_area * power_of_two(-exponent));
    }

    std::vector<Bin> bins_;
};

// d' in [least_px, most_px], which are taken within [k_finest_.., k_coarsest_sample_distance_px], at which the parts and
// fixed_vertices draw the budget: |V(d') - budget| <= 0.5 % of the budget. Where V jumps across the budget (lines that
// become triangles; all that do so within 0.2 % of d' count as one jump), the coarser side, below the budget. All fits
// at least_px: least_px. The budget is 0 or does not suffice at most_px: most_px. Never NaN; does not allocate.
float solve_sample_distance(const BudgetHistogram& histogram, uint64_t fixed_vertices,
                            uint64_t budget_vertices, float least_px, float most_px);

// V(d') without what jumps or bends within 0.2 % below d', so that what is solved at the coarser side of a jump is told
// apart from what meets its budget. Does not allocate.
double vertices_at(const BudgetHistogram& histogram, float sample_distance_px);

// What choose_part will draw, in the mean over chance; four vertices a leaf. Coverage gains change with d' by a tenth or two an octave; they are
// taken at settings.sample_distance_px, so solve again where the d' found is far from that: settle_sample_distance.
// rule: of part and settings.
void add_part(BudgetHistogram& histogram, const PackedPart& part, const PartRule& rule,
              const PartDemand& demand, const FrameSettings& settings);
inline void add_part(BudgetHistogram& histogram, const PackedPart& part, const PlantView& view,
                     const FrameSettings& settings) {
    const PartRule rule(part, settings);
    add_part(histogram, part, rule, rule.demand(project_part(part, view, settings)), settings);
}
// What choose_cloud will draw, to 1 %: its points over their density by straight lines between counts a factor of 0.7
// apart.
void add_cloud(BudgetHistogram& histogram, std::span<const float> densities, float pixels_per_meter,
               const FrameSettings& settings);

inline constexpr float k_settled_sample_distance = 0.01f;

// The d' that finds itself: solve_at(d') fills a histogram with the gains at d' and solves it. One pass where guess_px > 0,
// the last frame's, is within 1 % of it, which leaves the count 0.4 % off where gains change by 15 % an octave; after a
// camera cut three or four, by secants, and more only where solve_at jumps.
template <class SolveAt>
float settle_sample_distance(float guess_px, SolveAt&& solve_at) {
    constexpr int k_most_passes = 8;
    float at_px = guess_px, found_px = solve_at(at_px);
    float slope = -0.15f;  // of found by at, while unknown: what 10 % of gain an octave give
    for (int pass = 1;
         pass < k_most_passes && std::fabs(found_px - at_px) > k_settled_sample_distance * at_px; ++pass) {
        const float last_at_px = at_px, last_found_px = found_px;
        at_px = std::clamp(at_px + (found_px - at_px) / (1.0f - slope), 0.5f * found_px, 2.0f * found_px);
        found_px = solve_at(at_px);
        slope = std::clamp((found_px - last_found_px) / (at_px - last_at_px), -0.5f, 0.5f);
    }
    return found_px;
}

}  // namespace coppice
