// What stands for a part in the distance: lines where it is made of long thin pieces, else points.
#pragma once
#include "plugins/vegetation/cook/split_by_thickness.h"

namespace coppice {

// The author's word, or the modeller's skeleton, decides; where neither speaks, the part becomes lines if
// over six tenths of its area belong to stems more than six times as long as thick. Returns the part (kind
// points, empty skeleton) or its pieces by thickness (kind lines, each with its skeleton). Requires a clean
// mesh that is not empty.
std::vector<SlenderPart> classify_part(PartDescription part, const std::vector<uint32_t>& welded,
                                       bool closed);

}  // namespace coppice
