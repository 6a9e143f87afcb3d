#include "plugins/vegetation/eco/place_named.h"

#include <charconv>
#include <fmt/format.h>
#include "plugins/vegetation/eco/read_scatter.h"
#include "runtime/core/log.h"
#include "runtime/core/random.h"

namespace coppice {
namespace {

struct Called {
    const PlantKind* kind = nullptr;
    uint32_t number = UINT32_MAX;  // behind the name; none: by chance
};

Called find_called(const std::map<std::string, PlantKind>& kinds, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        if (const auto found = kinds.find(name); found != kinds.end()) return {&found->second};
        const size_t end = name.find_last_not_of("0123456789");
        if (end == name.npos || end + 1 == name.size() || (name[end] != '.' && name[end] != '_')) continue;
        const auto found = kinds.find(name.substr(0, end));
        if (found == kinds.end()) continue;
        Called called{&found->second};
        std::from_chars(name.data() + end + 1, name.data() + name.size(), called.number);
        return called;
    }
    return {};
}

}  // namespace

Result<std::vector<Placement>> place_named(const std::vector<NamedPlaces>& named, const PlaceNamedSettings& settings,
                                           const std::string& path) {
    std::vector<Placement> plants;
    size_t passed_over = 0;
    for (const NamedPlaces& many : named) {
        const Called called = find_called(settings.kinds, many.names);
        if (!called.kind) {
            passed_over += many.places.size();
            continue;
        }
        if (many.places.size() > k_plant_limit - plants.size())
            return fail(ErrorId::limit_exceeded, path, many.place, "too many plants",
                        fmt::format("at most {}", k_plant_limit));
        const std::vector<PlantIndividual>& individuals = called.kind->individuals;
        for (const NamedPlace& place : many.places) {
            Random random(settings.seed, plants.size());
            const uint32_t chosen = called.number != UINT32_MAX ? called.number % uint32_t(individuals.size())
                                                                : random.next_below(uint32_t(individuals.size()));
            const PlantIndividual& individual = individuals[chosen];
            Placement plant;
            plant.position_world = place.at + settings.offset;
            plant.scale = float(place.scale) * individual.scale;
            plant.turn = pack_turn(place.turn.x, place.turn.y, place.turn.z, place.turn.w);
            plant.model = {individual.model, uint32_t(random.next_bits() >> 32)};
            for (double along : {plant.position_world.x, plant.position_world.y, plant.position_world.z})
                if (!(std::abs(along) <= k_farthest_m))
                    return fail(ErrorId::value_out_of_range, path, many.place, fmt::format("a plant at {:.3g} m", along),
                                fmt::format("within {:g} m", k_farthest_m));
            if (!(place.scale >= double(k_scale_least) && place.scale <= double(k_scale_most)))
                return fail(ErrorId::value_out_of_range, path, many.place, fmt::format("a scale of {:.3g}", place.scale),
                            fmt::format("from {:g} to {:g}", k_scale_least, k_scale_most));
            plants.push_back(plant);
        }
    }
    if (plants.empty()) {
        std::vector<std::string> known;
        for (const auto& [name, kind] : settings.kinds) known.push_back(name);
        const std::string first = named.empty() || named.front().names.empty() ? "" : named.front().names.front();
        return fail(ErrorId::name_unknown, path, "nodes",
                    fmt::format("none of {} nodes and instances is called like a plant", passed_over),
                    "name them in \"species\": " + known_names(first, std::move(known)));
    }
    if (passed_over > 0) log_note("{}: {} nodes and instances that are called like no plant", path, passed_over);
    return plants;
}

}  // namespace coppice
