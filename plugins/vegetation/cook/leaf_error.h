// What is lost when one leaf stands for two.
// Source: ERRATA 8 (FSA joins the Hausdorff distance of the leaves with their planarity). Deviates: the turn is weighed by
// the leaves' own size instead of the distance by the crown's diagonal. Over a diagonal the distance of neighbours is
// nothing beside any turn, and leaves from opposite sides of the crown are joined because they are parallel.
#pragma once
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

// Sum of area times n n^T over triangles, m2: xx yy zz xy xz yz. How a leaf's surface faces, whichever its front is.
using NormalSpread = std::array<float, 6>;
inline void add_spread(NormalSpread& spread, vec3 area_vector, float area_m2) {
    if (!(area_m2 > 0.0f)) return;
    const vec3 n = area_vector, u = area_vector * (1.0f / area_m2);
    const float terms[6] = {n.x * u.x, n.y * u.y, n.z * u.z, n.x * u.y, n.x * u.z, n.y * u.z};
    for (size_t k = 0; k < 6; ++k) spread[k] += terms[k];
}

// A leaf with what its comparisons need again and again.
struct MeasuredLeaf {
    Leaf leaf;
    double area_m2;
    NormalSpread spread;  // of a leaf made: of all leaves of the crown it stands for
    vec3 middle;          // mean of the corners
    vec3 facing;          // unit normal of the surface, whatever it is lit by
    Box box;
};

MeasuredLeaf measure_leaf(const Leaf& leaf);

// Two leaves side by side in one plane lose nothing by becoming one; one behind the other they hide each other, and joined
// they hide more of what is behind them.
struct LeafErrorWeights {
    float turn = 2.0f;   // of a right-angle turn, in sides of the square as large as both leaves; >= 0
    float plane = 2.0f;  // of the distance of each from the other's plane; >= 0
};

// H(a, b) + turn sqrt(A_a + A_b) (1 - |n_a . n_b|) + plane (distances from the planes, mean), in metres; symmetric, >= 0.
// H is the largest distance of a corner of either to the other's surface, which for flat quads is the Hausdorff
// distance. Returns at least `enough` as soon as that is certain.
float leaf_error_m(const MeasuredLeaf& a, const MeasuredLeaf& b, const LeafErrorWeights& weights,
                   float enough = INFINITY);

}  // namespace coppice
