// The quad that stands for two: of the quads between four of their eight corners the one most like them, grown to their area.
// Source: ERRATA 8 (FSA). Deviates: a quad is asked for more than an area near theirs, since what is left of that is grown
// away: to lie in the middle of the two, and with its two triangles to face as they do. Flat quads face one way and hide nothing of
// themselves, so with the same area the crown would cover more and more; quads may be bent, and how much is wished for.
#pragma once
#include "plugins/vegetation/cook/leaf_error.h"

namespace coppice {

struct JoinedLeaf {
    std::array<uint8_t, 4> corners;  // of the eight: 0-3 the first leaf's, 4-7 the second's
    float growth;                    // about the mean of the corners; 1 where they span no area
};

struct JoinWish {
    float flatness = 0.85f;  // |sum of the triangles' area vectors| over their area; [0, 1]
    float area = 1.0f;       // of the area of both; > 0
    NormalSpread lean{};     // to be added to how the two leaves' surface faces, over its area
};

// raw_a, raw_b: the leaves' corners before growth, among which to choose. Flat and with triangles that lie on each other
// only where every quad is.
JoinedLeaf join_leaves(const MeasuredLeaf& a, const MeasuredLeaf& b, const std::array<vec3, 4>& raw_a,
                       const std::array<vec3, 4>& raw_b, const JoinWish& wish);

}  // namespace coppice
