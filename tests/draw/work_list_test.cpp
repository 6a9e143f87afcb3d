#include "plugins/vegetation/draw/work_list.h"

#include <gtest/gtest.h>
#include <set>

namespace coppice {
namespace {

PartChoice points(uint32_t count, float splat_px = 1.0f, uint32_t owner_min = 0) {
    PartChoice choice;
    choice.points = count;
    choice.splat_px = splat_px;
    choice.point_owner_min = owner_min;
    return choice;
}

TEST(WorkList, EveryPrimitiveStandsInOneEntry) {
    WorkList work;
    work.begin(3);
    std::multiset<uint32_t> expected;
    for (uint32_t part = 0; part < 3; ++part)
        for (uint32_t count : {0u, 1u, 31u, 32u, 33u, 256u, 257u, 5000u}) {
            uint32_t first = part * 100000 + count * 10;
            work.part(part).add({0, first, 0, 0}, points(count), work.part(part).add_instance({}));
            for (uint32_t i = 0; i < count; ++i) expected.insert(first + i);
        }
    std::vector<WorkInstance> instances(100);
    std::vector<WorkEntry> entries(1000);
    WorkList::Size size = work.size();
    WorkList::Layout layout = work.gather(instances, entries);
    EXPECT_EQ(layout.instance_count, size.instances);
    EXPECT_EQ(layout.entry_count, size.entries);
    EXPECT_EQ(layout.dropped_entries, 0u);
    std::multiset<uint32_t> found;
    size_t kind = size_t(WorkKind::points_1);
    for (bool lane : {false, true}) {
        WorkRange range = lane ? layout.picture.lanes[kind] : layout.picture.groups[kind];
        for (uint32_t e = range.first_entry; e < range.first_entry + range.entry_count; ++e) {
            EXPECT_LT(entries[e].instance, layout.instance_count);
            if (lane) {
                EXPECT_LE(entries[e].count, k_primitives_a_lane);
            }
            for (uint32_t i = 0; i < entries[e].count; ++i) found.insert(entries[e].first_vertex + i);
        }
    }
    EXPECT_EQ(found, expected);
}

TEST(WorkList, KindsFollowSizeAndBlend) {
    WorkList work;
    work.begin(1);
    WorkPart& part = work.part(0);
    uint32_t instance = part.add_instance({});
    part.add({}, points(100, 0.4f), instance);
    part.add({}, points(100, 1.7f), instance);
    part.add({}, points(100, 7.0f), instance);
    part.add({}, points(100, 1.0f, 3), instance);
    std::vector<WorkInstance> instances(1);
    std::vector<WorkEntry> entries(10);
    WorkList::Layout layout = work.gather(instances, entries);
    for (WorkKind kind :
         {WorkKind::points_1, WorkKind::points_2, WorkKind::points_any, WorkKind::points_blend})
        EXPECT_EQ(layout.picture.groups[size_t(kind)].entry_count, 1u);
    EXPECT_EQ(part.points, 400u);
}

TEST(WorkList, WhatDoesNotFitIsDroppedAndCounted) {
    WorkList work;
    work.begin(1);
    for (int i = 0; i < 10; ++i) work.part(0).add({}, points(5), work.part(0).add_instance({}));
    std::vector<WorkInstance> instances(4);
    std::vector<WorkEntry> entries(100);
    WorkList::Layout layout = work.gather(instances, entries);
    EXPECT_EQ(layout.instance_count, 4u);
    EXPECT_EQ(layout.entry_count, 4u);
    EXPECT_EQ(layout.dropped_entries, 6u);
    std::vector<WorkEntry> few(3);
    instances.resize(100);
    EXPECT_EQ(work.gather(instances, few).dropped_entries, 7u);
}

// Shadow maps come behind the picture: those that lie within the buffers lack nothing.
TEST(WorkList, SaysWhichMapsAreWhole) {
    WorkList work;
    const size_t map_parts[] = {2, 1, 1};
    work.begin(1, map_parts);
    for (size_t part = 0; part < 5; ++part)
        for (int i = 0; i < 10; ++i) work.part(part).add({}, points(5), work.part(part).add_instance({}));
    auto whole_maps = [&](size_t instance_room, size_t entry_room) {
        std::vector<WorkInstance> instances(instance_room);
        std::vector<WorkEntry> entries(entry_room);
        return work.gather(instances, entries).whole_maps;
    };
    EXPECT_EQ(whole_maps(50, 50), 3u);
    EXPECT_EQ(whole_maps(50, 49), 2u);
    EXPECT_EQ(whole_maps(49, 50), 2u);
    EXPECT_EQ(whole_maps(40, 50), 2u);
    EXPECT_EQ(whole_maps(39, 50), 1u);
    EXPECT_EQ(whole_maps(50, 29), 0u);
    EXPECT_EQ(whole_maps(5, 50), 0u);
}

}  // namespace
}  // namespace coppice
