#include "plugins/vegetation/eco/compete.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <glm/geometric.hpp>

namespace coppice {
namespace {

// Those that live, largest first wins. Equal ones: the first in order lives.
void drop_dominated(std::vector<Competitor>& living) {
    double widest_m = 0.0;
    for (const Competitor& each : living) widest_m = std::max(widest_m, each.radius_m);
    const double cell_m = std::max(2.0 * widest_m, 0.01);
    auto cell_of = [&](dvec2 at) {
        return std::pair(int64_t(std::floor(at.x / cell_m)), int64_t(std::floor(at.y / cell_m)));
    };
    std::vector<uint32_t> order(living.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return living[a].radius_m != living[b].radius_m ? living[a].radius_m > living[b].radius_m
                                                        : living[a].plant < living[b].plant;
    });
    std::map<std::pair<int64_t, int64_t>, std::vector<uint32_t>> cells;  // of those that stay
    std::vector<Competitor> left;
    for (uint32_t i : order) {
        const Competitor& each = living[i];
        const auto [x, z] = cell_of(each.at);
        bool dominated = false;
        for (int64_t dx = -1; dx <= 1 && !dominated; ++dx)
            for (int64_t dz = -1; dz <= 1 && !dominated; ++dz) {
                const auto found = cells.find({x + dx, z + dz});
                if (found == cells.end()) continue;
                for (uint32_t other : found->second)
                    if (glm::length(left[other].at - each.at) < left[other].radius_m + each.radius_m) {
                        dominated = true;
                        break;
                    }
            }
        if (dominated) continue;
        cells[{x, z}].push_back(uint32_t(left.size()));
        left.push_back(each);
    }
    living = std::move(left);
}

}  // namespace

std::vector<Competitor> compete(std::vector<Competitor> living, uint32_t steps, double growth) {
    drop_dominated(living);
    for (uint32_t step = 0; step < steps; ++step) {
        bool grew = false;
        for (Competitor& each : living) {
            const double radius_m = std::min(each.radius_m * (1.0 + growth), each.radius_most_m);
            grew = grew || radius_m != each.radius_m;
            each.radius_m = radius_m;
        }
        if (!grew) break;  // and so on for ever
        drop_dominated(living);
    }
    return living;
}

}  // namespace coppice
