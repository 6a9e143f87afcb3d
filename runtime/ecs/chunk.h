// Entities with the same components, stored column by column in one piece of memory.
//
// A shared chunk has a fixed byte size and takes whatever loose entities come. A bulk chunk is made for
// exactly N entities in one call (a tile's content) and dropped whole. As long as no single entity was taken
// out of a bulk chunk, entity = first index + row, all of one generation, and nothing at all is stored by
// entity.
#pragma once
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>
#include "runtime/ecs/component.h"
#include "runtime/ecs/entity.h"

namespace coppice {

// The name of a bulk chunk. Stale names stay dead, as with Entity.
struct ChunkId {
    uint32_t slot = 0;
    uint32_t generation = 0;  // 0: no chunk

    explicit operator bool() const { return generation != 0; }
    friend auto operator<=>(const ChunkId&, const ChunkId&) = default;
};

struct Chunk;

// All chunks of one set of components.
struct Archetype {
    static constexpr uint8_t k_absent = 0xff;

    ComponentMask mask;
    std::vector<ComponentId> columns;                  // stored components by id; tags have none
    std::vector<ComponentId> hash_order;               // hashed components by name hash, with tags
    std::array<uint8_t, k_component_limit> column_of;  // component -> column, k_absent for tags too
    std::vector<Chunk*> shared_chunks;                 // all full but the last
    std::vector<Chunk*> bulk_chunks;                   // order of creation, gaps filled from the end
    uint32_t shared_capacity = 0;                      // rows of a shared chunk
};

// The head of a chunk's memory. After it the offset of every column, then the columns, each at a multiple of
// 64 bytes.
struct Chunk {
    static constexpr size_t k_column_alignment = 64;

    size_t size_bytes;     // of the whole allocation
    uint32_t capacity;     // rows
    uint32_t slot;         // bulk: place in the table of chunk names
    uint32_t position;     // place in its archetype's list
    uint32_t first_index;  // bulk: entity of row 0, while entities is null
    uint32_t generation;   // bulk: of all its entities, while entities is null
    uint32_t count;        // rows in use
    Entity owner;          // bulk: the entity that speaks for the chunk (its tile); may be none
    Entity* entities;      // by row; null in a bulk chunk nobody took a single entity from
    const Archetype* archetype;
    // Here: uint32_t column_offset[archetype->columns.size()], in units of k_column_alignment from the
    // chunk's start.

    uint32_t* column_offsets() { return reinterpret_cast<uint32_t*>(this + 1); }
    const uint32_t* column_offsets() const { return reinterpret_cast<const uint32_t*>(this + 1); }
    std::byte* column(uint32_t column) const {
        return const_cast<std::byte*>(reinterpret_cast<const std::byte*>(this)) +
               size_t(column_offsets()[column]) * k_column_alignment;
    }
    // nullptr where the archetype lacks it, and for tags.
    template <class C>
    C* column() const {
        uint8_t place = archetype->column_of[component_id<C>()];
        return place == Archetype::k_absent ? nullptr : reinterpret_cast<C*>(column(place));
    }
    Entity entity(uint32_t row) const {
        return entities ? entities[row] : Entity{first_index + row, generation};
    }
};

// What a query's callback sees of a chunk. Valid until the next structural edit.
class ChunkView {
  public:
    explicit ChunkView(const Chunk& chunk, ChunkId id) : chunk_(&chunk), id_(id) {}
    uint32_t size() const { return chunk_->count; }
    Entity entity(uint32_t row) const { return chunk_->entity(row); }
    Entity owner() const { return chunk_->owner; }
    ChunkId id() const { return id_; }  // none for a shared chunk
    bool has(ComponentId component) const { return chunk_->archetype->mask[component]; }

  private:
    const Chunk* chunk_;
    ChunkId id_;
};

}  // namespace coppice
