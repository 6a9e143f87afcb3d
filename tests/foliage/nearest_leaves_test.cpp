#include "plugins/vegetation/cook/nearest_leaves.h"

#include <gtest/gtest.h>
#include <algorithm>
#include "runtime/core/random.h"

namespace coppice {
namespace {

using Neighbor = NearestLeaves::Neighbor;

std::vector<uint32_t> nearest_by_force(const std::vector<NearestLeaves::Entry>& entries, vec3 place,
                                       uint32_t leaf, uint32_t count) {
    std::vector<Neighbor> all;
    for (const NearestLeaves::Entry& e : entries)
        if (e.leaf != leaf) all.push_back({glm::dot(e.place - place, e.place - place), e.leaf});
    std::sort(all.begin(), all.end());
    std::vector<uint32_t> leaves;
    for (size_t i = 0; i < std::min<size_t>(count, all.size()); ++i) leaves.push_back(all[i].leaf);
    return leaves;
}

TEST(NearestLeaves, FindsWhatACompleteSearchFindsWhileLeavesComeAndGo) {
    Random random(1);
    // Few places, so that many are the same and numbers decide.
    auto any_place = [&] {
        const float x = float(random.next_below(7)), y = float(random.next_below(7));
        return vec3(x, y, float(random.next_below(3)));
    };
    std::vector<NearestLeaves::Entry> entries;
    for (uint32_t i = 0; i < 300; ++i) entries.push_back({any_place(), i});
    NearestLeaves nearest(entries, 600);
    std::vector<Neighbor> found;
    for (uint32_t next = 300; entries.size() > 1; ++next) {
        const vec3 place = any_place();
        nearest.find(place, entries[0].leaf, 9, found);
        std::vector<uint32_t> leaves;
        for (const Neighbor& n : found) leaves.push_back(n.leaf);
        ASSERT_EQ(leaves, nearest_by_force(entries, place, entries[0].leaf, 9)) << entries.size() << " left";

        std::swap(entries[random.next_below(uint32_t(entries.size()))], entries.back());
        nearest.remove(entries.back().leaf);
        entries.pop_back();
        NearestLeaves::Entry& changed = entries[random.next_below(uint32_t(entries.size()))];
        const uint32_t before = changed.leaf;
        changed = {any_place() * 1.5f, next};
        nearest.replace(before, changed);
        ASSERT_EQ(nearest.size(), entries.size());
    }
    EXPECT_EQ(nearest.entries().size(), 1u);
    nearest.find(vec3(0), entries[0].leaf, 9, found);
    EXPECT_TRUE(found.empty());
}

TEST(NearestLeaves, NoneAreNoTrouble) {
    NearestLeaves nearest({}, 0);
    std::vector<Neighbor> found{{1.0f, 5}};
    nearest.find(vec3(0), 0, 3, found);
    EXPECT_TRUE(found.empty());
    EXPECT_EQ(nearest.size(), 0u);
}

}  // namespace
}  // namespace coppice
