#include "plugins/vegetation/eco/stream_tiles.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <cstring>
#include <set>
#include "runtime/core/file.h"
#include "tests/eco/made_tiles.h"

namespace coppice {
namespace {

constexpr TileBlockKind k_kinds[] = {TileBlockKind::cloud, TileBlockKind::plants};

struct LessName {
    bool operator()(const TileBlockName& a, const TileBlockName& b) const {
        return std::tie(a.pack, a.node, a.kind) < std::tie(b.pack, b.node, b.kind);
    }
};
using Names = std::set<TileBlockName, LessName>;

uint64_t bytes_of(const std::vector<TilePack>& packs, TileBlockName name) {
    return bytes_of_block(packs[name.pack].nodes[name.node], name.kind);
}

// All blocks of all packs, in an order that means nothing, with priorities that differ.
std::vector<TileRequest> all_blocks(const std::vector<TilePack>& packs, uint64_t seed = 1) {
    std::vector<TileRequest> requests;
    for (uint32_t p = 0; p < packs.size(); ++p)
        for (uint32_t n = 0; n < packs[p].nodes.size(); ++n)
            for (TileBlockKind kind : k_kinds) requests.push_back({{p, n, kind}, float(requests.size())});
    Random random(seed);
    for (size_t i = requests.size(); i > 1; --i)
        std::swap(requests[i - 1], requests[random.next_below(uint32_t(i))]);
    return requests;
}

class StreamTiles : public testing::Test {
  protected:
    StreamTiles() : folder_("stream_tiles_") {}
    std::string path_of(int pack) const { return folder_.path_of(std::to_string(pack) + ".tiles"); }
    // Two packs, of 1 + 6 + 30 and 1 + 5 + 20 nodes.
    std::vector<TilePack> two_packs(uint32_t points = 60, uint32_t plants = 20) {
        std::vector<TilePack> packs;
        packs.push_back(write_and_open(make_tile_tree(6, 5, points, plants, 1), path_of(0)));
        packs.push_back(write_and_open(make_tile_tree(5, 4, points, plants, 2), path_of(1)));
        return packs;
    }
    ScratchFolder folder_;
};

TEST_F(StreamTiles, HandsOverWhatThePacksHold) {
    const std::vector<TilePack> packs = two_packs();
    for (uint32_t threads : {1u, 2u}) {
        TileStreamer streamer(packs, {.budget_bytes = 1 << 30, .thread_count = threads});
        const std::vector<TileRequest> requests = all_blocks(packs);
        streamer.wanted(requests);
        streamer.wait_until_read();
        std::vector<FinishedTileBlock> finished;
        streamer.take_finished(finished);
        ASSERT_EQ(finished.size(), requests.size());
        uint64_t bytes = 0;
        for (const FinishedTileBlock& one : finished) {
            ASSERT_TRUE(one.status);
            const TilePack& pack = packs[one.block.pack];
            bytes += bytes_of(packs, one.block);
            if (one.block.kind == TileBlockKind::cloud) {
                EXPECT_TRUE(same_clouds(one.cloud, *read_cloud(pack, one.block.node)));
            } else {
                const auto plants = *read_plants(pack, one.block.node);
                ASSERT_EQ(one.plants.positions.size(), plants.positions.size());
                for (size_t i = 0; i < plants.models.size(); ++i)
                    EXPECT_EQ(one.plants.models[i].seed, plants.models[i].seed);
            }
        }
        const TileStreamStatistics statistics = streamer.statistics();
        EXPECT_EQ(statistics.blocks_read, requests.size());
        EXPECT_EQ(statistics.bytes_unpacked, bytes);
        EXPECT_EQ(statistics.resident_bytes, bytes);
        EXPECT_GT(statistics.bytes_read, 0u);
        EXPECT_EQ(statistics.errors + statistics.queued + statistics.reading, 0u);
        EXPECT_EQ(statistics.waiting_bytes, 0u);
    }
}

TEST_F(StreamTiles, ServesTheMostUrgentFirst) {
    const std::vector<TilePack> packs = two_packs();
    TileStreamer streamer(packs, {.budget_bytes = 1 << 30, .thread_count = 1});
    std::vector<TileRequest> requests = all_blocks(packs);
    requests[5].priority = NAN;
    requests.push_back({requests[7].block, 1e9f});  // wanted twice
    streamer.wanted(requests);
    streamer.wait_until_read();
    std::vector<FinishedTileBlock> finished;
    streamer.take_finished(finished);
    ASSERT_EQ(finished.size(), requests.size() - 1);
    EXPECT_EQ(finished.front().block, requests[7].block);
    EXPECT_EQ(finished.back().block, requests[5].block);
    std::vector<TileRequest> sorted(requests.begin(), requests.end() - 1);
    std::erase_if(sorted, [&](const TileRequest& r) {
        return r.block == requests[7].block || r.block == requests[5].block;
    });
    std::sort(sorted.begin(), sorted.end(),
              [](const TileRequest& a, const TileRequest& b) { return a.priority > b.priority; });
    for (size_t i = 0; i < sorted.size(); ++i) EXPECT_EQ(finished[i + 1].block, sorted[i].block) << i;
}

// A reader that never frees anything gets the most urgent that fit, and not a byte more.
TEST_F(StreamTiles, FillsTheBudgetByPriorityAndStops) {
    const std::vector<TilePack> packs = two_packs();
    constexpr uint64_t k_budget = 20'000;
    TileStreamer streamer(packs, {.budget_bytes = k_budget, .thread_count = 2});
    std::vector<TileRequest> requests = all_blocks(packs);
    streamer.wanted(requests);
    streamer.wait_until_read();
    std::vector<FinishedTileBlock> finished;
    streamer.take_finished(finished);
    std::sort(requests.begin(), requests.end(),
              [](const TileRequest& a, const TileRequest& b) { return a.priority > b.priority; });
    uint64_t bytes = 0;
    size_t fit = 0;
    while (bytes + bytes_of(packs, requests[fit].block) <= k_budget)
        bytes += bytes_of(packs, requests[fit++].block);
    EXPECT_EQ(finished.size(), fit);
    Names taken;
    for (const FinishedTileBlock& one : finished) taken.insert(one.block);
    for (size_t i = 0; i < fit; ++i) EXPECT_TRUE(taken.contains(requests[i].block));
    EXPECT_EQ(streamer.statistics().resident_bytes, bytes);
    EXPECT_GT(streamer.statistics().waiting_bytes, 0u);
    for (const FinishedTileBlock& one : finished) streamer.release(one.block);
    EXPECT_EQ(streamer.statistics().resident_bytes, 0u);
}

// Thousands of wishes a round that change every round, a budget for a few: the budget holds all the time, blocks come that
// are wanted now or were when they were begun, and in the end everything has been had.
TEST_F(StreamTiles, ASmallBudgetServesEverythingInTurn) {
    std::vector<TilePack> packs = two_packs(60, 20);
    packs.push_back(write_and_open(make_tile_tree(20, 30, 30, 10, 3), path_of(2)));
    const std::vector<TileRequest> everything = all_blocks(packs);
    ASSERT_GT(everything.size(), 1000u);
    constexpr uint64_t k_budget = 30'000;
    TileStreamer streamer(packs, {.budget_bytes = k_budget, .thread_count = 2});
    Random random(5);
    Names missing, held;
    for (const TileRequest& r : everything) missing.insert(r.block);
    std::vector<FinishedTileBlock> finished;
    std::vector<TileBlockName> evicted;
    std::vector<TileRequest> wishes;
    uint64_t held_bytes = 0;
    int round = 0;
    for (; !missing.empty() && round < 20'000; ++round) {
        wishes.clear();
        for (const TileRequest& r : everything)
            if (missing.contains(r.block) || random.next_below(4) == 0)
                wishes.push_back({r.block, random.next_unit() + (missing.contains(r.block) ? 1.0f : 0.0f)});
        streamer.wanted(wishes);
        ASSERT_LE(streamer.statistics().resident_bytes, k_budget);
        if (round % 3 == 0) streamer.wait_until_read();
        streamer.take_finished(finished);
        for (const FinishedTileBlock& one : finished) {
            ASSERT_TRUE(one.status);
            ASSERT_TRUE(held.insert(one.block).second) << "handed over twice";
            held_bytes += bytes_of(packs, one.block);
            missing.erase(one.block);
        }
        ASSERT_LE(held_bytes, k_budget);
        streamer.suggest_evictions(evicted);
        for (const TileBlockName& name : evicted) {
            ASSERT_EQ(held.erase(name), 1u) << "not ours to release";
            streamer.release(name);
            held_bytes -= bytes_of(packs, name);
        }
    }
    EXPECT_TRUE(missing.empty()) << missing.size() << " left";
    EXPECT_GT(round, 20) << "everything fitted at once: nothing was tested";
}

TEST_F(StreamTiles, WhatIsNotWantedAnyMoreIsNotRead) {
    const std::vector<TilePack> packs = {write_and_open(make_tile_tree(40, 40, 300, 30), path_of(0))};
    const std::vector<TileRequest> requests = all_blocks(packs);
    uint64_t least_read = UINT64_MAX;
    for (uint32_t threads : {1u, 2u})
        for (int attempt = 0; attempt < 10; ++attempt) {
            TileStreamer streamer(packs, {.budget_bytes = uint64_t(1) << 30, .thread_count = threads});
            streamer.wanted(requests);
            streamer.wanted({});
            const TileStreamStatistics now = streamer.statistics();
            EXPECT_EQ(now.queued, 0u);
            streamer.wait_until_read();
            const TileStreamStatistics later = streamer.statistics();
            EXPECT_LE(later.blocks_read, now.blocks_read + now.reading);
            least_read = std::min(least_read, later.blocks_read);
            std::vector<FinishedTileBlock> finished;
            streamer.take_finished(finished);
            EXPECT_EQ(finished.size(), later.blocks_read);
            for (const FinishedTileBlock& one : finished) streamer.release(one.block);
            EXPECT_EQ(streamer.statistics().resident_bytes, 0u);
        }
    EXPECT_LT(least_read, requests.size()) << "all was read before it could be cancelled: nothing was tested";
}

TEST_F(StreamTiles, ABlockIsReadOnceAsLongAsItIsHeld) {
    const std::vector<TilePack> packs = two_packs();
    TileStreamer streamer(packs, {});
    const std::vector<TileRequest> requests = all_blocks(packs);
    std::vector<FinishedTileBlock> finished;
    size_t taken = 0;
    for (int round = 0; round < 50; ++round) {
        streamer.wanted(requests);
        streamer.take_finished(finished);
        taken += finished.size();
    }
    streamer.wait_until_read();
    streamer.take_finished(finished);
    EXPECT_EQ(taken + finished.size(), requests.size());
    EXPECT_EQ(streamer.statistics().blocks_read, requests.size());
}

TEST_F(StreamTiles, ADamagedBlockIsReportedOnceAndNeverReadAgain) {
    std::vector<TilePack> packs = two_packs();
    std::string bytes = *read_text_file(path_of(1));
    const Names damaged{
        {1, 3, TileBlockKind::cloud}, {1, 12, TileBlockKind::plants}, {1, 0, TileBlockKind::cloud}};
    for (const TileBlockName& name : damaged)
        bytes[block_of(packs[1].nodes[name.node], name.kind).offset_bytes + 11] ^= 64;
    ASSERT_TRUE(write_text_file(path_of(1), bytes));
    packs[1] = *open_tile_pack(path_of(1));

    TileStreamer streamer(packs, {.budget_bytes = 1 << 30, .thread_count = 2});
    const std::vector<TileRequest> requests = all_blocks(packs);
    std::vector<FinishedTileBlock> finished;
    Names reported;
    for (int round = 0; round < 5; ++round) {
        streamer.wanted(requests);
        streamer.wait_until_read();
        streamer.take_finished(finished);
        for (const FinishedTileBlock& one : finished) {
            if (one.status) {
                streamer.release(one.block);
                continue;
            }
            EXPECT_TRUE(reported.insert(one.block).second) << "reported twice";
            EXPECT_EQ(one.status.error().file, path_of(1));
            EXPECT_TRUE(one.status.error().place.starts_with("node " + std::to_string(one.block.node)));
        }
    }
    EXPECT_EQ(reported.size(), 3u);
    for (const TileBlockName& name : damaged) EXPECT_TRUE(reported.contains(name));
    EXPECT_EQ(streamer.statistics().errors, 3u);
    EXPECT_EQ(streamer.statistics().blocks_read, 5 * (requests.size() - 3) + 3);
    EXPECT_EQ(streamer.statistics().resident_bytes, 0u);
}

TEST_F(StreamTiles, SuggestsWhatIsUnwantedLongestThenWhatIsLeastWanted) {
    // Four leaves of one size: plants are all the same number.
    MadeTiles made = make_tile_tree(5, 0, 3, 1);
    const std::vector<TilePack> packs = {write_and_open(made, path_of(0))};
    auto name = [](uint32_t node) { return TileBlockName{0, node, TileBlockKind::plants}; };
    for (uint32_t n = 1; n <= 5; ++n) ASSERT_EQ(bytes_of(packs, name(n)), 32u);
    TileStreamer streamer(packs, {.budget_bytes = 4 * 32, .thread_count = 1});
    std::vector<FinishedTileBlock> finished;
    std::vector<TileBlockName> suggested;
    auto turn = [&](std::vector<TileRequest> wishes) {
        streamer.wanted(wishes);
        streamer.wait_until_read();
        streamer.take_finished(finished);
        streamer.suggest_evictions(suggested);
    };
    using Suggested = std::vector<TileBlockName>;
    turn({{name(1), 1}, {name(2), 2}, {name(3), 3}, {name(4), 4}});
    ASSERT_EQ(finished.size(), 4u);
    EXPECT_EQ(suggested, Suggested{}) << "nothing waits";
    turn({{name(2), 9}, {name(3), 3}, {name(4), 4}});
    turn({{name(3), 3}, {name(4), 4}, {name(5), 1}});
    EXPECT_EQ(suggested, Suggested{name(1)}) << "the longest unwanted, though 5 is the least wanted of all";
    turn({{name(1), 7}, {name(2), 9}, {name(3), 3}, {name(4), 4}, {name(5), 1}});
    EXPECT_EQ(suggested, Suggested{}) << "all that is there is wanted more";
    turn({{name(1), 7}, {name(2), 9}, {name(3), 3}, {name(4), 4}, {name(5), 5}});
    EXPECT_EQ(suggested, Suggested{name(3)}) << "the least wanted";
    streamer.release(name(3));
    turn({{name(1), 7}, {name(2), 9}, {name(3), 3}, {name(4), 4}, {name(5), 5}});
    ASSERT_EQ(finished.size(), 1u);
    EXPECT_EQ(finished[0].block, name(5));
    EXPECT_EQ(suggested, Suggested{}) << "no swapping to and fro";
}

TEST_F(StreamTiles, WhatNeverFitsIsCountedAndHoldsUpNothing) {
    const std::vector<TilePack> packs = {write_and_open(make_tile_tree(3, 0, 50, 2), path_of(0))};
    for (uint64_t budget : {uint64_t(0), uint64_t(200)}) {
        TileStreamer streamer(packs, {.budget_bytes = budget, .thread_count = 1});
        streamer.wanted(
            std::vector<TileRequest>{{{0, 1, TileBlockKind::cloud}, 9}, {{0, 1, TileBlockKind::plants}, 1}});
        streamer.wait_until_read();
        std::vector<FinishedTileBlock> finished;
        streamer.take_finished(finished);
        EXPECT_EQ(finished.size(), budget ? 1u : 0u);
        EXPECT_EQ(streamer.statistics().too_large, budget ? 1u : 2u);
        EXPECT_LE(streamer.statistics().resident_bytes, budget);
    }
}

TEST_F(StreamTiles, EndsAtOnceWhileBusy) {
    const std::vector<TilePack> packs = {write_and_open(make_tile_tree(40, 40, 300, 30), path_of(0))};
    const std::vector<TileRequest> requests = all_blocks(packs);
    uint64_t least_read = UINT64_MAX;
    for (int attempt = 0; attempt < 40; ++attempt) {
        TileStreamer streamer(packs, {.budget_bytes = uint64_t(1) << 30, .thread_count = 2});
        streamer.wanted(requests);
        if (attempt % 2) continue;  // the destructor
        streamer.stop();
        streamer.stop();
        const uint64_t read = streamer.statistics().blocks_read;
        least_read = std::min(least_read, read);
        streamer.wanted(requests);
        streamer.wait_until_read();
        EXPECT_EQ(streamer.statistics().blocks_read, read) << "read after the end";
    }
    EXPECT_LT(least_read, requests.size()) << "all was read before the end: nothing was tested";
}

TEST_F(StreamTiles, HasNothingToDoWithoutPacks) {
    TileStreamer streamer({}, {});
    streamer.wanted({});
    streamer.wait_until_read();
    std::vector<FinishedTileBlock> finished(1);
    streamer.take_finished(finished);
    EXPECT_TRUE(finished.empty());
}

}  // namespace
}  // namespace coppice
