// Shares a part out: each piece with the triangles and the skeleton that fall to it, nothing twice, nothing lost.
#pragma once
#include <cstdint>
#include <span>
#include <vector>
#include "plugins/vegetation/cook/trace_skeleton.h"

namespace coppice {

struct SlenderPart {
    PartDescription part;
    TracedSkeleton skeleton;
};

// piece_of_triangle and piece_of_segment: for each of the part, which of piece_count pieces it goes to; a triangle goes
// where its segment goes. Triangles and segments keep their order, pieces have no vertices that they do not use; a leaf
// known apart (element_first_triangle) whose triangles go to two pieces is two leaves. Names, kinds and importance are
// the part's. Pieces may be empty.
std::vector<SlenderPart> take_pieces(const SlenderPart& whole, std::span<const uint32_t> piece_of_triangle,
                                     std::span<const uint32_t> piece_of_segment, uint32_t piece_count);

}  // namespace coppice
