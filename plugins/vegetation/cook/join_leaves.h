// The quad that stands for two: of the quads between four of their eight corners the one most like them, grown to their area.
// Source: ERRATA 8 (FSA). Deviates: that the area is near theirs is one of three things asked for, since what is left of it
// is grown away; the others are that the quad lies in the middle of the two and faces as they do.
#pragma once
#include "plugins/vegetation/cook/leaf_error.h"

namespace coppice {

struct JoinedLeaf {
    std::array<uint8_t, 4> corners;  // of the eight: 0-3 the first leaf's, 4-7 the second's
    float growth;                    // about the mean of the corners; 1 where they span no area
};

// raw_a, raw_b: the leaves' corners before growth, among which to choose. Not self-intersecting where any of the quads is.
JoinedLeaf join_leaves(const MeasuredLeaf& a, const MeasuredLeaf& b, const std::array<vec3, 4>& raw_a,
                       const std::array<vec3, 4>& raw_b);

}  // namespace coppice
