// Reads blocks of packed tiles while somebody flies over them: the frame says each time what it would like to have, threads
// of the streamer's own read and decompress the most urgent first, and the frame takes what has come. Nothing here waits
// for a disk: the frame's thread sorts its wishes and swaps queues. What is read depends on what was asked for alone, only
// when it comes depends on timing.
#pragma once
#include <condition_variable>
#include <list>
#include <mutex>
#include <span>
#include <thread>
#include <vector>
#include "plugins/vegetation/eco/tile_pack.h"

namespace coppice {

struct TileBlockName {
    uint32_t pack, node;  // pack: index into what the streamer was made of
    TileBlockKind kind;
    bool operator==(const TileBlockName&) const = default;
};

struct TileRequest {
    TileBlockName block;
    float priority;  // greater is read sooner; NaN: last
};

struct TileStreamSettings {
    // Of all blocks that are asked for, being read, or handed out and not yet released, decompressed. Never exceeded; what a
    // thread needs for the block it decompresses comes on top.
    uint64_t budget_bytes = uint64_t(256) << 20;
    uint32_t thread_count = 1;
};

// How much of a world larger than memory is kept at hand.
struct ResidencySettings {
    uint64_t host_bytes = uint64_t(256) << 20;  // of plants, and of clouds
    uint64_t gpu_bytes = uint64_t(256) << 20;   // of clouds
};

struct FinishedTileBlock {
    TileBlockName block;
    Status status;      // after an error the block is not read again, and need not be released
    TileCloud cloud;    // of a cloud
    TilePlants plants;  // of plants
};

struct TileStreamStatistics {
    uint64_t blocks_read = 0, bytes_read = 0, bytes_unpacked = 0;  // since the start; bytes_read as stored
    uint32_t errors = 0;                                           // since the start
    uint32_t queued = 0, reading = 0;                              // blocks, now
    uint64_t resident_bytes = 0;                                   // of the budget
    // Of the last wishes, those the budget has no room for, and those larger than all of it.
    uint64_t waiting_bytes = 0;
    uint32_t too_large = 0;
};

// All calls from one thread, the frame's.
class TileStreamer {
  public:
    TileStreamer(std::vector<TilePack> packs, const TileStreamSettings& settings);
    ~TileStreamer();
    TileStreamer(const TileStreamer&) = delete;
    TileStreamer& operator=(const TileStreamer&) = delete;

    const std::vector<TilePack>& packs() const { return packs_; }

    // All that the frame would like to have, also what it has already, in any order: in place of what was wanted before.
    // What was not begun and is not wanted any more is not read. Requires packs and nodes that exist. Allocates nothing once
    // it was called twice with as many.
    void wanted(std::span<const TileRequest> requests);
    // What has come since the last call, in place of what `finished` held; in the order of priority with one thread. It
    // counts as resident until it is released. Allocates nothing where `finished` has room.
    void take_finished(std::vector<FinishedTileBlock>& finished);
    // Requires a block that was taken without an error and not released since.
    void release(TileBlockName block);

    // What to release so that the wishes that wait have room, in place of what `blocks` held: first what is not wanted now,
    // the longest unwanted first, then what is less wanted than what waits, the least first. Never more than is needed.
    void suggest_evictions(std::vector<TileBlockName>& blocks);

    // Until all that is wanted and has room was read: for pictures that must not depend on timing.
    void wait_until_read();
    // Drops what was not begun and ends the threads as soon as the blocks in hand are read. Wishes after it are ignored.
    void stop();
    TileStreamStatistics statistics() const;

  private:
    enum class State : uint8_t { absent, asked, held, failed };
    struct Block {
        State state = State::absent;
        float priority = 0.0f;  // when it was wanted last
        uint64_t wanted_at = 0;
        uint32_t held_at = 0;  // index into held_
    };
    struct Wish {
        uint32_t block;
        float priority;
    };

    uint32_t index_of(TileBlockName name) const {
        return first_block_[name.pack] + 2 * name.node + uint32_t(name.kind);
    }
    TileBlockName name_of(uint32_t block) const;
    uint64_t bytes_of(uint32_t block) const;
    void take_back_queue();
    void admit_wishes();
    FinishedTileBlock read_block(TileBlockName name) const;
    void read_blocks(const std::stop_token& stopping);

    // Of the frame's thread.
    const std::vector<TilePack> packs_;
    const uint64_t budget_bytes_;
    std::vector<uint32_t> first_block_;  // of each pack; two a node
    std::vector<Block> blocks_;
    std::vector<uint32_t> held_;
    std::vector<Wish> wishes_, waiting_;  // sorted
    std::vector<uint32_t> victims_;
    std::vector<TileBlockName> spare_queue_;
    uint64_t turn_ = 0;  // of wanted()
    uint64_t resident_bytes_ = 0, waiting_bytes_ = 0;
    uint32_t too_large_ = 0;
    bool stopped_ = false;

    // Of all threads, under the mutex, which is never held for longer than swapping takes.
    mutable std::mutex mutex_;
    std::condition_variable_any work_;
    std::condition_variable idle_;
    std::vector<TileBlockName> queue_;
    size_t next_ = 0;  // of queue_, not begun
    uint32_t reading_ = 0;
    std::list<FinishedTileBlock> finished_;
    TileStreamStatistics counters_;

    std::vector<std::jthread> threads_;
};

}  // namespace coppice
