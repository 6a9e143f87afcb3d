// Structural edits written down during iteration and carried out later, in the order they were recorded.
// One buffer a system (or a job). Keeps its memory, so a warm frame allocates nothing.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>
#include "runtime/ecs/world.h"

namespace coppice {

// One thread at a time.
class Commands {
  public:
    // The entity returned stands for the one that apply() will make: it may be passed to this buffer's other
    // calls until then, and to nobody else. It counts as no entity (generation 0).
    template <class... Cs>
    Entity create(const Cs&... values) {
        Entity entity = {uint32_t(++created_count_), 0};
        record({Kind::create, uint32_t(sizeof...(Cs)), entity, {}}, nullptr, 0);
        (record_value(entity, values), ...);
        return entity;
    }
    void destroy(Entity entity) { record({Kind::destroy, 0, entity, {}}, nullptr, 0); }
    template <class C>
    void add(Entity entity, const C& value = C{}) {
        record_value(entity, value);
    }
    template <class C>
    void remove(Entity entity) {
        record({Kind::remove, component_id<C>(), entity, {}}, nullptr, 0);
    }
    void destroy_chunk(ChunkId chunk) { record({Kind::destroy_chunk, 0, {}, chunk}, nullptr, 0); }

    bool empty() const { return bytes_.empty(); }
    // Carries everything out and forgets it. Edits of entities and chunks that are gone by then do nothing.
    void apply(World& world);
    // Forgets everything.
    void clear();

  private:
    enum class Kind : uint32_t { create, destroy, add, remove, destroy_chunk };
    // In bytes_: an Edit, then for add the component's value, padded to 8 bytes.
    struct Edit {
        Kind kind;
        uint32_t number;  // create: how many of the following adds belong to it; add, remove: component
        Entity entity;
        ChunkId chunk;
    };

    template <class C>
    void record_value(Entity entity, const C& value) {
        record({Kind::add, component_id<C>(), entity, {}}, &value, std::is_empty_v<C> ? 0 : sizeof(C));
    }
    void record(const Edit& edit, const void* value, size_t size_bytes);
    Entity resolve(Entity entity) const;

    std::vector<std::byte> bytes_;
    std::vector<Entity> created_;  // while applying: by number - 1
    uint64_t created_count_ = 0;
};

}  // namespace coppice
