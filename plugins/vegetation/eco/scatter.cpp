#include "plugins/vegetation/eco/scatter.h"

#include <algorithm>
#include <fmt/format.h>
#include "plugins/shared/noise.h"
#include "plugins/vegetation/eco/compete.h"
#include "plugins/vegetation/eco/ground_height.h"
#include "runtime/core/jobs.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

constexpr double k_plants_per_cell = 16.0;  // enough that counts vary from place to place as chance has it
constexpr uint64_t k_cell_limit = uint64_t(1) << 24;
constexpr uint32_t k_tries = 24;   // for a place far enough from the others
constexpr double k_densest = 0.5;  // plants on a square of the spacing that such tries reach
constexpr double k_most_thrown =
    4096;  // places tried for each plant of a count, before it is called impossible

struct Spot {
    dvec2 at;
    uint64_t bits;  // decides everything else about the plant
};

// Whether a plant may stand somewhere, and which it is.
class Ground {
  public:
    explicit Ground(const ScatterSettings& settings) : s_(settings), least_up_(settings.rule.least_up()) {
        for (const ScatterSpecies& species : s_.species) total_weight_ += species.weight;
    }

    // chance in [0, 1) thins edges, maps and noise.
    bool admits(dvec2 p, float chance) const {
        double inside = -s_.region.distance_m(p);
        if (!(inside > 0.0)) return false;
        float density = s_.edge_m > 0.0f ? std::min(1.0f, float(inside) / s_.edge_m) : 1.0f;
        if (s_.map && density > chance) density *= s_.map->share_at(p);
        if (s_.noisy && density > chance) density *= noise_density(p);
        if (!(density > chance)) return false;
        if (!s_.exclude.shapes.empty() && s_.exclude.contains(p)) return false;
        if (!s_.keeps_distances(p)) return false;
        if (least_up_ > 0.0f && normal_at(p).y < least_up_) return false;
        return s_.rule.takes_height(height_at(p));
    }

    Placement plant_at(const Spot& spot) const {
        Random random(spot.bits);
        float pick = random.next_unit() * total_weight_;
        size_t chosen = 0;
        while (chosen + 1 < s_.species.size() && pick >= s_.species[chosen].weight)
            pick -= s_.species[chosen++].weight;
        const PlantKind& kind = s_.species[chosen].kind;
        Placement plant;
        plant.position_world = dvec3(spot.at.x, height_at(spot.at), spot.at.y);
        const PlantIndividual& individual =
            kind.individuals[random.next_below(uint32_t(kind.individuals.size()))];
        plant.model = {individual.model, uint32_t(random.next_bits() >> 32)};
        float share = random.next_unit();
        plant.scale = s_.height_high_m > 0.0f
                          ? (s_.height_low_m + (s_.height_high_m - s_.height_low_m) * share) / kind.height_m
                          : s_.scale_low + (s_.scale_high - s_.scale_low) * share;
        plant.scale *= individual.scale;
        float turn = random.next_unit() * 2.0f * k_pi, bearing = random.next_unit() * 2.0f * k_pi;
        float lean = s_.lean_most_rad * random.next_unit();
        vec3 tip(portable_cos(bearing) * portable_sin(lean), portable_cos(lean),
                 portable_sin(bearing) * portable_sin(lean));
        if (s_.rule.align_to_ground > 0.0f) tip = s_.rule.tip(tip, normal_at(spot.at));
        vec3 towards = normalize_or(vec3(tip.x, 0.0f, tip.z), vec3(1, 0, 0));
        plant.turn = make_turn(turn, portable_acos(tip.y), towards);
        return plant;
    }

  private:
    float noise_density(dvec2 p) const {
        const DensityNoise& n = s_.noise;
        double length = double(n.wavelength_m);
        float value =
            0.5f + fractal_noise(p.x / length, p.y / length, n.octaves, 0.55f, n.seed, n.period_m / length);
        return smooth_step(n.from - n.softness, n.from + n.softness, value) *
               (1.0f - smooth_step(n.to - n.softness, n.to + n.softness, value));
    }
    double height_at(dvec2 p) const { return ground_height(s_.terrain, p.x, p.y); }
    vec3 normal_at(dvec2 p) const { return ground_normal(s_.terrain, p.x, p.y); }

