// The frame's part of streaming must not touch the heap once it is warm; the streamer's threads may.
#include <gtest/gtest.h>
#include "plugins/vegetation/eco/stream_tiles.h"
#include "tests/eco/made_tiles.h"
#include "tests/count_allocations.h"

namespace coppice {
namespace {

TEST(StreamTilesAllocation, WarmFramesAllocateNothing) {
    ScratchFolder folder("stream_tiles_allocation_");
    const std::vector<TilePack> packs = {
        write_and_open(make_tile_tree(20, 10, 60, 20), folder.path_of("a.tiles"))};
    TileStreamer streamer(packs, {.budget_bytes = 100'000, .thread_count = 1});
    Random random(1);
    std::vector<TileRequest> wishes;
    std::vector<FinishedTileBlock> finished;
    std::vector<TileBlockName> evicted;
    wishes.reserve(300);
    finished.reserve(2 * packs[0].nodes.size());
    evicted.reserve(2 * packs[0].nodes.size());
    size_t taken = 0;
    auto frame = [&] {
        wishes.clear();
        while (wishes.size() < 300)
            wishes.push_back(
                {{0, random.next_below(uint32_t(packs[0].nodes.size())), TileBlockKind(random.next_below(2))},
                 random.next_unit()});
        streamer.wanted(wishes);
        streamer.wait_until_read();
        streamer.take_finished(finished);
        taken += finished.size();
        streamer.suggest_evictions(evicted);
        for (const TileBlockName& name : evicted) streamer.release(name);
    };
    const size_t at_start = test::t_thread_allocation_count;
    frame();
    EXPECT_GT(test::t_thread_allocation_count, at_start) << "the counter does not count";
    frame();
    const size_t warm = test::t_thread_allocation_count;
    for (int i = 0; i < 200; ++i) frame();
    EXPECT_EQ(test::t_thread_allocation_count, warm);
    EXPECT_GT(taken, 1000u) << "nothing was streamed";
}

}  // namespace
}  // namespace coppice
