// Plants where another program's file has things called like them.
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>
#include "plugins/vegetation/eco/place.h"
#include "plugins/vegetation/plant/named_places.h"
#include "runtime/core/result.h"

namespace coppice {

using ReadNamedPlaces = std::function<Result<std::vector<NamedPlaces>>(const std::string& path)>;

struct PlaceNamedSettings {
    std::map<std::string, PlantKind> kinds;  // by the names used in the file
    dvec3 offset{0.0};
    uint64_t seed = 1;
};

// In the file's order. A name may have a number behind it, "birch.003" or "birch_12": that is which of the kind's individuals it is,
// from the first again where there are fewer; without one by chance. What no kind is called like is passed over, with a note
// how much; an error where that is all of it: name_unknown. Others: value_out_of_range for places and scales; limit_exceeded.
Result<std::vector<Placement>> place_named(const std::vector<NamedPlaces>& named, const PlaceNamedSettings& settings,
                                           const std::string& path);

}  // namespace coppice