    const ScatterSettings& s_;
    float least_up_, total_weight_ = 0.0f;
};

// The region's box cut into square cells, each with the spots found in it.
class Cells {
  public:
    Cells(const ScatterSettings& settings, double density) : s_(settings), density_(density) {
        side_m_ = std::max(std::sqrt(k_plants_per_cell / density), s_.spacing_m);
        auto [low, high] = s_.region.bounds();
        low_ = low;
        columns_ = uint64_t(std::ceil(std::max(1.0, (high.x - low.x) / side_m_)));
        rows_ = uint64_t(std::ceil(std::max(1.0, (high.y - low.y) / side_m_)));
    }

    bool too_many() const {
        return columns_ > k_cell_limit || rows_ > k_cell_limit || columns_ * rows_ > k_cell_limit;
    }

    // At most, were nothing thinned.
    double expected() {
        double half_diagonal = side_m_ * 0.70711;
        used_.assign(columns_ * rows_, 0);
        parallel_for(rows_, 4, [&](size_t first, size_t last) {
            for (size_t row = first; row < last; ++row)
                for (size_t column = 0; column < columns_; ++column) {
                    dvec2 center = low_ + (dvec2(double(column), double(row)) + 0.5) * side_m_;
                    used_[row * columns_ + column] = s_.region.distance_m(center) < half_diagonal;
                }
        });
        return double(std::count(used_.begin(), used_.end(), 1)) * density_ * side_m_ * side_m_;
    }

    std::vector<Spot> fill(const Ground& ground) {
        spots_.resize(columns_ * rows_);
        if (s_.spacing_m > 0.0) {
            // Cells of one colour are at least a spacing apart and do not see each other: four rounds, each
            // parallel.
            for (size_t color = 0; color < 4; ++color) {
                size_t column_first = color & 1, row_first = color >> 1;
                size_t rows = (rows_ + 1 - row_first) / 2;
                parallel_for(rows, 4, [&](size_t first, size_t last) {
                    for (size_t row = first; row < last; ++row)
                        for (size_t column = column_first; column < columns_; column += 2)
                            fill_cell(column, 2 * row + row_first, ground);
                });
            }
        } else {
            parallel_for(rows_, 4, [&](size_t first, size_t last) {
                for (size_t row = first; row < last; ++row)
                    for (size_t column = 0; column < columns_; ++column) fill_cell(column, row, ground);
            });
        }
        size_t count = 0;
        for (const auto& cell : spots_) count += cell.size();
        std::vector<Spot> all;
        all.reserve(count);
        for (const auto& cell : spots_) all.insert(all.end(), cell.begin(), cell.end());
        return all;
    }

  private:
    void fill_cell(size_t column, size_t row, const Ground& ground) {
        size_t index = row * columns_ + column;
        if (!used_[index]) return;
        Random random(s_.seed, index);
        double wanted = density_ * side_m_ * side_m_;
        uint32_t count = uint32_t(wanted + double(random.next_unit()));
        std::vector<Spot> found;
        found.reserve(count);
        dvec2 corner = low_ + dvec2(double(column), double(row)) * side_m_;
        for (uint32_t plant = 0; plant < count; ++plant)
            for (uint32_t attempt = 0; attempt < k_tries; ++attempt) {
                // Two draws each, in this order: arguments of one call have none.
                double u = double(random.next_bits() >> 11) * 0x1p-53;
                double v = double(random.next_bits() >> 11) * 0x1p-53;
                uint64_t bits = random.next_bits();
                dvec2 at = corner + dvec2(u, v) * side_m_;
                if (s_.spacing_m > 0.0 && !is_free(column, row, found, at)) continue;
                if (ground.admits(at, float(bits >> 40) * 0x1p-24f)) found.push_back({at, bits});
                break;  // what the ground refuses is not tried elsewhere: density is that of the ground that
                        // takes it
            }
        spots_[index] = std::move(found);
    }

