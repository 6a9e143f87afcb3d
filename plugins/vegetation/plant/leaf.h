// A crown as quad leaves, and the sequence in which they are joined two by two. Of L leaves, leaf i < L is the crown's
// own and has its corners 4 i ... 4 i + 3; collapse i makes leaf L + i out of two older ones. Level c is the crown after
// collapses [0, c): L - c leaves. So a leaf's number says at which level it is born: max(0, number - L + 1).
// Source: Rebollo et al. 2006, 3 (leaf collapse, numbering; as there no corner is made anew). Deviates: a growth about the
// middle of the corners keeps the area (ERRATA 8).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include "runtime/core/math.h"
#include "runtime/core/result.h"

namespace coppice {

// Triangles (0, 1, 2) and (0, 2, 3) of the corners.
struct Leaf {
    std::array<vec3, 4> corners_plant;  // m
    vec3 normal_plant;                  // unit; what it is lit by
    vec3 color_linear;                  // [0, 1]
};

struct LeafCollapse {
    std::array<uint32_t, 2> removed;  // the lower number first
    std::array<uint32_t, 4> corners;  // of the new leaf, among the 4 L of the full crown
    float growth;       // > 0: how much larger than between these corners it is drawn, about their mean
    float error_m;      // never less than that of the collapse before
    vec3 normal_plant;  // unit
    vec3 color_linear;
};

// Of both triangles, m2.
double leaf_area_m2(const Leaf& leaf);

// The leaf a collapse makes, as it is drawn. Requires corners in range (check_collapses).
Leaf collapsed_leaf(std::span<const Leaf> crown, const LeafCollapse& collapse);

inline uint32_t level_of_birth(uint32_t leaf, uint32_t leaf_count) {
    return leaf < leaf_count ? 0 : leaf - leaf_count + 1;
}

// That every collapse removes two different leaves that are there at its level, that corners are in range and numbers finite.
// Error: file_corrupt, of `file`.
Status check_collapses(uint32_t leaf_count, std::span<const LeafCollapse> collapses, const std::string& file);

}  // namespace coppice
