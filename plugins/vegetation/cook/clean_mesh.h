// What comes in is made safe for everything behind it: indices checked, triangles without area or with values
// that are not numbers dropped, vertices no triangle uses dropped, both counted.
#pragma once
#include <cstdint>
#include "plugins/vegetation/plant/description.h"
#include "runtime/core/result.h"

namespace coppice {

struct CleanCounts {
    uint32_t dropped_triangles = 0;  // zero area, or a corner that is not finite
    uint32_t dropped_vertices = 0;   // used by no triangle that is left
};

// Afterwards: indices in range, three a triangle; every triangle has area; positions finite; normals unit (a
// missing one is its triangle's); colours in [0, 1] (grey where not a number); element ranges follow what was
// dropped; skeleton finite, without segments of no length. Order is kept. `place` names the part in messages.
// Errors: value_out_of_range, also for a corner beyond k_position_limit_m.
Result<PartDescription> clean_mesh(const PartDescription& part, const std::string& plant_name,
                                   const std::string& place, CleanCounts& counts);

// Twice the area of the triangle, along its normal. In double: exact zero for repeated corners, and slivers
// keep theirs.
dvec3 doubled_area_vector(vec3 a, vec3 b, vec3 c);

}  // namespace coppice
