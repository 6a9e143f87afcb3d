#include "plugins/vegetation/eco/quantise.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr size_t k_feature_count = 10;
using FeatureValues = std::array<double, k_feature_count>;

FeatureValues values_of(const PlantFeatures& f) {
    return {f.crown_base_m,    f.crown_width_x_m, f.crown_width_z_m, f.area_along_x_m2, f.area_along_y_m2,
            f.area_along_z_m2, f.leaf_area_m2,    f.leaf_red,        f.leaf_green,      f.leaf_blue};
}

enum class Measure { length, area, color };

constexpr std::array<Measure, k_feature_count> k_measures{
    Measure::length, Measure::length, Measure::length, Measure::area,  Measure::area,
    Measure::area,   Measure::area,   Measure::color,  Measure::color, Measure::color};

double weight_of(Measure measure) { return measure == Measure::color ? 1.0 / 3.0 : 1.0; }

double scaled(double value, Measure measure, double scale) {
    return measure == Measure::color  ? value
           : measure == Measure::area ? value * scale * scale
                                      : value * scale;
}

double least_spread(Measure measure, double mean) {
    if (measure == Measure::color) return 0.02;
    // The smallest keeps 0 / 0 away where a feature is 0 for all.
    return std::max((measure == Measure::area ? 0.1 : 0.05) * std::abs(mean), 1e-9);
}

// What each term of a squared distance is multiplied by: weight over variance; the weights add up to 1.
FeatureValues factors_of(std::span<const PlantFeatures> individuals) {
    const double count = double(individuals.size());
    FeatureValues sum{}, squares{}, factors{};
    for (const PlantFeatures& one : individuals)
        for (size_t f = 0; f < k_feature_count; ++f) sum[f] += values_of(one)[f];
    for (const PlantFeatures& one : individuals)
        for (size_t f = 0; f < k_feature_count; ++f) {
            const double off = values_of(one)[f] - sum[f] / count;
            squares[f] += off * off;
        }
    double weights = 0.0;
    for (Measure measure : k_measures) weights += weight_of(measure);
    for (size_t f = 0; f < k_feature_count; ++f) {
        const double spread =
            std::max(std::sqrt(squares[f] / count), least_spread(k_measures[f], sum[f] / count));
        factors[f] = weight_of(k_measures[f]) / (weights * spread * spread);
    }
    return factors;
}

float scale_between(const PlantFeatures& drawn, const PlantFeatures& model) {
    return std::clamp(drawn.height_m / model.height_m, k_quantise_scale_least, k_quantise_scale_most);
}

// Squared distances: row m says what it costs to draw each individual as individual m.
class Costs {
  public:
    explicit Costs(std::span<const PlantFeatures> individuals)
        : count_(individuals.size()), costs_(count_ * count_) {
        const FeatureValues factors = factors_of(individuals);
        parallel_for(count_, 16, [&](size_t first, size_t last) {
            for (size_t model = first; model < last; ++model) {
                const FeatureValues of_model = values_of(individuals[model]);
                for (size_t i = 0; i < count_; ++i) {
                    const double scale = double(scale_between(individuals[i], individuals[model]));
                    const FeatureValues wanted = values_of(individuals[i]);
                    double cost = 0.0;
                    for (size_t f = 0; f < k_feature_count; ++f) {
                        const double off = wanted[f] - scaled(of_model[f], k_measures[f], scale);
                        cost += factors[f] * off * off;
                    }
                    costs_[model * count_ + i] = cost;
                }
            }
        });
    }

    size_t count() const { return count_; }
    std::span<const double> of_model(size_t model) const { return {&costs_[model * count_], count_}; }
    double total_of(size_t model) const {
        const std::span<const double> row = of_model(model);
        return std::accumulate(row.begin(), row.end(), 0.0);
    }

  private:
    size_t count_;
    std::vector<double> costs_;
};

// The medoids found so far, and for each individual its nearest and its second nearest.
class Clusters {
  public:
    explicit Clusters(const Costs& costs) : costs_(costs), near_(costs.count()), is_medoid_(costs.count()) {
        size_t best = 0;
        for (size_t i = 1; i < costs_.count(); ++i)
            if (costs_.total_of(i) < costs_.total_of(best)) best = i;
        // Less than this is rounding: swaps that gain more come to an end.
        least_gain_ = 1e-9 * costs_.total_of(best);
        put(0, best);
    }

