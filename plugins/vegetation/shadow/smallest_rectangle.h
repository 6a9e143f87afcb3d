// The rectangle of least area around places of a plane; one of its sides lies along a side of their hull. How large it is changes
// steadily with the places, also where it turns to another side.
#pragma once
#include <span>
#include <glm/vec2.hpp>

namespace coppice {

using glm::dvec2;

struct Rectangle {
    dvec2 axis{1.0, 0.0};  // unit, the direction of its first coordinate; the second is a quarter turn on
    dvec2 low{0.0}, high{0.0};
};

// At least least_width each way. Requires places, at most 128; not finite ones are passed over.
Rectangle smallest_rectangle(std::span<const dvec2> places, double least_width);

}  // namespace coppice
