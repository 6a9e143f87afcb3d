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
    static constexpr uint32_t k_absent = UINT32_MAX;

    struct Column {
        ComponentId component;
        uint32_t size_bytes;  // of one value; 0: a tag
        uint32_t row_offset;  // bytes that the columns before take for one row
        uint64_t name_hash;
    };

    ComponentMask mask;
    std::vector<Column> columns;     // by component; tags have none
    std::vector<Column> hash_order;  // hashed components by name hash, with tags
    // Column::row_offset by component; k_absent for tags too.
    std::array<uint32_t, k_component_limit> row_offset;
    uint32_t row_bytes = 0;             // of all columns
    uint32_t shared_capacity = 0;       // rows of a shared chunk
    std::vector<Chunk*> shared_chunks;  // all full but the last
    std::vector<Chunk*> bulk_chunks;    // order of creation, gaps filled from the end
};

// A chunk's head: one cache line, apart from the columns, so that looking up an entity touches few pages.
struct alignas(64) Chunk {
    // Capacities are multiples of it. So is each column's place of 16 bytes at least, and of 64 where the
    // components before it take multiples of 4 bytes.
    static constexpr uint32_t k_row_multiple = 16;

    const Archetype* archetype;
    std::byte* columns;  // column after column, each of `capacity` rows; a shared chunk's entities come last
    Entity* entities;    // by row; null in a bulk chunk nobody took a single entity from
    Entity owner;        // bulk: the entity that speaks for the chunk (its tile); may be none
    uint32_t count;      // rows in use
    uint32_t capacity;   // rows
    uint32_t first_index;  // bulk: entity of row 0, while entities is null
    uint32_t generation;   // bulk: of all its entities, while entities is null
    uint32_t slot;         // bulk: place in the table of chunk names
    uint32_t position;     // place in its archetype's list

    std::byte* value(uint32_t row_offset, uint32_t size_bytes, uint32_t row) const {
        return columns + size_t(row_offset) * capacity + size_t(row) * size_bytes;
    }
    std::byte* value(const Archetype::Column& column, uint32_t row) const {
        return value(column.row_offset, column.size_bytes, row);
    }
    // nullptr where the archetype lacks it, and for tags.
    template <class C>
    C* column() const {
        uint32_t offset = archetype->row_offset[component_id<C>()];
        return offset == Archetype::k_absent ? nullptr
                                             : reinterpret_cast<C*>(columns + size_t(offset) * capacity);
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