    bool is_free(size_t column, size_t row, const std::vector<Spot>& own, dvec2 at) const {
        double least2 = s_.spacing_m * s_.spacing_m;
        auto clear_of = [&](const std::vector<Spot>& cell) {
            for (const Spot& spot : cell) {
                dvec2 d = spot.at - at;
                if (glm::dot(d, d) < least2) return false;
            }
            return true;
        };
        if (!clear_of(own)) return false;
        for (size_t j = row > 0 ? row - 1 : 0; j <= std::min<size_t>(row + 1, rows_ - 1); ++j)
            for (size_t i = column > 0 ? column - 1 : 0; i <= std::min<size_t>(column + 1, columns_ - 1); ++i)
                if ((i != column || j != row) && !clear_of(spots_[j * columns_ + i])) return false;
        return true;
    }

    const ScatterSettings& s_;
    double density_, side_m_;
    dvec2 low_;
    uint64_t columns_, rows_;
    std::vector<uint8_t> used_;
    std::vector<std::vector<Spot>> spots_;
};

Result<std::vector<Spot>> spots_by_density(const ScatterSettings& s, const Ground& ground, double density,
                                           const std::string& file, const std::string& place) {
    Cells cells(s, density);
    auto refuse = [&](double plants) {
        return fail(ErrorId::limit_exceeded, file, place, fmt::format("about {:.3g} plants", plants),
                    fmt::format("at most {} in a scene: less density or a smaller region", k_plant_limit));
    };
    if (cells.too_many()) {
        auto [low, high] = s.region.bounds();
        return refuse((high.x - low.x) * (high.y - low.y) * density);
    }
    // Cells at the border are counted whole: leave room for them.
    if (double expected = cells.expected(); expected > 1.5 * double(k_plant_limit)) return refuse(expected);
    return cells.fill(ground);
}

Result<std::vector<Spot>> spots_by_count(const ScatterSettings& s, const Ground& ground,
                                         const std::string& file, const std::string& place) {
    auto [low, high] = s.region.bounds();
    double area = std::max((high.x - low.x) * (high.y - low.y), 1e-6);
    // With a spacing, throwing more than this adds nothing.
    double densest = s.spacing_m > 0.0 ? 1.0 / (s.spacing_m * s.spacing_m) : INFINITY;
    densest = std::min({densest, k_most_thrown * double(s.count) / area, 2.0 * double(k_plant_limit) / area});
    double density = std::min(1.2 * double(s.count) / area, densest);
    while (true) {
        COPPICE_TRY(std::vector<Spot> spots, spots_by_density(s, ground, density, file, place));
        if (spots.size() >= s.count) {
            // Any choice keeps the spacing; that of the smallest hashes is spread evenly.
            std::vector<std::pair<uint64_t, uint32_t>> order(spots.size());
            for (uint32_t i = 0; i < spots.size(); ++i) order[i] = {Random(spots[i].bits, 1).next_bits(), i};
            std::nth_element(order.begin(), order.begin() + ptrdiff_t(s.count), order.end());
            order.resize(s.count);
            std::sort(order.begin(), order.end(), [](auto a, auto b) { return a.second < b.second; });
            std::vector<Spot> chosen;
            chosen.reserve(s.count);
            for (auto [hash, index] : order) chosen.push_back(spots[index]);
            return chosen;
        }
        if (density >= densest) break;
        double found = std::max(double(spots.size()), 0.125 * double(s.count));
        density = std::min(density * std::max(1.3, 1.2 * double(s.count) / found), densest);
    }
    return fail(ErrorId::value_out_of_range, file, place + ".count",
                fmt::format("{} plants do not fit into the region", s.count),
                "a larger region, fewer exclusions, a smaller spacing_m, or a brighter density_map");
}

