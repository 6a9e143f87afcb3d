// Lines that stand for a slender part in the distance. Source: Deussen et al. 2002, section 4.1: polylines
// cut into segments of about equal length, with eps_l, how far the surface is from them.
#pragma once
#include <vector>
#include "plugins/vegetation/cook/trace_skeleton.h"

namespace coppice {

struct TracedLine {
    vec3 begin_plant, end_plant;
    vec3 color_linear;  // mean of the surface around it
    vec3 normal_plant;  // unit: of the surface around it where that faces one way (a blade); zero where it
                        // goes round
    float
        width_share;  // its own width over the part's mean, A / l: tapered stems and blades keep their taper
};

struct TracedLines {
    std::vector<TracedLine> lines;  // along the stems
    float length_m = 0.0f;          // l
    float error_m = 0.0f;  // eps_l: within it lie 99.5 % of the surface; the rest are caps and collars
    float largest_error_m = 0.0f;            // of all of it
    std::vector<uint32_t> line_of_triangle;  // the nearest one of its stem; empty where there are no lines
};

// As few lines of about equal length as follow the stems within a quarter of their radius, and no more than
// half the part's triangles. Requires a clean mesh and its skeleton. Parallel; the same on any number of
// threads.
TracedLines trace_lines(const PartDescription& part, const TracedSkeleton& skeleton);

// A stretch of consecutive segments of one stem.
struct StemRange {
    uint32_t first, last;  // segments [first, last)
    float length_m;
};
std::vector<StemRange> find_stems(const std::vector<SkeletonSegment>& segments);

}  // namespace coppice
