// Visits all entities that have certain components, chunk by chunk. The terms say what is read and what is written:
//
//     world.query<const Velocity, Position>().each([](const Velocity& v, Position& p) { ... });
//
//   const T         must have T, reads it
//   T               must have T, writes it
//   With<T>         must have T, does not look at it (also for tags)
//   Without<T>      must not have T
//   Owner<const T>  the chunk's owner must be alive and have T: reads that one value for the whole chunk, so that a
//                   culled tile's entities are skipped without touching one of them
//
// Callbacks take the values in the order of the terms; With and Without give none.
// Order: archetypes as they were made, in each first the shared chunks, then the bulk chunks. No structural
// edits inside (asserted in debug builds). Iterating allocates nothing.
#pragma once
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include "runtime/core/jobs.h"
#include "runtime/ecs/world.h"

namespace coppice {

template <class T>
struct With {};
template <class T>
struct Without {};
template <class T>
struct Owner {};

// What somebody reads and writes. Two may run at the same time unless one writes what the other touches.
struct Access {
    ComponentMask reads;
    ComponentMask writes;
    bool exclusive = false;  // edits the world's structure

    bool conflicts_with(const Access& other) const {
        return exclusive || other.exclusive || (writes & (other.reads | other.writes)).any() ||
               (other.writes & reads).any();
    }
    void merge(const Access& other) {
        reads |= other.reads;
        writes |= other.writes;
        exclusive |= other.exclusive;
    }
};

namespace detail {
// How a term selects, what it accesses, and what it hands to a callback: columns() for a chunk, row() for an
// entity.
template <class T>
struct Term {
    static_assert(!std::is_empty_v<T>, "a tag has no value to visit: say With<Tag>");
    static constexpr bool selects = true, excludes = false;
    using Component = std::remove_const_t<T>;
    using Columns = std::tuple<std::span<T>>;
    static bool skips(const World&, const Chunk&) { return false; }
    static Columns columns(const World&, const Chunk& chunk) {
        return {std::span<T>(chunk.column<Component>(), chunk.count)};
    }
    static void note(Access& access) {
        (std::is_const_v<T> ? access.reads : access.writes).set(component_id<Component>());
    }
};
template <class T>
struct Term<With<T>> {
    static constexpr bool selects = true, excludes = false;
    using Component = T;
    using Columns = std::tuple<>;
    static bool skips(const World&, const Chunk&) { return false; }
    static Columns columns(const World&, const Chunk&) { return {}; }
    static void note(Access&) {}
};
template <class T>
struct Term<Without<T>> : Term<With<T>> {
    static constexpr bool selects = false, excludes = true;
};
template <class T>
struct Term<Owner<T>> {
    static_assert(std::is_const_v<T>, "chunks share their owner: it can only be read, say Owner<const T>");
    static constexpr bool selects = false, excludes = false;
    using Component = std::remove_const_t<T>;
    using Columns = std::tuple<T&>;
    static bool skips(const World& world, const Chunk& chunk) { return !world.get<Component>(chunk.owner); }
    static Columns columns(const World& world, const Chunk& chunk) {
        return {*world.get<Component>(chunk.owner)};
    }
    static void note(Access& access) { access.reads.set(component_id<Component>()); }
};

// A column's value at a row; an owner's value is the same at every row.
template <class T>
T& at_row(std::span<T> column, size_t row) {
    return column.data()[row];
}
template <class T>
T& at_row(T& shared, size_t) {
    return shared;
}

// May T be accessed as Wanted by one of the terms?
template <class Wanted, class... Terms>
inline constexpr bool allows = std::is_const_v<Wanted>
                                   ? ((std::is_same_v<Terms, Wanted> ||
                                       std::is_same_v<Terms, std::remove_const_t<Wanted>> ||
                                       std::is_same_v<Terms, Owner<Wanted>>) ||
                                      ...)
                                   : (std::is_same_v<Terms, Wanted> || ...);
}  // namespace detail

// Cheap to make, to copy and to drop; belongs to its world. Made in a system's signature or by World::query.
template <class... Terms>
class Query {
  public:
    static constexpr size_t k_chunks_per_job = 8;

    explicit Query(const World& world) : world_(&world), matches_(&world.matches(all(), none())) {}

    static Access access() {
        Access access;
        (detail::Term<Terms>::note(access), ...);
        return access;
    }

