#include "plugins/vegetation/shadow/receiver_hull.h"

namespace coppice {
namespace {

struct Plane {
    dvec3 normal;  // dot(normal, p) + offset >= 0 inside
    double offset;
    double inside(dvec3 p) const { return glm::dot(normal, p) + offset; }
};

struct Face {
    std::array<dvec3, 10> corners;
    size_t count = 0;
    void add(dvec3 p) { corners[count++] = p; }
};

// A convex face keeps at most one corner more.
Face clip(const Face& face, const Plane& plane) {
    Face kept;
    for (size_t i = 0; i < face.count; ++i) {
        const dvec3 a = face.corners[i], b = face.corners[(i + 1) % face.count];
        const double in_a = plane.inside(a), in_b = plane.inside(b);
        if (in_a >= 0.0 && kept.count < kept.corners.size()) kept.add(a);
        if ((in_a < 0.0) != (in_b < 0.0) && kept.count < kept.corners.size())
            kept.add(a + (b - a) * (in_a / (in_a - in_b)));
    }
    return kept;
}

using Corners = std::array<dvec3, 8>;  // bit 0, 1, 2: the far side along three axes

// The six faces of what has such corners.
std::array<Face, 6> faces_of(const Corners& corners) {
    std::array<Face, 6> faces;
    for (size_t axis = 0; axis < 3; ++axis)
        for (size_t side = 0; side < 2; ++side) {
            const size_t u = size_t(1) << ((axis + 1) % 3), v = size_t(1) << ((axis + 2) % 3);
            const size_t first = side << axis;
            for (const size_t corner : {first, first | u, first | u | v, first | v})
                faces[2 * axis + side].add(corners[corner]);
        }
    return faces;
}

}  // namespace

ReceiverHull::ReceiverHull(const ShadowScene& scene) {
    const dvec3 right(scene.right), up(scene.up), forward(scene.forward);
    const dvec3 low(scene.receivers.min), high(scene.receivers.max);
    const double tangent_x = double(scene.tangent_x), tangent_y = double(scene.tangent_y);
    Corners of_view, of_box;
    for (size_t i = 0; i < 8; ++i) {
        const double distance = double(i & 4 ? scene.far_m : scene.near_m);
        of_view[i] = (forward + right * (i & 1 ? tangent_x : -tangent_x) + up * (i & 2 ? tangent_y : -tangent_y)) *
                     distance;
        of_box[i] = {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z};
    }
    const std::array<Plane, 6> view_planes{{{forward, -double(scene.near_m)},
                                            {-forward, double(scene.far_m)},
                                            {forward * tangent_x + right, 0.0},
                                            {forward * tangent_x - right, 0.0},
                                            {forward * tangent_y + up, 0.0},
                                            {forward * tangent_y - up, 0.0}}};
    std::array<Plane, 6> box_planes;
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 normal(0.0);
        normal[axis] = 1.0;
        box_planes[2 * axis] = {normal, -low[axis]};
        box_planes[2 * axis + 1] = {-normal, high[axis]};
    }
    auto add = [&](const Corners& corners, const std::array<Plane, 6>& planes) {
        for (Face face : faces_of(corners)) {
            for (const Plane& plane : planes) face = clip(face, plane);
            for (size_t i = 0; i < face.count; ++i)
                if (std::isfinite(face.corners[i].x + face.corners[i].y + face.corners[i].z))
                    places_[count_++] = face.corners[i];
        }
    };
    if (low.x <= high.x && low.y <= high.y && low.z <= high.z) {
        add(of_view, box_planes);
        add(of_box, view_planes);
    }
    if (count_ > 0) return;
    const dvec3 ahead = forward * double(scene.near_m);
    places_[count_++] = std::isfinite(ahead.x + ahead.y + ahead.z) ? ahead : dvec3(0.0);
}

}  // namespace coppice
