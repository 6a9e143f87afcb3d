// The ground within a distance of places: where a plant stands too near to others, or near enough.
#pragma once
#include <span>
#include <vector>
#include <glm/vec2.hpp>
#include "runtime/core/math.h"

namespace coppice {

using glm::dvec2;

class NearPlaces {
  public:
    // Requires finite places within 1e8 m, and a distance from 0.001 to 1e5 m.
    NearPlaces(std::span<const dvec2> places, double distance_m);
    // Whether one of the places is nearer.
    bool contains(dvec2 p) const;

  private:
    struct Cell {
        int64_t row, column;
        dvec2 place;
    };
    double distance_m_;
    std::vector<Cell> cells_;  // squares of that distance, by rows
};

}  // namespace coppice
