#include "plugins/vegetation/cook/golden_order.h"

#include <algorithm>
#include "plugins/vegetation/cook/nearest_leaves.h"

namespace coppice {
namespace {

constexpr double k_golden_turns = 0.6180339887498949;  // 4 pi / (sqrt 5 + 1)

float fraction_of(double turns) { return float(turns - double(uint64_t(turns))); }

}  // namespace

std::vector<uint32_t> golden_drop_order(std::span<const vec3> places_plant,
                                        const GoldenOrderSettings& settings) {
    Box box;
    std::vector<NearestLeaves::Entry> entries;
    for (uint32_t i = 0; i < places_plant.size(); ++i) {
        box.include(places_plant[i]);
        entries.push_back({places_plant[i], i});
    }
    std::vector<uint32_t> order;
    if (entries.empty()) return order;
    order.reserve(entries.size());
    const vec3 center = box.center(), half = box.size() * 0.5f;
    const float radius_m = std::max(half.x, half.z);
    const uint32_t turn = std::max(settings.turn_places, 1u);
    const double rises_a_place = 1.0 / (double(turn) * double(std::max(settings.turns_per_rise, 1e-3f)));
    const uint32_t limit = uint32_t(places_plant.size());
    uint32_t built_size = limit;
    NearestLeaves left(std::move(entries), limit);
    std::vector<NearestLeaves::Neighbor> found;
    for (uint32_t i = 0; left.size() > 0; ++i) {
        const float out_m = radius_m * std::sqrt((float(i % turn) + 0.5f) / float(turn));
        const float risen = fraction_of(double(i) * rises_a_place);
        const float height =
            settings.height == DropHeight::sawtooth ? 2.0f * risen - 1.0f : portable_sin(2.0f * k_pi * risen);
        const float around = 2.0f * k_pi * fraction_of(double(i) * k_golden_turns);
        const vec3 place =
            center + vec3(out_m * portable_cos(around), half.y * height, out_m * portable_sin(around));
        left.find(place, UINT32_MAX, 1, found);
        order.push_back(found[0].leaf);
        left.remove(found[0].leaf);
        if (left.size() > 0 && left.size() * 2 <= built_size) {
            built_size = left.size();
            left = NearestLeaves(left.entries(), limit);
        }
    }
    return order;
}

}  // namespace coppice
