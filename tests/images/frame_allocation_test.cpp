// From culling to the recorded passes a frame must not touch the heap once it is warm: on any thread.
#include "tests/images/hills.h"
#include "tests/count_allocations.h"

namespace coppice {
namespace {

TEST(FrameAllocation, WarmFramesAllocateNothing) {
    auto hills = Hills::create({});
    ASSERT_TRUE(hills) << to_string(hills.error());
    (*hills)->count_allocations = [] { return test::g_allocation_count.load(); };
    for (uint64_t budget : {uint64_t(0), uint64_t(120'000)}) {
        FrameSettings settings;
        settings.vertex_budget = budget;
        settings.time_budget_ms = budget > 0 ? 30.0f : 0.0f;
        // There and back, turning, with cuts where it starts again.
        auto fly = [&] {
            (*hills)->allocations = 0;
            for (uint32_t frame = 0; frame < 40; ++frame) {
                const float on = float(frame) / 40.0f;
                const Camera camera = (*hills)->camera_at(-150.0f + 300.0f * on, 80.0f * on,
                                                          2.0f + 20.0f * on, 5.0f * on, -0.1f);
                const auto drawn = (*hills)->draw(camera, settings);
                ASSERT_TRUE(drawn) << to_string(drawn.error());
                (*hills)->vegetation->set_frame_ms(0, 20.0);
            }
        };
        fly();
        if (budget == 0) {
            EXPECT_GT((*hills)->allocations, 0u) << "the count counts";
        }
        // Which shadow maps are left from the flight before differs from the first to the second.
        fly();
        fly();
        EXPECT_EQ((*hills)->allocations, 0u) << "budget " << budget;
        EXPECT_GT((*hills)->vegetation->report().work_entries, 0u);
    }
}

}  // namespace
}  // namespace coppice
