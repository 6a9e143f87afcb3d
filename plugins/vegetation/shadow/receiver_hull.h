// What is seen and may be in shadow: the view between its near and far planes, clipped by the box that holds all receivers.
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/shadow/shadow_view.h"

namespace coppice {

// Places whose convex hull it is, with repetitions. Never empty: where nothing can be seen, the middle of the view's near plane.
class ReceiverHull {
  public:
    explicit ReceiverHull(const ShadowScene& scene);
    std::span<const dvec3> places() const { return std::span(places_).first(count_); }

    // Twelve faces, of four corners each, clipped by six planes.
    static constexpr size_t k_most_places = 12 * 10;

  private:
    std::array<dvec3, k_most_places> places_;
    size_t count_ = 0;
};

}  // namespace coppice
