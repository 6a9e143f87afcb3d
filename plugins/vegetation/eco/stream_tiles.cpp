#include "plugins/vegetation/eco/stream_tiles.h"

#include <algorithm>
#include <cassert>
#include <new>

namespace coppice {

TileStreamer::TileStreamer(std::vector<TilePack> packs, const TileStreamSettings& settings)
    : packs_(std::move(packs)), budget_bytes_(settings.budget_bytes) {
    uint32_t block_count = 0;
    for (const TilePack& pack : packs_) {
        first_block_.push_back(block_count);
        block_count += 2 * uint32_t(pack.nodes.size());
    }
    blocks_.resize(block_count);
    held_.reserve(block_count);
    victims_.reserve(block_count);
    for (uint32_t t = 0; t < std::max(settings.thread_count, 1u); ++t)
        threads_.emplace_back([this](const std::stop_token& stopping) { read_blocks(stopping); });
}

TileStreamer::~TileStreamer() { stop(); }

TileBlockName TileStreamer::name_of(uint32_t block) const {
    const auto behind = std::upper_bound(first_block_.begin(), first_block_.end(), block);
    const uint32_t pack = uint32_t(behind - first_block_.begin()) - 1, within = block - first_block_[pack];
    return {pack, within / 2, TileBlockKind(within % 2)};
}

uint64_t TileStreamer::bytes_of(uint32_t block) const {
    const TileBlockName name = name_of(block);
    return bytes_of_block(packs_[name.pack].nodes[name.node], name.kind);
}

// Afterwards the queue is empty, and what no thread has begun was never asked for.
void TileStreamer::take_back_queue() {
    size_t begun;
    {
        std::lock_guard lock(mutex_);
        begun = std::exchange(next_, 0);
        queue_.swap(spare_queue_);
    }
    for (size_t i = begun; i < spare_queue_.size(); ++i) {
        const uint32_t block = index_of(spare_queue_[i]);
        blocks_[block].state = State::absent;
        resident_bytes_ -= bytes_of(block);
    }
    spare_queue_.clear();
}

// As many as there is room for, strictly by priority: a small block must not take the room that a large one waits for.
void TileStreamer::admit_wishes() {
    waiting_.clear();
    waiting_bytes_ = 0;
    too_large_ = 0;
    for (const Wish& wish : wishes_) {
        Block& block = blocks_[wish.block];
        if (block.wanted_at == turn_) continue;  // wanted twice: the more urgent one counts
        block.wanted_at = turn_;
        block.priority = wish.priority;
        if (block.state != State::absent) continue;
        const uint64_t bytes = bytes_of(wish.block);
        if (bytes > budget_bytes_) {
            ++too_large_;
        } else if (waiting_.empty() && bytes <= budget_bytes_ - resident_bytes_) {
            block.state = State::asked;
            resident_bytes_ += bytes;
            spare_queue_.push_back(name_of(wish.block));
        } else {
            waiting_.push_back(wish);
            waiting_bytes_ += bytes;
        }
    }
}

void TileStreamer::wanted(std::span<const TileRequest> requests) {
    if (stopped_) return;
    ++turn_;
    wishes_.clear();
    for (const TileRequest& request : requests) {
        assert(request.block.pack < packs_.size() &&
               request.block.node < packs_[request.block.pack].nodes.size());
        const float priority = request.priority == request.priority ? request.priority : -INFINITY;
        wishes_.push_back({index_of(request.block), priority});
    }
    std::sort(wishes_.begin(), wishes_.end(), [](const Wish& a, const Wish& b) {
        return a.priority != b.priority ? a.priority > b.priority : a.block < b.block;
    });
    take_back_queue();
    waiting_.reserve(wishes_.capacity());
    spare_queue_.reserve(wishes_.capacity());
    admit_wishes();
    {
        std::lock_guard lock(mutex_);
        queue_.swap(spare_queue_);
    }
    work_.notify_all();
}

void TileStreamer::take_finished(std::vector<FinishedTileBlock>& finished) {
    finished.clear();
    std::list<FinishedTileBlock> taken;
    {
        std::lock_guard lock(mutex_);
        taken.swap(finished_);
    }
    for (FinishedTileBlock& one : taken) {
        const uint32_t index = index_of(one.block);
        Block& block = blocks_[index];
        assert(block.state == State::asked);
        if (one.status) {
            block.state = State::held;
            block.held_at = uint32_t(held_.size());
            held_.push_back(index);
        } else {
            block.state = State::failed;
            resident_bytes_ -= bytes_of(index);
        }
        finished.push_back(std::move(one));
    }
}

void TileStreamer::release(TileBlockName name) {
    const uint32_t index = index_of(name);
    Block& block = blocks_[index];
    assert(block.state == State::held && "it was handed out");
    block.state = State::absent;
    resident_bytes_ -= bytes_of(index);
    held_[block.held_at] = held_.back();
    blocks_[held_.back()].held_at = block.held_at;
    held_.pop_back();
}

void TileStreamer::suggest_evictions(std::vector<TileBlockName>& suggested) {
    suggested.clear();
    if (waiting_.empty()) return;
    victims_.assign(held_.begin(), held_.end());
    std::sort(victims_.begin(), victims_.end(), [this](uint32_t a, uint32_t b) {
        const Block &block_a = blocks_[a], &block_b = blocks_[b];
        if (block_a.wanted_at != block_b.wanted_at) return block_a.wanted_at < block_b.wanted_at;
        return block_a.priority != block_b.priority ? block_a.priority < block_b.priority : a < b;
    });
    uint64_t free_bytes = budget_bytes_ - resident_bytes_;
    auto victim = victims_.begin();
    for (const Wish& wish : waiting_) {
        const uint64_t bytes = bytes_of(wish.block);
        const size_t before = suggested.size();
        for (; free_bytes < bytes && victim != victims_.end(); ++victim) {
            const Block& block = blocks_[*victim];
            if (block.wanted_at == turn_ && block.priority >= wish.priority) break;
            free_bytes += bytes_of(*victim);
            suggested.push_back(name_of(*victim));
        }
        if (free_bytes < bytes) {
            suggested.resize(before);  // what would not make room enough may stay
            return;
        }
        free_bytes -= bytes;
    }
}

void TileStreamer::wait_until_read() {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return next_ == queue_.size() && reading_ == 0; });
}

