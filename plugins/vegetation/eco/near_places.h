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
    // Requires finite places.
    NearPlaces(std::span<const dvec2> places, double distance_m);
    // Whether one of the places is nearer. Time goes with the logarithm of the places, and with the root where many are nearly as far.
    bool contains(dvec2 p) const { return contains(0, tree_.size(), 0, p); }

  private:
    void sort(size_t first, size_t end, int axis);
    bool contains(size_t first, size_t end, int axis, dvec2 p) const;
    double distance_m_;
    std::vector<dvec2> tree_;  // the middle of each range parts it, by x and z in turn
};

}  // namespace coppice
