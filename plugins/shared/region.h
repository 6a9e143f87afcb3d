// Parts of the ground, seen from above: where plants grow or do not, what is painted. World x and z, metres.
#pragma once
#include <map>
#include <string>
#include <vector>
#include <glm/vec2.hpp>
#include "plugins/shared/json_object.h"

namespace coppice {

using glm::dvec2;

struct RegionShape {
    enum class Kind { circle, rectangle, polygon, corridor } kind = Kind::circle;
    dvec2 center{0.0};
    dvec2 half_size{0.0};       // rectangle
    dvec2 axis{1.0, 0.0};       // rectangle: unit, where its x points
    double radius_m = 0.0;      // circle; corridor: half its width
    std::vector<dvec2> points;  // polygon, closed by itself; corridor
};

// A union of shapes.
struct Region {
    std::vector<RegionShape> shapes;
    // To the border: negative inside, exact outside; inside a union the largest of its shapes' depths.
    double distance_m(dvec2 p) const;
    bool contains(dvec2 p) const { return distance_m(p) < 0.0; }
    // Lower and upper corner of a box around it.
    std::pair<dvec2, dvec2> bounds() const;
};

using NamedRegions = std::map<std::string, Region>;

inline constexpr double k_farthest_m = 1e7;  // of any place from the origin

// One shape, the name of a region, or a list of both:
//   {"circle": {"center": [x, z], "radius_m": r}}        {"rectangle": {"center": [x, z], "size_m": [w, d],
//   "turn_deg": 0}}
//   {"polygon": [[x, z], ...]}                           {"corridor": {"points": [[x, z], ...], "width_m":
//   w}}
Region read_region(JsonDocument& document, const nlohmann::json& value, const std::string& place,
                   const NamedRegions& named = {});

}  // namespace coppice
