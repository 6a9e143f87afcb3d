// The store of entities and their components, by archetype and chunk.
//
// Structural edits (create, destroy, add, remove, chunks) come from one thread at a time, and not while a
// query iterates: systems record them in Commands. They invalidate pointers, spans and ChunkViews. Component
// values may be written by several threads as long as no two touch the same entity's same component. Same
// edits in the same order give the same handles and the same chunks, on any machine.
#pragma once
#include <array>
#include <atomic>
#include <cassert>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>
#include "runtime/ecs/chunk.h"
#include "runtime/ecs/chunk_pool.h"
#include "runtime/ecs/component.h"
#include "runtime/ecs/entity.h"
#include "runtime/ecs/entity_index.h"

namespace coppice {

template <class... Terms>
class Query;

struct WorldSettings {
    size_t shared_chunk_bytes = 16 * 1024;       // chunks of loose entities
    size_t pool_limit_bytes = size_t(64) << 20;  // memory of dropped chunks kept for the next ones
    // Capacities; a call that would pass them makes nothing, counts it in refused_count() and says so.
    uint32_t index_page_limit =
        1u << 22;  // pages of 1,024 entity indices; a bulk chunk takes 1, 2, 4, 8, ...
    uint32_t last_generation = UINT32_MAX;  // an index used that often is retired
};

// The archetypes that have `all` and none of `none`, kept up to date as new ones appear.
struct QueryMatches {
    ComponentMask all;
    ComponentMask none;
    std::vector<const Archetype*> archetypes;
    size_t seen_count = 0;  // archetypes looked at
};

class World {
  public:
    static constexpr uint32_t k_bulk_limit = 1u << 31;  // entities of one bulk chunk

    explicit World(const WorldSettings& settings = {});
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    // Loose entities. No entity comes back when the indices are used up.
    Entity create() { return create_raw({}); }
    template <class... Cs>
    requires(sizeof...(Cs) > 0) Entity create(const Cs&... values) {
        EntityPlace place;
        Entity entity = create_row(component_mask<Cs...>(), place);
        if (entity) (set(place, values), ...);
        return entity;
    }
    // Every component as C{} is.
    template <class... Cs>
    requires(sizeof...(Cs) > 0) Entity create() { return create(Cs{}...); }
    bool alive(Entity entity) const { return index_.find(entity).chunk != nullptr; }
    // False: was not alive.
    bool destroy(Entity entity);

    // Gives the entity the component, or a new value where it has it. False: not alive, or no room. The first
    // one moves the entity to another chunk; taken from a bulk chunk, it is a loose entity from then on.
    template <class C>
    bool add(Entity entity, const C& value = C{}) {
        return add_raw(entity, component_id<C>(), &value);
    }
    // False: not alive or had none.
    template <class C>
    bool remove(Entity entity) {
        return remove_raw(entity, component_id<C>());
    }
    // nullptr: not alive, or has none. A tag's pointer may not be read or written through.
    template <class C>
    C* get(Entity entity) {
        return find<C>(entity);
    }
    template <class C>
    const C* get(Entity entity) const {
        return find<C>(entity);
    }
    template <class C>
    bool has(Entity entity) const {
        return has_raw(entity, component_id<C>());
    }

    // A bulk chunk of exactly `count` entities: its name, then for each component the column to fill, in no
    // defined state (empty for tags). All of it must be written before the next hash() or structural edit.
    //     auto [id, positions, sizes] = world.create_chunk<Position, Size>(1000, tile);
    // The owner is the entity that carries what the whole chunk has in common (bounds, visibility): see Owner
    // in query.h; it may keep the name in a component of its own. No name comes back when the indices are
    // used up, or for more than k_bulk_limit entities. One entity taken out costs about 24 bytes for each of
    // its chunk, once. Throws std::bad_alloc as new does, and has changed nothing then.
    template <class... Cs>
    std::tuple<ChunkId, std::span<Cs>...> create_chunk(uint32_t count, Entity owner = {}) {
        ChunkId id = create_chunk_raw(component_mask<Cs...>(), count, owner);
        return {id, (id ? column<Cs>(id) : std::span<Cs>())...};
    }
    // Destroys the chunk and the entities still in it. False: no such chunk.
    bool destroy_chunk(ChunkId id);
    bool has_chunk(ChunkId id) const { return find_chunk(id) != nullptr; }
    // Requires that the chunk exists.
    ChunkView chunk(ChunkId id) const {
        assert(find_chunk(id) && "no such chunk: it was destroyed, or the name is another world's");
        return ChunkView(*find_chunk(id), id);
    }
    // Empty where the chunk does not exist or lacks the component.
    template <class C>
    std::span<C> column(ChunkId id) {
        const Chunk* chunk = find_chunk(id);
        C* values = chunk ? chunk->column<C>() : nullptr;
        return values ? std::span<C>(values, chunk->count) : std::span<C>();
    }