void TileStreamer::stop() {
    if (stopped_) return;
    take_back_queue();
    stopped_ = true;
    for (std::jthread& thread : threads_) thread.request_stop();
    threads_.clear();
}

TileStreamStatistics TileStreamer::statistics() const {
    TileStreamStatistics statistics;
    {
        std::lock_guard lock(mutex_);
        statistics = counters_;
        statistics.queued = uint32_t(queue_.size() - next_);
        statistics.reading = reading_;
    }
    statistics.resident_bytes = resident_bytes_;
    statistics.waiting_bytes = waiting_bytes_;
    statistics.too_large = too_large_;
    return statistics;
}

FinishedTileBlock TileStreamer::read_block(TileBlockName name) const {
    FinishedTileBlock finished{name, {}, {}, {}};
    const TilePack& pack = packs_[name.pack];
    auto keep = [&finished](auto read, auto& into) {
        if (read)
            into = std::move(*read);
        else
            finished.status = fail(std::move(read.error()));
    };
    try {
        if (name.kind == TileBlockKind::cloud)
            keep(read_cloud(pack, name.node), finished.cloud);
        else
            keep(read_plants(pack, name.node), finished.plants);
    } catch (const std::bad_alloc&) {
        finished.status = fail(ErrorId::limit_exceeded, pack.path, "node " + std::to_string(name.node),
                               "out of memory", "a smaller budget for tiles");
    }
    return finished;
}

void TileStreamer::read_blocks(const std::stop_token& stopping) {
    for (;;) {
        TileBlockName name;
        {
            std::unique_lock lock(mutex_);
            if (!work_.wait(lock, stopping, [this] { return next_ < queue_.size(); })) return;
            if (stopping.stop_requested()) return;
            name = queue_[next_++];
            ++reading_;
        }
        std::list<FinishedTileBlock> finished;
        finished.push_back(read_block(name));
        const PackedTileNode& node = packs_[name.pack].nodes[name.node];
        bool idle;
        {
            std::lock_guard lock(mutex_);
            --reading_;
            ++counters_.blocks_read;
            counters_.bytes_read += block_of(node, name.kind).stored_bytes;
            if (finished.front().status)
                counters_.bytes_unpacked += bytes_of_block(node, name.kind);
            else
                ++counters_.errors;
            finished_.splice(finished_.end(), finished);
            idle = next_ == queue_.size() && reading_ == 0;
        }
        if (idle) idle_.notify_all();
    }
}

}  // namespace coppice
