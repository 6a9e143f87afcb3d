// What receives shadows in the picture: the view frustum, cut by the box of receivers, as the corners of a convex body.
#pragma once
#include <array>
#include <span>
#include "plugins/vegetation/shadow/shadow_scene.h"

namespace coppice {

// Some corners twice. Never empty: where nothing can be seen, the middle of the near plane. No allocation: it is made in every frame.
class ReceiverHull {
  public:
    explicit ReceiverHull(const CheckedShadowScene& scene);
    const dvec3* begin() const { return corners_.data(); }
    const dvec3* end() const { return corners_.data() + count_; }
    operator std::span<const dvec3>() const { return {begin(), end()}; }

  private:
    static constexpr size_t k_most_corners = 2 * 24;  // two ends of each body's edges
    std::array<dvec3, k_most_corners> corners_;
    size_t count_ = 0;
};

}  // namespace coppice
