// What stands for a part in the distance: lines where it is made of long thin pieces, else points.
#pragma once
#include "plugins/vegetation/cook/split_by_thickness.h"

namespace coppice {

// Which parts may become lines. Leaves are nearer to the reference as points, needles and blades of grass too, and blend
// into their triangles (docs/decisions.md 27).
enum class LineParts : uint8_t {
    none,     // every part becomes points, whatever its shape or author says
    stems,    // what is no leaf; the author's word goes first
    slender,  // needles and blades as well
};

// The author's word, or the modeller's skeleton, decides; where neither speaks, a part that may become lines does if
// over six tenths of its area belong to stems more than six times as long as thick. Returns the part (kind
// points, empty skeleton) or its pieces by thickness (kind lines, each with its skeleton). Requires a clean
// mesh that is not empty.
std::vector<SlenderPart> classify_part(PartDescription part, const std::vector<uint32_t>& welded, bool closed,
                                       LineParts line_parts);

}  // namespace coppice