Result<std::vector<Spot>> spots_on_grid(const ScatterSettings& s, const Ground& ground,
                                        const std::string& file, const std::string& place) {
    auto [low, high] = s.region.bounds();
    dvec2 middle = (low + high) * 0.5;
    auto fitting = [&](double size) { return std::max(1.0, std::floor(size / s.grid_spacing_m + 1e-9)); };
    double columns = s.grid_columns ? double(s.grid_columns) : fitting(high.x - low.x);
    double rows = s.grid_rows ? double(s.grid_rows) : fitting(high.y - low.y);
    if (columns * rows > double(k_plant_limit))
        return fail(ErrorId::limit_exceeded, file, place + ".grid",
                    fmt::format("{:.3g} plants", columns * rows),
                    fmt::format("at most {} in a scene", k_plant_limit));
    std::vector<Spot> spots;
    spots.reserve(size_t(columns * rows));
    for (uint64_t row = 0; row < uint64_t(rows); ++row)
        for (uint64_t column = 0; column < uint64_t(columns); ++column) {
            Random random(s.seed, row * uint64_t(columns) + column);
            double u = 2.0 * double(random.next_unit()) - 1.0, v = 2.0 * double(random.next_unit()) - 1.0;
            uint64_t bits = random.next_bits();
            dvec2 step(double(column) + 0.5 - columns * 0.5, double(row) + 0.5 - rows * 0.5);
            dvec2 at = middle + step * s.grid_spacing_m + dvec2(u, v) * s.grid_jitter_m;
            if (ground.admits(at, float(bits >> 40) * 0x1p-24f)) spots.push_back({at, bits});
        }
    return spots;
}

// In the order they stood in.
std::vector<Placement> grow_up(const std::vector<Placement>& plants, const Competition& rule) {
    std::vector<Competitor> competitors;
    competitors.reserve(plants.size());
    for (const Placement& plant : plants)
        competitors.push_back({dvec2(plant.position_world.x, plant.position_world.z),
                               rule.crown_radius_m * double(plant.scale),
                               rule.crown_radius_m * std::max(double(plant.scale), rule.scale_most),
                               uint32_t(competitors.size())});
    std::vector<Competitor> left = compete(std::move(competitors), rule.steps, rule.growth);
    std::sort(left.begin(), left.end(), [](const auto& a, const auto& b) { return a.plant < b.plant; });
    std::vector<Placement> grown;
    grown.reserve(left.size());
    for (const Competitor& each : left) {
        grown.push_back(plants[each.plant]);
        grown.back().scale = float(each.radius_m / rule.crown_radius_m);
    }
    return grown;
}

}  // namespace

bool ScatterSettings::keeps_distances(dvec2 p) const {
    for (const DistanceRule& rule : distances)
        if ((rule.too_near && rule.too_near->contains(p)) || (rule.near_enough && !rule.near_enough->contains(p)))
            return false;
    return true;
}

Result<std::vector<Placement>> scatter(const ScatterSettings& s, const std::string& file,
                                       const std::string& place) {
    Ground ground(s);
    if (s.spacing_m > 0.0 && s.density_per_m2 * s.spacing_m * s.spacing_m > k_densest)
        return fail(
            ErrorId::value_out_of_range, file, place + ".spacing_m",
            fmt::format("{:g} plants a square metre cannot be {:g} m apart", s.density_per_m2, s.spacing_m),
            fmt::format("at most {:.3g} m at this density", std::sqrt(k_densest / s.density_per_m2)));
    COPPICE_TRY(std::vector<Spot> spots, s.grid_spacing_m > 0.0 ? spots_on_grid(s, ground, file, place)
                                         : s.count > 0
                                             ? spots_by_count(s, ground, file, place)
                                             : spots_by_density(s, ground, s.density_per_m2, file, place));
    std::vector<Placement> plants(spots.size());
    parallel_for(spots.size(), 4096, [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) plants[i] = ground.plant_at(spots[i]);
    });
    return s.competition.crown_radius_m > 0.0 ? grow_up(plants, s.competition) : plants;
}

}  // namespace coppice
