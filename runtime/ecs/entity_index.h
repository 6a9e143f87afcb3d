// Where each entity is: handle -> page of 1,024 indices -> chunk and row.
//
// A run of pages belongs either to one bulk chunk, and then row = index - first index and nothing is stored
// by entity; or it has a record by entity. A bulk chunk's run gets records when a single entity of it is
// destroyed or moved. Runs are 2^n pages long and come back whole, with a higher generation, when none of
// their entities is alive.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <vector>
#include "runtime/ecs/chunk.h"
#include "runtime/ecs/chunk_pool.h"
#include "runtime/ecs/entity.h"

namespace coppice {

struct EntityPlace {
    Chunk* chunk = nullptr;  // nullptr: not alive
    uint32_t row = 0;
};

// find() may be called from any number of threads while nobody calls anything else.
class EntityIndex {
  public:
    static constexpr uint32_t k_page_shift = 10;
    static constexpr uint32_t k_page_size = 1u << k_page_shift;

    // Hands out indices below page_limit * k_page_size and generations up to last_generation.
    EntityIndex(ChunkPool& pool, uint32_t page_limit, uint32_t last_generation);
    ~EntityIndex();
    EntityIndex(const EntityIndex&) = delete;
    EntityIndex& operator=(const EntityIndex&) = delete;

    EntityPlace find(Entity entity) const {
        uint32_t number = entity.index >> k_page_shift;
        if (number >= pages_.size()) return {};
        const Page& page = pages_[number];
        if (page.records) {
            const Record& record = page.records[entity.index & (k_page_size - 1)];
            return record.generation == entity.generation ? EntityPlace{record.chunk, record.row}
                                                          : EntityPlace{};
        }
        uint32_t row = entity.index - page.first_index;
        return page.generation == entity.generation && row < page.row_count ? EntityPlace{page.chunk, row}
                                                                            : EntityPlace{};
    }

    // One loose entity. None when the indices are used up.
    Entity claim(Chunk* chunk, uint32_t row);
    // All entities of a bulk chunk: sets its first_index and generation. Requires has_room(chunk->count).
    void claim_run(Chunk* chunk);
    bool has_room(uint32_t count) const;
    // Gives the chunk's entities an id column and a record each.
    void add_records(Chunk* chunk);
    // The entity must be alive and have a record.
    void move(Entity entity, Chunk* chunk, uint32_t row);
    void release(Entity entity);
    // All that a bulk chunk without records has.
    void release_run(const Chunk* chunk);

    uint64_t alive_count() const { return alive_count_; }
    // Indices that will never come back, because their generations are used up.
    uint64_t retired_count() const { return retired_count_; }
    size_t memory_bytes() const;  // without what lies in the pool

  private:
    struct Record {
        Chunk* chunk;         // nullptr: free
        uint32_t row;         // free in a page for loose entities: next free slot
        uint32_t generation;  // free: the next to be given; 0: used up
    };
    // What find() reads. A run's first page speaks for the run in generation, and in Run.
    struct Page {
        Record* records = nullptr;
        Chunk* chunk = nullptr;
        uint32_t first_index = 0;  // of the run
        uint32_t generation = 1;   // records: the highest a freed slot would get; 0: one of them is used up
        uint32_t row_count = 0;    // bulk: entities of the whole run
    };
    struct Run {
        uint32_t alive_count = 0;
        uint32_t next = k_none;  // loose pages with a free slot, doubly linked
        uint32_t previous = k_none;
        uint32_t free_slot = k_none;
        uint8_t size_class = 0;  // 2^size_class pages
        bool loose = false;      // takes loose entities
    };
    static constexpr uint32_t k_none = UINT32_MAX;

    static uint32_t size_class_of(uint32_t count) {
        return count ? uint32_t(std::bit_width((count - 1) >> k_page_shift)) : 0;
    }
    uint32_t claim_pages(uint32_t size_class);  // first page, or k_none
    void release_pages(uint32_t first_page);
    void link(uint32_t page);
    void unlink(uint32_t page);
    size_t record_bytes(uint32_t first_page) const {
        return (sizeof(Record) << k_page_shift) << runs_[first_page].size_class;
    }

    ChunkPool& pool_;
    uint32_t page_limit_;
    uint32_t last_generation_;
    std::vector<Page> pages_;
    std::vector<Run> runs_;                            // by first page
    std::array<std::vector<uint32_t>, 32> free_runs_;  // by size class, last out first in
    uint32_t open_page_ = k_none;                      // first of the loose pages with a free slot
    uint64_t alive_count_ = 0;
    uint64_t retired_count_ = 0;
};

}  // namespace coppice
