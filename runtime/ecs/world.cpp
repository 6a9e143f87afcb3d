#include "runtime/ecs/world.h"

#include <algorithm>
#include <cstring>
#include <new>
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {
size_t chunk_bytes(const Archetype& archetype, size_t capacity, bool shared) {
    return capacity * (archetype.row_bytes + (shared ? sizeof(Entity) : 0));
}

// Components that only `to` has are left as they are.
void copy_row(const Chunk& from, uint32_t from_row, const Chunk& to, uint32_t to_row) {
    for (const Archetype::Column& column : to.archetype->columns) {
        uint32_t offset = from.archetype->row_offset[column.component];
        if (offset != Archetype::k_absent)
            std::memcpy(to.value(column, to_row), from.value(offset, column.size_bytes, from_row),
                        column.size_bytes);
    }
}
}  // namespace

World::World(const WorldSettings& settings)
    : settings_(settings),
      pool_(settings.pool_limit_bytes),
      index_(pool_, settings.index_page_limit, settings.last_generation) {}

World::~World() {
    for (auto& archetype : archetypes_)
        for (auto* chunks : {&archetype->shared_chunks, &archetype->bulk_chunks})
            for (Chunk* chunk : *chunks) drop_chunk(chunk);
}

Archetype& World::archetype_of(const ComponentMask& mask) {
    if (last_archetype_ && last_archetype_->mask == mask) return *last_archetype_;
    Archetype*& place = archetype_by_mask_[mask];
    last_archetype_ = place;
    if (place) return *place;
    archetypes_.push_back(std::make_unique<Archetype>());
    place = last_archetype_ = archetypes_.back().get();
    place->mask = mask;
    place->row_offset.fill(Archetype::k_absent);
    for (ComponentId component = 0; component < k_component_limit; ++component) {
        if (!mask[component]) continue;
        const ComponentInfo& info = component_info(component);
        Archetype::Column column = {component, info.size_bytes, place->row_bytes, info.name_hash};
        if (info.size_bytes) {
            place->columns.push_back(column);
            place->row_offset[component] = column.row_offset;
            place->row_bytes += info.size_bytes;
        }
        if (info.hashed) place->hash_order.push_back(column);
    }
    std::sort(place->hash_order.begin(), place->hash_order.end(),
              [](const Archetype::Column& a, const Archetype::Column& b) {
                  return a.name_hash != b.name_hash
                             ? a.name_hash < b.name_hash
                             : component_info(a.component).name < component_info(b.component).name;
              });
    // At least the smallest capacity, however small the chunk is set.
    size_t rows = settings_.shared_chunk_bytes / (place->row_bytes + sizeof(Entity));
    place->shared_capacity = uint32_t(std::clamp<size_t>(rows, Chunk::k_row_multiple, 1u << 30)) /
                             Chunk::k_row_multiple * Chunk::k_row_multiple;
    return *place;
}

Chunk* World::make_chunk(const Archetype& archetype, uint32_t row_count, bool shared) {
    if (free_heads_.empty()) {
        heads_.push_back(std::make_unique<Chunk[]>(k_heads_per_block));
        for (size_t i = k_heads_per_block; i-- > 0;) free_heads_.push_back(&heads_.back()[i]);
    }
    size_t capacity =
        (size_t(row_count) + Chunk::k_row_multiple - 1) / Chunk::k_row_multiple * Chunk::k_row_multiple;
    size_t size = chunk_bytes(archetype, capacity, shared);
    auto* columns = size ? static_cast<std::byte*>(pool_.allocate(size)) : nullptr;
    Chunk* chunk = free_heads_.back();
    free_heads_.pop_back();
    *chunk = {.archetype = &archetype, .columns = columns, .capacity = uint32_t(capacity), .slot = k_shared};
    if (shared) chunk->entities = reinterpret_cast<Entity*>(columns + capacity * archetype.row_bytes);
    return chunk;
}

void World::drop_chunk(Chunk* chunk) {
    bool shared = chunk->slot == k_shared;
    if (!shared && chunk->entities) pool_.release(chunk->entities, sizeof(Entity) * chunk->capacity);
    if (chunk->columns)
        pool_.release(chunk->columns, chunk_bytes(*chunk->archetype, chunk->capacity, shared));
    free_heads_.push_back(chunk);
}