    void add_one() {
        size_t worst = 0;
        while (is_medoid_[worst]) ++worst;
        for (size_t i = worst + 1; i < costs_.count(); ++i)
            if (!is_medoid_[i] && near_[i].cost > near_[worst].cost) worst = i;
        put(medoids_.size(), worst);
        while (swap_once_through()) {
        }
    }

    double total() const {
        double sum = 0.0;
        for (const Near& near : near_) sum += near.cost;
        return sum;
    }

    std::vector<uint32_t> sorted_medoids() const {
        std::vector<uint32_t> sorted = medoids_;
        std::sort(sorted.begin(), sorted.end());
        return sorted;
    }

  private:
    struct Near {
        size_t slot;               // of the nearest medoid
        double cost, second_cost;  // second: INFINITY while there is one medoid only
    };

    void put(size_t slot, size_t individual) {
        if (slot < medoids_.size())
            is_medoid_[medoids_[slot]] = false;
        else
            medoids_.resize(slot + 1);
        medoids_[slot] = uint32_t(individual);
        is_medoid_[individual] = true;
        std::fill(near_.begin(), near_.end(), Near{0, INFINITY, INFINITY});
        for (size_t s = 0; s < medoids_.size(); ++s) {
            const std::span<const double> row = costs_.of_model(medoids_[s]);
            for (size_t i = 0; i < near_.size(); ++i) {
                Near& near = near_[i];
                if (row[i] < near.cost)
                    near = {s, row[i], near.cost};
                else
                    near.second_cost = std::min(near.second_cost, row[i]);
            }
        }
    }

    // Tries each individual in the place of the medoid it would best replace. Whether one was swapped.
    bool swap_once_through() {
        if (least_gain_ <= 0.0 || medoids_.size() < 2) return false;
        bool swapped = false;
        std::vector<double> loss = losses();
        for (size_t candidate = 0; candidate < costs_.count(); ++candidate) {
            if (is_medoid_[candidate]) continue;
            std::vector<double> change = loss;  // of the total, were the slot's medoid replaced
            double gained = 0.0;                // whichever is replaced
            const std::span<const double> row = costs_.of_model(candidate);
            for (size_t i = 0; i < near_.size(); ++i) {
                const Near& near = near_[i];
                if (row[i] < near.cost) {
                    gained += near.cost - row[i];
                    change[near.slot] -= near.second_cost - near.cost;
                } else if (row[i] < near.second_cost) {
                    change[near.slot] -= near.second_cost - row[i];
                }
            }
            const auto best = std::min_element(change.begin(), change.end());
            if (gained - *best <= least_gain_) continue;
            put(size_t(best - change.begin()), candidate);
            loss = losses();
            swapped = true;
        }
        return swapped;
    }

    // What the total would grow by without each slot's medoid.
    std::vector<double> losses() const {
        std::vector<double> loss(medoids_.size(), 0.0);
        for (const Near& near : near_) loss[near.slot] += near.second_cost - near.cost;
        return loss;
    }

    const Costs& costs_;
    std::vector<uint32_t> medoids_;
    std::vector<Near> near_;
    std::vector<uint8_t> is_medoid_;
    double least_gain_ = 0.0;
};

}  // namespace

Quantised quantise(std::span<const PlantFeatures> individuals, uint32_t count) {
    assert(count >= 1 && count <= individuals.size());
    const Costs costs(individuals);
    Clusters clusters(costs);
    Quantised result;
    result.error_by_count.reserve(count);
    for (uint32_t models = 1; models <= count; ++models) {
        if (models > 1) clusters.add_one();
        result.error_by_count.push_back(float(std::sqrt(clusters.total() / double(individuals.size()))));
    }
    result.medoids = clusters.sorted_medoids();
    for (size_t i = 0; i < individuals.size(); ++i) {
        uint32_t nearest = 0;
        for (uint32_t m = 0; m < count; ++m) {
            const uint32_t medoid = result.medoids[m];
            const bool nearer = costs.of_model(medoid)[i] < costs.of_model(result.medoids[nearest])[i];
            if (nearer || medoid == i) nearest = m;
            if (medoid == i) break;  // itself, even where another is as near
        }
        result.medoid_of.push_back(nearest);
        result.scale_of.push_back(scale_between(individuals[i], individuals[result.medoids[nearest]]));
    }
    return result;
}

}  // namespace coppice
