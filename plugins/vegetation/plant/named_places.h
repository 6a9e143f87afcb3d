// Where things called by name stand in another program's file: what nodes of a glTF file are to a scene.
#pragma once
#include <string>
#include <vector>
#include "runtime/core/math.h"

namespace coppice {

struct NamedPlace {
    dvec3 at;     // foot
    double scale;  // > 0; of what is stretched that which keeps its volume
    vec4 turn;     // unit quaternion x, y, z, w; what is mirrored is not
};

struct NamedPlaces {
    std::vector<std::string> names;  // what they may be called by, the first known one counts
    std::string place;               // in the file: "nodes[3]"
    std::vector<NamedPlace> places;
};

}  // namespace coppice
