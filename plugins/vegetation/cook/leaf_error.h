// What is lost when one leaf stands for two.
// Source: ERRATA 8 (FSA joins the Hausdorff distance of the leaves with their planarity). Deviates: the turn is weighed by
// the leaves' own size instead of the distance by the crown's diagonal. Over a diagonal the distance of neighbours is
// nothing beside any turn, and leaves from opposite sides of the crown are joined because they are parallel.
#pragma once
#include "plugins/vegetation/plant/leaf.h"

namespace coppice {

// A leaf with what its comparisons need again and again.
struct MeasuredLeaf {
    Leaf leaf;
    double area_m2;
    vec3 middle;  // mean of the corners
    vec3 facing;  // unit normal of the surface, whatever it is lit by
    Box box;
};

MeasuredLeaf measure_leaf(const Leaf& leaf, double area_m2);

// Two leaves side by side in one plane lose nothing by becoming one; one behind the other they hide each other, and joined
// they would hide more of what is behind them: coverage grows. So planarity weighs more than distance.
struct LeafErrorWeights {
    float turn = 4.0f;   // of a right-angle turn, in sides of the square as large as both leaves; >= 0
    float plane = 8.0f;  // of the distance of each from the other's plane; >= 0
};

// H(a, b) + turn sqrt(A_a + A_b) (1 - |n_a . n_b|) + plane (distances from the planes, mean), in metres; symmetric, >= 0.
// H is the largest distance of a corner of either to the other's surface, which for flat quads is the Hausdorff
// distance. Returns at least `enough` as soon as that is certain.
float leaf_error_m(const MeasuredLeaf& a, const MeasuredLeaf& b, const LeafErrorWeights& weights,
                   float enough = INFINITY);

}  // namespace coppice
