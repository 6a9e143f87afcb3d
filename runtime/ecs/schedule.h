// Which systems run when. A system is a function; what it reads and writes is taken from its parameters:
//
//     schedule.add(Phase::cull, 10, "cull_tiles", [](Query<const Camera> cameras, Query<Tile> tiles,
//     Commands& edits) {});
//
//   Query<...>       reads and writes what its terms say        World&         everything; runs alone, edits
//   directly Commands&        its own buffer of structural edits         const World&   reads everything
//
// Phases follow one another as the data flows. Inside a phase a system waits for those of lower order whose
// access conflicts with its own; the others run at the same time. So the result never depends on the number
// of threads. Commands are carried out when their phase ends, in the order of the systems.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>
#include "runtime/ecs/commands.h"
#include "runtime/ecs/query.h"
#include "runtime/ecs/world.h"

namespace coppice {

enum class Phase : uint8_t { input, stream, world, cull, lod, shadow, draw, report };
inline constexpr size_t k_phase_count = 8;
const char* name_of(Phase phase);

namespace detail {
template <class Parameter>
struct SystemParameter {
    static_assert(sizeof(Parameter) == 0, "a system takes Query<...>, Commands&, World& or const World&");
};
template <class... Terms>
struct SystemParameter<Query<Terms...>> {
    static Access access() { return Query<Terms...>::access(); }
    static Query<Terms...> make(World& world, Commands&) { return Query<Terms...>(world); }
};
template <class... Terms>
struct SystemParameter<const Query<Terms...>&> : SystemParameter<Query<Terms...>> {};
template <>
struct SystemParameter<Commands&> {
    static Access access() { return {}; }
    static Commands& make(World&, Commands& commands) { return commands; }
};
template <>
struct SystemParameter<World&> {
    static Access access() { return {.reads = {}, .writes = {}, .exclusive = true}; }
    static World& make(World& world, Commands&) { return world; }
};
template <>
struct SystemParameter<const World&> {
    static Access access() { return {.reads = ComponentMask().set(), .writes = {}}; }
    static const World& make(World& world, Commands&) { return world; }
};
}  // namespace detail

class Schedule {
  public:
    // The world must outlive the schedule.
    explicit Schedule(World& world) : world_(world) {}
    Schedule(const Schedule&) = delete;
    Schedule& operator=(const Schedule&) = delete;

    // Equal orders run as they were added. Not while running.
    template <class System>
    void add(Phase phase, int order, std::string name, System system) {
        add_deduced(phase, order, std::move(name), std::function{std::move(system)});
    }

    // One frame: all phases. Allocates nothing once warm, unless a system does.
    void run();
    void run(Phase phase);

    // Names in the order they run; those in one list may run at the same time.
    std::vector<std::vector<std::string>> batches(Phase phase) const;

  private:
    struct System {
        int order;
        std::string name;
        Access access;
        std::function<void(World&, Commands&)> run;
        std::unique_ptr<Commands> commands;
        uint32_t batch;
    };
    struct PhaseSystems {
        std::vector<System> systems;                 // by order
        std::vector<std::vector<uint32_t>> batches;  // indices of systems
    };

    template <class... Parameters>
    void add_deduced(Phase phase, int order, std::string name, std::function<void(Parameters...)> system) {
        Access access;
        (access.merge(detail::SystemParameter<Parameters>::access()), ...);
        add_system(phase, order, std::move(name), access,
                   [system = std::move(system)](World& world, Commands& commands) {
                       system(detail::SystemParameter<Parameters>::make(world, commands)...);
                   });
    }
    void add_system(Phase phase, int order, std::string name, const Access& access,
                    std::function<void(World&, Commands&)> run);

    World& world_;
    std::array<PhaseSystems, k_phase_count> phases_;
};

}  // namespace coppice