    // Cheap and without allocation once the same terms were asked for. See query.h. Any thread.
    template <class... Terms>
    Query<Terms...> query();
    template <class... Terms>
    Query<Terms...> query() const;

    // Covers, for every live entity: its handle, its chunk's owner, which hashed components it has, and their
    // bytes (a float's bits: 0 and -0 differ). Independent of the order of chunks, rows and archetypes and of
    // the number of threads. Does not cover what is recorded in Commands, free indices, or names of chunks.
    uint64_t hash() const;

    uint64_t entity_count() const { return index_.alive_count(); }
    // All memory the world holds, with what the pool keeps.
    size_t memory_bytes() const;
    // Gives the memory of dropped chunks back to the system.
    void trim() { pool_.trim(); }
    // Entities and chunks that were not made because a capacity of the settings was reached.
    uint64_t refused_count() const { return refused_count_; }
    uint64_t retired_index_count() const { return index_.retired_count(); }

    // What the templates above and Commands stand on. Values are of the component's size and may be null for
    // zeros.
    Entity create_raw(const ComponentMask& mask);  // components zeroed
    bool add_raw(Entity entity, ComponentId component, const void* value);
    bool remove_raw(Entity entity, ComponentId component);
    bool has_raw(Entity entity, ComponentId component) const;
    ChunkId create_chunk_raw(const ComponentMask& mask, uint32_t count, Entity owner);
    const QueryMatches& matches(const ComponentMask& all, const ComponentMask& none) const;
    ChunkId id_of(const Chunk& chunk) const {
        return chunk.slot == k_shared ? ChunkId{} : ChunkId{chunk.slot, slots_[chunk.slot].generation};
    }
    // While one lives, structural edits are a mistake, and asserted in debug builds.
    class IterationLock {
      public:
        explicit IterationLock(const World& world) : world_(world) { ++world_.iterations_; }
        ~IterationLock() { --world_.iterations_; }
        IterationLock(const IterationLock&) = delete;
        IterationLock& operator=(const IterationLock&) = delete;

      private:
        const World& world_;
    };

  private:
    struct Slot {
        Chunk* chunk = nullptr;
        uint32_t generation = 1;  // 0: used up
    };
    struct MatchesKey {
        ComponentMask all, none;
        bool operator==(const MatchesKey&) const = default;
    };
    struct MatchesKeyHash {
        size_t operator()(const MatchesKey& key) const {
            std::hash<ComponentMask> hash;
            return hash(key.all) * 31 + hash(key.none);
        }
    };
    static constexpr uint32_t k_shared = UINT32_MAX;  // slot of a shared chunk
    static constexpr size_t k_heads_per_block = 64;

    template <class C>
    C* find(Entity entity) const {
        EntityPlace place = index_.find(entity);
        if (!place.chunk) return nullptr;
        if constexpr (std::is_empty_v<C>) {
            static std::remove_const_t<C> tag;
            return place.chunk->archetype->mask[component_id<C>()] ? &tag : nullptr;
        } else {
            C* values = place.chunk->column<C>();
            return values ? values + place.row : nullptr;
        }
    }
    // Requires that the place's archetype has it.
    template <class C>
    static void set(EntityPlace place, const C& value) {
        if constexpr (!std::is_empty_v<C>) place.chunk->column<C>()[place.row] = value;
    }
    const Chunk* find_chunk(ChunkId id) const {
        if (id.slot >= slots_.size() || slots_[id.slot].generation != id.generation) return nullptr;
        return slots_[id.slot].chunk;
    }
    void assert_editable() const {
        assert(iterations_ == 0 && "structural edit while a query iterates: record it in Commands instead");
    }
    // Components not set. No entity when the indices are used up.
    Entity create_row(const ComponentMask& mask, EntityPlace& place);
    Archetype& archetype_of(const ComponentMask& mask);
    Chunk* make_chunk(const Archetype& archetype, uint32_t row_count, bool shared);
    void drop_chunk(Chunk* chunk);
    EntityPlace append_row(Archetype& archetype);
    void remove_row(EntityPlace place);
    void move_entity(Entity entity, EntityPlace from, const ComponentMask& mask);

    WorldSettings settings_;
    ChunkPool pool_;
    EntityIndex index_;
    std::vector<std::unique_ptr<Archetype>> archetypes_;
    std::unordered_map<ComponentMask, Archetype*> archetype_by_mask_;
    Archetype* last_archetype_ = nullptr;          // edits tend to come in runs
    std::vector<std::unique_ptr<Chunk[]>> heads_;  // k_heads_per_block each
    std::vector<Chunk*> free_heads_;
    std::vector<Slot> slots_;
    std::vector<uint32_t> free_slots_;
    uint64_t refused_count_ = 0;
    mutable std::atomic<uint32_t> iterations_{0};
    mutable std::mutex matches_mutex_;
    mutable std::unordered_map<MatchesKey, std::unique_ptr<QueryMatches>, MatchesKeyHash> matches_;
};

}  // namespace coppice

#include "runtime/ecs/query.h"
