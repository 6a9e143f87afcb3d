#include "tools/foliage/dropped_crown.h"

#include <algorithm>
#include "plugins/vegetation/cook/golden_order.h"
#include "plugins/vegetation/cook/progressive_order.h"
#include "plugins/vegetation/cook/space_curve.h"
#include "plugins/vegetation/lod/drop_resize.h"
#include "tools/foliage/crown.h"

namespace coppice {
namespace {

constexpr float k_tolerance = 0.02f;
constexpr float k_shares[] = {0.5f, 0.25f, 0.125f, 0.05f};

vec3 middle_of(const Leaf& leaf) {
    const auto& p = leaf.corners_plant;
    return (p[0] + p[1] + p[2] + p[3]) * 0.25f;
}

// What a prefix keeps, this drops last.
std::vector<uint32_t> progressive_drop_order(std::span<const vec3> places) {
    const std::vector<uint32_t> curve = order_along_curve(places);
    std::vector<uint32_t> order = make_prefix_order(uint32_t(places.size()), PrefixOrder::progressive, 1);
    for (uint32_t& place : order) place = curve[place];
    std::reverse(order.begin(), order.end());
    return order;
}

}  // namespace

float optical_depth(std::span<const Leaf> crown) {
    Box box;
    for (const Leaf& leaf : crown)
        for (vec3 corner : leaf.corners_plant) box.include(corner);
    if (box.empty()) return 0.0f;
    const vec3 size = box.size();
    const float shown_m2 = 0.25f * k_pi * (size.x * size.y + size.y * size.z + size.z * size.x) / 3.0f;
    return shown_m2 > 0.0f ? float(0.5 * crown_area_m2(crown)) / shown_m2 : 0.0f;
}

std::vector<Leaf> thin_crown(std::span<const Leaf> crown, std::span<const uint32_t> drop_order, float share,
                             float growth) {
    const size_t kept = std::min(size_t(double(share) * double(crown.size()) + 0.5), crown.size());
    std::vector<Leaf> leaves;
    for (uint32_t leaf : drop_order.last(kept)) {
        leaves.push_back(crown[leaf]);
        const vec3 middle = middle_of(crown[leaf]);
        for (vec3& corner : leaves.back().corners_plant) corner = middle + (corner - middle) * growth;
    }
    return leaves;
}

std::vector<DroppedErrors> measure_dropped(std::span<const Leaf> crown, const CrownCoverage& coverage) {
    std::vector<vec3> places;
    for (const Leaf& leaf : crown) places.push_back(middle_of(leaf));
    const std::vector<uint32_t> golden = golden_drop_order(places, {}),
                                printed = golden_drop_order(places, {.places = DropPlaces::cylinder}),
                                progressive = progressive_drop_order(places);
    const float depth = optical_depth(crown);
    std::vector<DroppedErrors> levels;
    for (float share : k_shares) {
        auto error = [&](const std::vector<uint32_t>& order, float growth) {
            return coverage.worst_error(thin_crown(crown, order, share, growth));
        };
        const float whole = weighted_growth(share, 1.0f);
        DroppedErrors errors;
        errors.leaf_count = uint32_t(thin_crown(crown, golden, share, 1.0f).size());
        errors.unscaled = error(progressive, weighted_growth(share, 0.0f));
        errors.half = error(progressive, weighted_growth(share, 0.5f));
        errors.whole = error(progressive, whole);
        errors.tolerant = error(progressive, std::sqrt(tolerant_area_growth(share, depth, k_tolerance)));
        errors.whole_golden = error(golden, whole);
        errors.whole_printed = error(printed, whole);
        levels.push_back(errors);
    }
    return levels;
}

}  // namespace coppice
