// The corners of two convex bodies' common part are the ends of each body's edges, cut by the other body: no planes are
// intersected with each other, so that nothing is decided by a tolerance.
#include "plugins/vegetation/shadow/receiver_hull.h"

#include <algorithm>

namespace coppice {
namespace {

struct Plane {
    dvec3 normal;  // inside: dot(normal, p) + offset >= 0
    double offset;
};
using Body = std::array<Plane, 6>;
using Corners = std::array<dvec3, 8>;  // bit 0, 1, 2 of the index: which side along the three axes

template <class Add>
void add_cut_edge(dvec3 from, dvec3 to, const Body& body, Add&& add) {
    double first = 0.0, last = 1.0;
    for (const Plane& plane : body) {
        const double at_from = glm::dot(plane.normal, from) + plane.offset;
        const double at_to = glm::dot(plane.normal, to) + plane.offset;
        if (at_from < 0.0 && at_to < 0.0) return;
        if (at_from < 0.0) first = std::max(first, at_from / (at_from - at_to));
        if (at_to < 0.0) last = std::min(last, at_from / (at_from - at_to));
    }
    if (first > last) return;
    add(from + (to - from) * first);
    add(from + (to - from) * last);
}

template <class Add>
void add_cut_edges(const Corners& corners, const Body& body, Add&& add) {
    for (uint32_t corner = 0; corner < 8; ++corner)
        for (uint32_t axis = 1; axis < 8; axis <<= 1)
            if (!(corner & axis)) add_cut_edge(corners[corner], corners[corner | axis], body, add);
}

}  // namespace

ReceiverHull::ReceiverHull(const CheckedShadowScene& scene) {
    auto add = [this](dvec3 corner) { corners_[count_++] = corner; };
    const dvec3 middle = scene.forward * scene.near_m;
    if (scene.receivers.empty()) {
        add(middle);
        return;
    }
    const DoubleBox& box = scene.receivers;
    Corners box_corners, view_corners;
    for (uint32_t i = 0; i < 8; ++i) {
        box_corners[i] = dvec3(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                               i & 4 ? box.max.z : box.min.z);
        view_corners[i] = (scene.forward + scene.right * (i & 1 ? scene.tangent_x : -scene.tangent_x) +
                           scene.up * (i & 2 ? scene.tangent_y : -scene.tangent_y)) *
                          (i & 4 ? scene.far_m : scene.near_m);
    }
    const Body box_body{{{dvec3(1, 0, 0), -box.min.x},
                         {dvec3(-1, 0, 0), box.max.x},
                         {dvec3(0, 1, 0), -box.min.y},
                         {dvec3(0, -1, 0), box.max.y},
                         {dvec3(0, 0, 1), -box.min.z},
                         {dvec3(0, 0, -1), box.max.z}}};
    const Body view_body{{{scene.forward, -scene.near_m},
                          {-scene.forward, scene.far_m},
                          {scene.forward * scene.tangent_x + scene.right, 0.0},
                          {scene.forward * scene.tangent_x - scene.right, 0.0},
                          {scene.forward * scene.tangent_y + scene.up, 0.0},
                          {scene.forward * scene.tangent_y - scene.up, 0.0}}};
    add_cut_edges(box_corners, view_body, add);
    add_cut_edges(view_corners, box_body, add);
    if (count_ == 0) add(middle);
}

}  // namespace coppice