    // visit(ChunkView, std::span<const T> or std::span<T> or owner's const T&, ...)
    template <class Visit>
    void each_chunk(Visit&& visit) const {
        World::IterationLock lock(*world_);
        for (const Archetype* archetype : matches().archetypes)
            for (const auto* chunks : {&archetype->shared_chunks, &archetype->bulk_chunks})
                for (const Chunk* chunk : *chunks) visit_chunk(*chunk, visit);
    }
    // The same from several threads, `chunks_per_job` in a row by one of them. What visit writes beside the
    // columns it was given must not depend on the order of calls.
    template <class Visit>
    void parallel_each_chunk(Visit&& visit, size_t chunks_per_job = k_chunks_per_job) const {
        World::IterationLock lock(*world_);
        parallel_for(chunk_count(), chunks_per_job, [&](size_t first, size_t last) {
            size_t begin = 0;  // number of the first chunk of a list
            for (const Archetype* archetype : matches_->archetypes)
                for (const auto* chunks : {&archetype->shared_chunks, &archetype->bulk_chunks}) {
                    size_t end = begin + chunks->size();
                    for (size_t i = std::max(first, begin); i < std::min(last, end); ++i)
                        visit_chunk(*(*chunks)[i - begin], visit);
                    begin = end;
                }
        });
    }

    // visit(const T& or T&, ...) or visit(Entity, const T& or T&, ...). Chunks for which keep(ChunkView,
    // owner's const T& ...) is false are skipped.
    template <class Visit, class Keep = std::nullptr_t>
    void each(Visit&& visit, Keep keep = nullptr) const {
        each_chunk(
            [&](const ChunkView& chunk, auto&&... columns) { visit_rows(visit, keep, chunk, columns...); });
    }
    template <class Visit, class Keep = std::nullptr_t>
    void parallel_each(Visit&& visit, Keep keep = nullptr, size_t chunks_per_job = k_chunks_per_job) const {
        parallel_each_chunk(
            [&](const ChunkView& chunk, auto&&... columns) { visit_rows(visit, keep, chunk, columns...); },
            chunks_per_job);
    }

    // Any entity's component, matched by the query or not, within what the terms may access. nullptr: not
    // alive or has none. get<const T> needs the term T, const T or Owner<const T>; get<T> the term T.
    template <class T>
    T* get(Entity entity) const {
        static_assert(detail::allows<T, Terms...>, "the query's terms do not give this access");
        return const_cast<T*>(world_->get<std::remove_const_t<T>>(entity));
    }

    // Entities visited.
    size_t count() const {
        size_t count = 0;
        each_chunk([&](const ChunkView& chunk, auto&&...) { count += chunk.size(); });
        return count;
    }

  private:
    static ComponentMask all() {
        ComponentMask mask;
        ((detail::Term<Terms>::selects
              ? void(mask.set(component_id<typename detail::Term<Terms>::Component>()))
              : void()),
         ...);
        return mask;
    }
    static ComponentMask none() {
        ComponentMask mask;
        ((detail::Term<Terms>::excludes
              ? void(mask.set(component_id<typename detail::Term<Terms>::Component>()))
              : void()),
         ...);
        return mask;
    }
    // Archetypes may have appeared since the query was made.
    const QueryMatches& matches() const { return world_->matches(matches_->all, matches_->none); }
    size_t chunk_count() const {
        size_t count = 0;
        for (const Archetype* archetype : matches().archetypes)
            count += archetype->shared_chunks.size() + archetype->bulk_chunks.size();
        return count;
    }
    template <class Visit>
    void visit_chunk(const Chunk& chunk, Visit& visit) const {
        if (chunk.count == 0 || (detail::Term<Terms>::skips(*world_, chunk) || ...)) return;
        std::apply(visit, std::tuple_cat(std::tuple(ChunkView(chunk, world_->id_of(chunk))),
                                         detail::Term<Terms>::columns(*world_, chunk)...));
    }
    template <class T>
    static std::tuple<> owner_only(std::span<T>) {
        return {};
    }
    template <class T>
    static std::tuple<T&> owner_only(T& owner) {
        return {owner};
    }
    template <class Visit, class Keep, class... Columns>
    static void visit_rows(Visit& visit, Keep& keep, const ChunkView& chunk, Columns&... columns) {
        if constexpr (!std::is_same_v<Keep, std::nullptr_t>)
            if (!std::apply(keep, std::tuple_cat(std::tuple(chunk), owner_only(columns)...))) return;
        uint32_t count = chunk.size();
        for (uint32_t row = 0; row < count; ++row) {
            if constexpr (std::is_invocable_v<Visit&, Entity, decltype(detail::at_row(columns, row))...>)
                visit(chunk.entity(row), detail::at_row(columns, row)...);
            else
                visit(detail::at_row(columns, row)...);
        }
    }

    const World* world_;
    const QueryMatches* matches_;
};

template <class... Terms>
Query<Terms...> World::query() {
    return Query<Terms...>(*this);
}
template <class... Terms>
Query<Terms...> World::query() const {
    Access access = Query<Terms...>::access();
    assert(access.writes.none() && "a const world's query only reads: say const T");
    (void)access;
    return Query<Terms...>(*this);
}

}  // namespace coppice
