#include "runtime/ecs/schedule.h"

#include <algorithm>
#include "runtime/core/jobs.h"

namespace coppice {

const char* name_of(Phase phase) {
    static constexpr std::array<const char*, k_phase_count> names = {"input", "stream", "world", "cull",
                                                                     "lod",   "shadow", "draw",  "report"};
    return names[size_t(phase)];
}

void Schedule::add_system(Phase phase, int order, std::string name, const Access& access,
                          std::function<void(World&, Commands&)> run) {
    PhaseSystems& all = phases_[size_t(phase)];
    auto place = std::upper_bound(all.systems.begin(), all.systems.end(), order,
                                  [](int value, const System& system) { return value < system.order; });
    all.systems.insert(place,
                       {order, std::move(name), access, std::move(run), std::make_unique<Commands>(), 0});
    // Each system goes right behind the last one it must wait for.
    all.batches.clear();
    for (uint32_t i = 0; i < all.systems.size(); ++i) {
        System& system = all.systems[i];
        system.batch = 0;
        for (uint32_t j = 0; j < i; ++j)
            if (system.access.conflicts_with(all.systems[j].access))
                system.batch = std::max(system.batch, all.systems[j].batch + 1);
        if (system.batch >= all.batches.size()) all.batches.resize(system.batch + 1);
        all.batches[system.batch].push_back(i);
    }
}

void Schedule::run(Phase phase) {
    PhaseSystems& all = phases_[size_t(phase)];
    for (const std::vector<uint32_t>& batch : all.batches)
        parallel_for(batch.size(), 1, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) {
                System& system = all.systems[batch[i]];
                system.run(world_, *system.commands);
            }
        });
    for (System& system : all.systems) system.commands->apply(world_);
}

void Schedule::run() {
    for (size_t phase = 0; phase < k_phase_count; ++phase) run(Phase(phase));
}

std::vector<std::vector<std::string>> Schedule::batches(Phase phase) const {
    const PhaseSystems& all = phases_[size_t(phase)];
    std::vector<std::vector<std::string>> names;
    for (const std::vector<uint32_t>& batch : all.batches) {
        names.emplace_back();
        for (uint32_t i : batch) names.back().push_back(all.systems[i].name);
    }
    return names;
}

}  // namespace coppice
