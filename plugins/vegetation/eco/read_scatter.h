// What a scene says about scattered plants, and the names it may use for them.
#pragma once
#include <functional>
#include <map>
#include <string>
#include "plugins/shared/json_object.h"
#include "plugins/vegetation/eco/scatter.h"

namespace coppice {

struct SceneNames {
    std::map<std::string, PlantKind> kinds;
    NamedRegions regions;
    // A picture beside the file that is read. Empty: there are none.
    std::function<Result<std::shared_ptr<const MapPicture>>(const std::string& name, MapChannel)> read_map;
    // Where plants of a kind stand, of those that count for the scatter that is read. Empty: nothing stands yet.
    std::function<Result<std::vector<dvec2>>(const std::string& kind)> places_of;
    // nullptr with the nearest names reported, where there is no such plant.
    const PlantKind* find_kind(JsonObject& object, const char* key, const std::string& name) const;
};

// Faults go to the document; what is read after one is of no use. terrain: null, or where the plants stand.
ScatterSettings read_scatter(JsonObject& object, const SceneNames& names, const Terrain* terrain);

// "scale": [low, high]
void read_scale_range(JsonObject& object, float& low, float& high);

inline constexpr float k_scale_least = 1e-3f, k_scale_most = 1e3f;  // of a plant, and of a reference

}  // namespace coppice