// The row's components and entity are not set.
EntityPlace World::append_row(Archetype& archetype) {
    auto& chunks = archetype.shared_chunks;
    if (chunks.empty() || chunks.back()->count == chunks.back()->capacity) {
        chunks.push_back(make_chunk(archetype, archetype.shared_capacity, true));
        chunks.back()->position = uint32_t(chunks.size() - 1);
    }
    return {chunks.back(), chunks.back()->count++};
}

// The last row of the archetype's shared chunks, or of the bulk chunk, takes the place.
void World::remove_row(EntityPlace place) {
    Chunk* chunk = place.chunk;
    auto& chunks = const_cast<Archetype*>(chunk->archetype)->shared_chunks;
    Chunk* last = chunk->slot == k_shared ? chunks.back() : chunk;
    uint32_t last_row = last->count - 1;
    if (last != chunk || last_row != place.row) {
        copy_row(*last, last_row, *chunk, place.row);
        chunk->entities[place.row] = last->entities[last_row];
        index_.move(chunk->entities[place.row], chunk, place.row);
    }
    --last->count;
    if (last->slot == k_shared && last->count == 0) {
        chunks.pop_back();
        drop_chunk(last);
    }
}

Entity World::create_row(const ComponentMask& mask, EntityPlace& place) {
    assert_editable();
    place = append_row(archetype_of(mask));
    Entity entity = index_.claim(place.chunk, place.row);
    place.chunk->entities[place.row] = entity;
    if (!entity) {
        ++refused_count_;
        remove_row(place);
    }
    return entity;
}

Entity World::create_raw(const ComponentMask& mask) {
    EntityPlace place;
    Entity entity = create_row(mask, place);
    if (entity)
        for (const Archetype::Column& column : place.chunk->archetype->columns)
            std::memset(place.chunk->value(column, place.row), 0, column.size_bytes);
    return entity;
}

bool World::destroy(Entity entity) {
    assert_editable();
    EntityPlace place = index_.find(entity);
    if (!place.chunk) return false;
    if (!place.chunk->entities) index_.add_records(place.chunk);
    remove_row(place);
    index_.release(entity);
    return true;
}

void World::move_entity(Entity entity, EntityPlace from, const ComponentMask& mask) {
    if (!from.chunk->entities) index_.add_records(from.chunk);
    EntityPlace to = append_row(archetype_of(mask));
    copy_row(*from.chunk, from.row, *to.chunk, to.row);
    to.chunk->entities[to.row] = entity;
    index_.move(entity, to.chunk, to.row);
    remove_row(from);
}

bool World::add_raw(Entity entity, ComponentId component, const void* value) {
    EntityPlace place = index_.find(entity);
    if (!place.chunk) return false;
    if (!place.chunk->archetype->mask[component]) {
        assert_editable();
        ComponentMask mask = place.chunk->archetype->mask;
        move_entity(entity, place, mask.set(component));
        place = index_.find(entity);
    }
    if (uint32_t size = component_info(component).size_bytes) {
        std::byte* target =
            place.chunk->value(place.chunk->archetype->row_offset[component], size, place.row);
        value ? std::memcpy(target, value, size) : std::memset(target, 0, size);
    }
    return true;
}

bool World::remove_raw(Entity entity, ComponentId component) {
    assert_editable();
    EntityPlace place = index_.find(entity);
    if (!place.chunk || !place.chunk->archetype->mask[component]) return false;
    ComponentMask mask = place.chunk->archetype->mask;
    move_entity(entity, place, mask.reset(component));
    return true;
}

bool World::has_raw(Entity entity, ComponentId component) const {
    EntityPlace place = index_.find(entity);
    return place.chunk && place.chunk->archetype->mask[component];
}

