// The centre lines of a mesh made of slender pieces (stems, twigs, needles, blades), or the modeller's own
// where the part brings one; and for each triangle the piece of centre line it surrounds.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/plant/description.h"

namespace coppice {

struct TracedSkeleton {
    // Consecutive segments of one stem stand together, from its root outwards, and share their ends.
    std::vector<SkeletonSegment> segments;
    std::vector<uint32_t> triangle_segment;  // for each triangle of the part
};

// From the mesh: each connected component is cut by level sets of the distance over its surface from one end
// (a Reeb graph); the centres of the cuts, linked where the surface between them hangs together, are its
// centre line, with a branch where one cut becomes two. Components of one or two triangles become their
// longest axis. Pure, parallel over components, the same on any number of threads. Requires a clean mesh;
// welded: weld_positions().
TracedSkeleton trace_skeleton(const PartDescription& part, const std::vector<uint32_t>& welded);

// From part.skeleton, which must not be empty: each triangle goes to the segment whose surface it lies
// nearest to.
TracedSkeleton adopt_skeleton(const PartDescription& part);

// Distance in m from p to the segment from a to b.
float distance_to_segment(vec3 p, vec3 a, vec3 b);

}  // namespace coppice
