#include "runtime/ecs/entity_index.h"

#include <algorithm>
#include <cassert>

namespace coppice {

EntityIndex::EntityIndex(ChunkPool& pool, uint32_t page_limit, uint32_t last_generation)
    : pool_(pool),
      page_limit_(std::min(page_limit, 1u << (32 - k_page_shift))),
      last_generation_(std::max(last_generation, 1u)) {}

EntityIndex::~EntityIndex() {
    for (uint32_t page = 0; page < pages_.size(); page += 1u << runs_[page].size_class)
        if (pages_[page].records) pool_.release(pages_[page].records, record_bytes(page));
}

uint32_t EntityIndex::claim_pages(uint32_t size_class) {
    uint32_t page_count = 1u << size_class;
    if (!free_runs_[size_class].empty()) {
        uint32_t page = free_runs_[size_class].back();
        free_runs_[size_class].pop_back();
        return page;
    }
    uint32_t first = uint32_t(pages_.size());
    if (page_count > page_limit_ - std::min(first, page_limit_)) return k_none;
    pages_.resize(first + page_count);
    runs_.resize(first + page_count);
    runs_[first].size_class = uint8_t(size_class);
    for (uint32_t i = 0; i < page_count; ++i) pages_[first + i].first_index = first << k_page_shift;
    return first;
}

// The page's generation is that of the next entities here; 0 when there are none left.
void EntityIndex::release_pages(uint32_t first_page) {
    Page& page = pages_[first_page];
    Run& run = runs_[first_page];
    if (page.records) pool_.release(page.records, record_bytes(first_page));
    for (uint32_t i = 0; i < 1u << run.size_class; ++i) {
        pages_[first_page + i].records = nullptr;
        pages_[first_page + i].chunk = nullptr;
        pages_[first_page + i].row_count = 0;
    }
    run.free_slot = k_none;
    run.loose = false;
    if (page.generation)
        free_runs_[run.size_class].push_back(first_page);
    else
        retired_count_ += uint64_t(k_page_size) << run.size_class;
}

void EntityIndex::link(uint32_t page) {
    runs_[page].previous = k_none;
    runs_[page].next = open_page_;
    if (open_page_ != k_none) runs_[open_page_].previous = page;
    open_page_ = page;
}

void EntityIndex::unlink(uint32_t page) {
    Run& run = runs_[page];
    (run.previous == k_none ? open_page_ : runs_[run.previous].next) = run.next;
    if (run.next != k_none) runs_[run.next].previous = run.previous;
}

Entity EntityIndex::claim(Chunk* chunk, uint32_t row) {
    if (open_page_ == k_none) {
        uint32_t number = claim_pages(0);
        if (number == k_none) return {};
        Page& page = pages_[number];
        page.records = static_cast<Record*>(pool_.allocate(sizeof(Record) * k_page_size));
        for (uint32_t slot = 0; slot < k_page_size; ++slot)
            page.records[slot] = {nullptr, slot + 1 < k_page_size ? slot + 1 : k_none, page.generation};
        runs_[number].free_slot = 0;
        runs_[number].loose = true;
        link(number);
    }
    uint32_t number = open_page_;
    Run& run = runs_[number];
    uint32_t slot = run.free_slot;
    Record& record = pages_[number].records[slot];
    run.free_slot = record.row;
    if (run.free_slot == k_none) unlink(number);
    record.chunk = chunk;
    record.row = row;
    ++run.alive_count;
    ++alive_count_;
    return {number << k_page_shift | slot, record.generation};
}

bool EntityIndex::has_room(uint32_t count) const {
    uint32_t size_class = size_class_of(count);
    return count == 0 || !free_runs_[size_class].empty() ||
           1u << size_class <= page_limit_ - std::min(page_limit_, uint32_t(pages_.size()));
}

void EntityIndex::claim_run(Chunk* chunk) {
    chunk->first_index = 0;
    chunk->generation = 0;
    if (chunk->count == 0) return;
    assert(has_room(chunk->count) && "ask has_room first");
    uint32_t page_count = (chunk->count - 1) / k_page_size + 1;
    uint32_t first = claim_pages(size_class_of(chunk->count));
    uint32_t generation = pages_[first].generation;
    for (uint32_t i = 0; i < page_count; ++i) {
        Page& page = pages_[first + i];
        page.chunk = chunk;
        page.generation = generation;
        page.row_count = chunk->count;
    }
    runs_[first].alive_count = chunk->count;
    alive_count_ += chunk->count;
    chunk->first_index = first << k_page_shift;
    chunk->generation = generation;
}

void EntityIndex::release_run(const Chunk* chunk) {
    assert(!chunk->entities && "a chunk with records gives its entities back one by one");
    if (chunk->count == 0) return;
    uint32_t first = chunk->first_index >> k_page_shift;
    Page& page = pages_[first];
    page.generation = page.generation == last_generation_ ? 0 : page.generation + 1;
    alive_count_ -= chunk->count;
    runs_[first].alive_count = 0;
    release_pages(first);
}

void EntityIndex::add_records(Chunk* chunk) {
    uint32_t first = chunk->first_index >> k_page_shift;
    uint32_t page_count = 1u << runs_[first].size_class;
    auto* records = static_cast<Record*>(pool_.allocate(record_bytes(first)));
    for (uint32_t slot = 0; slot < page_count << k_page_shift; ++slot)
        records[slot] = slot < chunk->count ? Record{chunk, slot, chunk->generation}
                                            : Record{nullptr, k_none, chunk->generation};
    chunk->entities = static_cast<Entity*>(pool_.allocate(sizeof(Entity) * chunk->capacity));
    for (uint32_t row = 0; row < chunk->count; ++row)
        chunk->entities[row] = {chunk->first_index + row, chunk->generation};
    for (uint32_t i = 0; i < page_count; ++i) pages_[first + i].records = records + size_t(i) * k_page_size;
}

void EntityIndex::move(Entity entity, Chunk* chunk, uint32_t row) {
    Page& page = pages_[entity.index >> k_page_shift];
    assert(page.records && "entities of a bulk chunk move after add_records");
    Record& record = page.records[entity.index & (k_page_size - 1)];
    record.chunk = chunk;
    record.row = row;
}

void EntityIndex::release(Entity entity) {
    Page& page = pages_[entity.index >> k_page_shift];
    assert(page.records && "entities of a bulk chunk are released after add_records");
    uint32_t slot = entity.index & (k_page_size - 1);
    uint32_t first = page.first_index >> k_page_shift;
    Page& head = pages_[first];
    Run& run = runs_[first];
    Record& record = page.records[slot];
    uint32_t next = entity.generation == last_generation_ ? 0 : entity.generation + 1;
    record = {nullptr, k_none, next};
    if (head.generation) head.generation = next ? std::max(head.generation, next) : 0;
    --run.alive_count;
    --alive_count_;
    if (run.loose && next) {
        if (run.free_slot == k_none) link(first);
        record.row = run.free_slot;
        run.free_slot = slot;
    }
    if (run.alive_count) return;
    bool linked = run.loose && run.free_slot != k_none;
    // The last open page stays, so that one entity coming and going does not make and drop a page each time.
    if (linked && head.generation && open_page_ == first && run.next == k_none) return;
    if (linked) unlink(first);
    release_pages(first);
}

size_t EntityIndex::memory_bytes() const {
    size_t size = pages_.capacity() * sizeof(Page) + runs_.capacity() * sizeof(Run);
    for (const auto& runs : free_runs_) size += runs.capacity() * sizeof(uint32_t);
    return size;
}

}  // namespace coppice
