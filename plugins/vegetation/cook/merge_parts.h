// Few parts, however many the author's file has: a tool that writes one material or one mesh a leaf gives
// thousands, each of which would cost the cook its measurements and every instance a decision every frame.
#pragma once
#include <cstdint>
#include <vector>
#include "plugins/vegetation/cook/split_by_thickness.h"

namespace coppice {

inline constexpr uint32_t k_part_limit = 64;

struct CookPart {
    SlenderPart shape;  // classified: points or lines
    bool closed = false;
    PartKind asked = PartKind::automatic;  // by a person
    double area_m2 = 0.0;
    vec3 mean_color_linear{0};
};

// At most part_limit parts, which must be at least 16; parts stay as they are while there are no more. Else
// the parts that differ most, large ones first, stand, and every other joins the one it is most like in
// colour, thickness of its lines and given importance, of the same kind, leaf or not, closed or not, with
// importance given or not. Triangles and segments keep their order; nothing is lost but which leaf is which
// (element_first_triangle). Time grows with parts x part_limit. Pure, ties by index.
std::vector<CookPart> merge_parts(std::vector<CookPart> parts, uint32_t part_limit = k_part_limit);

}  // namespace coppice
