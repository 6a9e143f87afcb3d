#include "runtime/ecs/world.h"

#include <algorithm>
#include <cstring>
#include <new>
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {
constexpr size_t k_align = Chunk::k_column_alignment;

constexpr size_t round_up(size_t size_bytes) { return (size_bytes + k_align - 1) / k_align * k_align; }

size_t head_bytes(const Archetype& archetype) {
    return round_up(sizeof(Chunk) + archetype.columns.size() * sizeof(uint32_t));
}

size_t chunk_bytes(const Archetype& archetype, size_t capacity, bool with_entities) {
    size_t size = head_bytes(archetype);
    for (ComponentId component : archetype.columns)
        size += round_up(capacity * component_info(component).size_bytes);
    return with_entities ? size + round_up(capacity * sizeof(Entity)) : size;
}

void copy_row(const Chunk& from, uint32_t from_row, const Chunk& to, uint32_t to_row) {
    const std::vector<ComponentId>& columns = to.archetype->columns;
    for (uint32_t column = 0; column < columns.size(); ++column) {
        size_t size = component_info(columns[column]).size_bytes;
        std::byte* target = to.column(column) + to_row * size;
        uint8_t source = from.archetype->column_of[columns[column]];
        if (source == Archetype::k_absent)
            std::memset(target, 0, size);
        else
            std::memcpy(target, from.column(source) + from_row * size, size);
    }
}
}  // namespace

World::World(const WorldSettings& settings)
    : settings_(settings),
      pool_(settings.pool_limit_bytes),
      index_(pool_, settings.index_page_limit, settings.last_generation) {}

World::~World() {
    for (auto& archetype : archetypes_) {
        for (Chunk* chunk : archetype->shared_chunks) pool_.release(chunk, chunk->size_bytes);
        for (Chunk* chunk : archetype->bulk_chunks) {
            if (chunk->entities) pool_.release(chunk->entities, sizeof(Entity) * chunk->capacity);
            pool_.release(chunk, chunk->size_bytes);
        }
    }
}

Archetype& World::archetype_of(const ComponentMask& mask) {
    Archetype*& place = archetype_by_mask_[mask];
    if (place) return *place;
    archetypes_.push_back(std::make_unique<Archetype>());
    place = archetypes_.back().get();
    place->mask = mask;
    place->column_of.fill(Archetype::k_absent);
    size_t row_bytes = sizeof(Entity);
    for (ComponentId component = 0; component < k_component_limit; ++component) {
        if (!mask[component]) continue;
        const ComponentInfo& info = component_info(component);
        if (info.size_bytes) {
            place->column_of[component] = uint8_t(place->columns.size());
            place->columns.push_back(component);
            row_bytes += info.size_bytes;
        }
        if (info.hashed) place->hash_order.push_back(component);
    }
    std::sort(place->hash_order.begin(), place->hash_order.end(), [](ComponentId a, ComponentId b) {
        const ComponentInfo &x = component_info(a), &y = component_info(b);
        return x.name_hash != y.name_hash ? x.name_hash < y.name_hash : x.name < y.name;
    });
    // Every column may lose up to one alignment; at least one row, however small the chunk is set.
    size_t fixed = head_bytes(*place) + (place->columns.size() + 1) * k_align;
    size_t room = settings_.shared_chunk_bytes > fixed ? settings_.shared_chunk_bytes - fixed : 0;
    place->shared_capacity = uint32_t(std::clamp<size_t>(room / row_bytes, 1, UINT32_MAX));
    return *place;
}

Chunk* World::make_chunk(const Archetype& archetype, uint32_t capacity, bool with_entities) {
    size_t size = chunk_bytes(archetype, capacity, with_entities);
    auto* memory = static_cast<std::byte*>(pool_.allocate(size));
    Chunk* chunk = new (memory) Chunk{};
    chunk->size_bytes = size;
    chunk->capacity = capacity;
    chunk->slot = k_shared;
    chunk->archetype = &archetype;
    size_t offset = head_bytes(archetype);
    for (size_t column = 0; column < archetype.columns.size(); ++column) {
        chunk->column_offsets()[column] = uint32_t(offset / k_align);
        offset += round_up(size_t(capacity) * component_info(archetype.columns[column]).size_bytes);
    }
    if (with_entities) chunk->entities = reinterpret_cast<Entity*>(memory + offset);
    return chunk;
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
        pool_.release(last, last->size_bytes);
    }
}

Entity World::create_raw(const ComponentMask& mask) {
    assert_editable();
    EntityPlace place = append_row(archetype_of(mask));
    Entity entity = index_.claim(place.chunk, place.row);
    place.chunk->entities[place.row] = entity;
    if (!entity) {
        ++refused_count_;
        remove_row(place);
        return {};
    }
    const std::vector<ComponentId>& columns = place.chunk->archetype->columns;
    for (uint32_t column = 0; column < columns.size(); ++column) {
        size_t size = component_info(columns[column]).size_bytes;
        std::memset(place.chunk->column(column) + place.row * size, 0, size);
    }
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
    if (size_t size = component_info(component).size_bytes) {
        std::byte* target =
            place.chunk->column(place.chunk->archetype->column_of[component]) + place.row * size;
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
    Archetype& archetype = archetype_of(mask);
    Chunk* chunk = make_chunk(archetype, count, false);
    chunk->count = count;
    chunk->owner = owner;
    if (!index_.claim_run(chunk)) {
        refused_count_ += count;
        pool_.release(chunk, chunk->size_bytes);
        return {};
    }
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
        pool_.release(chunk->entities, sizeof(Entity) * chunk->capacity);
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
    pool_.release(chunk, chunk->size_bytes);
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
    // A sum of well mixed words by entity does not depend on the order they come in, so nothing needs
    // sorting.
    std::atomic<uint64_t> sum{0};
    auto hash_chunk = [&](const Chunk& chunk) {
        uint64_t chunk_sum = 0;
        for (uint32_t row = 0; row < chunk.count; ++row) {
            uint64_t hash = hash_combine(chunk.entity(row).bits(), chunk.owner.bits());
            for (ComponentId component : chunk.archetype->hash_order) {
                const ComponentInfo& info = component_info(component);
                hash = hash_combine(hash, info.name_hash);
                if (info.size_bytes)
                    hash = hash_bytes(
                        chunk.column(chunk.archetype->column_of[component]) + size_t(row) * info.size_bytes,
                        info.size_bytes, hash);
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
                  slots_.capacity() * sizeof(Slot) + free_slots_.capacity() * sizeof(uint32_t);
    for (const auto& archetype : archetypes_)
        size += sizeof(Archetype) +
                (archetype->shared_chunks.capacity() + archetype->bulk_chunks.capacity()) * sizeof(Chunk*) +
                (archetype->columns.capacity() + archetype->hash_order.capacity()) * sizeof(ComponentId);
    return size;
}

}  // namespace coppice
