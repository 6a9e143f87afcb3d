#include "plugins/vegetation/cook/golden_order.h"

#include <algorithm>
#include <tuple>
#include "plugins/vegetation/cook/nearest_leaves.h"

namespace coppice {
namespace {

constexpr double k_golden_turns = 0.6180339887498949;  // 4 pi / (sqrt 5 + 1)

constexpr size_t k_slice_leaves = 64;

float fraction_of(double turns) { return float(turns - double(uint64_t(turns))); }

// Which height, and how far from the axis there, shares of the leaves' heights and radii mean.
class LeafQuantiles {
  public:
    LeafQuantiles(std::span<const vec3> places, vec3 axis) {
        std::vector<vec2> leaves;  // radius, height
        for (vec3 p : places) leaves.push_back({glm::length(vec2(p.x - axis.x, p.z - axis.z)), p.y});
        std::sort(leaves.begin(), leaves.end(),
                  [](vec2 a, vec2 b) { return std::tie(a.y, a.x) < std::tie(b.y, b.x); });
        slice_count_ = std::max<size_t>(leaves.size() / k_slice_leaves, 1);
        for (size_t s = 0; s < slice_count_; ++s)
            std::sort(leaves.begin() + ptrdiff_t(first_of(s, leaves.size())),
                      leaves.begin() + ptrdiff_t(first_of(s + 1, leaves.size())),
                      [](vec2 a, vec2 b) { return a.x < b.x; });
        leaves_ = std::move(leaves);
    }
    // Shares in [0, 1): radius and height.
    vec2 at(float height_share, float radius_share) const {
        const size_t slice = std::min(size_t(height_share * float(slice_count_)), slice_count_ - 1);
        const size_t first = first_of(slice, leaves_.size()), last = first_of(slice + 1, leaves_.size());
        return leaves_[std::min(first + size_t(radius_share * float(last - first)), last - 1)];
    }

  private:
    size_t first_of(size_t slice, size_t count) const { return slice * count / slice_count_; }
    size_t slice_count_ = 1;
    std::vector<vec2> leaves_;  // by slices of height, in each by radius
};

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
    const vec3 center = box.center();
    const float radius_m = 0.5f * std::max(box.size().x, box.size().z);
    const uint32_t turn = std::max(settings.turn_places, 1u);
    const double rises_a_place = 1.0 / (double(turn) * double(std::max(settings.turns_per_rise, 1e-3f)));
    const uint32_t limit = uint32_t(places_plant.size());
    const LeafQuantiles quantiles(places_plant, center);
    uint32_t built_size = limit;
    NearestLeaves left(std::move(entries), limit);
    std::vector<NearestLeaves::Neighbor> found;
    for (uint32_t i = 0; left.size() > 0; ++i) {
        const float out = (float(i % turn) + 0.5f) / float(turn);
        const float risen = fraction_of(double(i) * rises_a_place);
        const float height =
            settings.height == DropHeight::sawtooth ? risen : 0.5f + 0.5f * portable_sin(2.0f * k_pi * risen);
        const vec2 at = settings.places == DropPlaces::crown
                            ? quantiles.at(height, out)
                            : vec2(radius_m * std::sqrt(out), box.min.y + box.size().y * height);
        const float around = 2.0f * k_pi * fraction_of(double(i) * k_golden_turns);
        const vec3 place(center.x + at.x * portable_cos(around), at.y,
                         center.z + at.x * portable_sin(around));
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