ChunkId World::create_chunk_raw(const ComponentMask& mask, uint32_t count, Entity owner) {
    assert_editable();
    // Before memory is asked for, which an absurd count might get or not.
    if (count > k_bulk_limit || !index_.has_room(count)) {
        refused_count_ += count;
        return {};
    }
    Archetype& archetype = archetype_of(mask);
    Chunk* chunk = make_chunk(archetype, count, false);
    chunk->count = count;
    chunk->owner = owner;
    index_.claim_run(chunk);
    if (free_slots_.empty()) {
        free_slots_.push_back(uint32_t(slots_.size()));
        slots_.emplace_back();
    }
    chunk->slot = free_slots_.back();
    free_slots_.pop_back();
    slots_[chunk->slot].chunk = chunk;
    chunk->position = uint32_t(archetype.bulk_chunks.size());
    archetype.bulk_chunks.push_back(chunk);
    return {chunk->slot, slots_[chunk->slot].generation};
}

bool World::destroy_chunk(ChunkId id) {
    assert_editable();
    Chunk* chunk = const_cast<Chunk*>(find_chunk(id));
    if (!chunk) return false;
    if (chunk->entities) {
        for (uint32_t row = 0; row < chunk->count; ++row) index_.release(chunk->entities[row]);
    } else {
        index_.release_run(chunk);
    }
    auto& chunks = const_cast<Archetype*>(chunk->archetype)->bulk_chunks;
    chunks[chunk->position] = chunks.back();
    chunks[chunk->position]->position = chunk->position;
    chunks.pop_back();
    Slot& slot = slots_[id.slot];
    slot.chunk = nullptr;
    slot.generation = slot.generation == settings_.last_generation ? 0 : slot.generation + 1;
    if (slot.generation) free_slots_.push_back(id.slot);
    drop_chunk(chunk);
    return true;
}

const QueryMatches& World::matches(const ComponentMask& all, const ComponentMask& none) const {
    std::lock_guard lock(matches_mutex_);
    auto& place = matches_[{all, none}];
    if (!place) place = std::make_unique<QueryMatches>(QueryMatches{all, none, {}, 0});
    for (; place->seen_count < archetypes_.size(); ++place->seen_count) {
        const Archetype& archetype = *archetypes_[place->seen_count];
        if ((archetype.mask & all) == all && (archetype.mask & none).none())
            place->archetypes.push_back(&archetype);
    }
    return *place;
}

uint64_t World::hash() const {
    // A sum of one well mixed word an entity does not depend on their order, so nothing needs sorting.
    std::atomic<uint64_t> sum{0};
    auto hash_chunk = [&](const Chunk& chunk) {
        uint64_t chunk_sum = 0;
        for (uint32_t row = 0; row < chunk.count; ++row) {
            uint64_t hash = hash_combine(chunk.entity(row).bits(), chunk.owner.bits());
            for (const Archetype::Column& column : chunk.archetype->hash_order) {
                hash = hash_combine(hash, column.name_hash);
                if (column.size_bytes) hash = hash_bytes(chunk.value(column, row), column.size_bytes, hash);
            }
            chunk_sum += hash;
        }
        sum += chunk_sum;
    };
    for (const auto& archetype : archetypes_)
        for (const auto* chunks : {&archetype->shared_chunks, &archetype->bulk_chunks})
            parallel_for(chunks->size(), 16, [&](size_t first, size_t last) {
                for (size_t i = first; i < last; ++i) hash_chunk(*(*chunks)[i]);
            });
    return hash_combine(sum, entity_count());
}

size_t World::memory_bytes() const {
    size_t size = sizeof(*this) + pool_.used_bytes() + pool_.kept_bytes() + index_.memory_bytes() +
                  heads_.size() * k_heads_per_block * sizeof(Chunk) +
                  free_heads_.capacity() * sizeof(Chunk*) + slots_.capacity() * sizeof(Slot) +
                  free_slots_.capacity() * sizeof(uint32_t);
    for (const auto& archetype : archetypes_)
        size +=
            sizeof(Archetype) +
            (archetype->shared_chunks.capacity() + archetype->bulk_chunks.capacity()) * sizeof(Chunk*) +
            (archetype->columns.capacity() + archetype->hash_order.capacity()) * sizeof(Archetype::Column);
    return size;
}

}  // namespace coppice
