#version 460
// A view at rest: adds the frame's light to the mean of those before. One group takes up to 256 pixels of a row, a lane
// every n-th.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/shade_pixel.glsl"

const uint k_run = 256u;  // pixels of one row

void main() {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    uint width = uint(frame.right.w), runs_a_row = (width + k_run - 1u) / k_run;
    uint row = group / runs_a_row, first = (group - row * runs_a_row) * k_run;
    if (row >= uint(frame.up.w)) return;
    uint last = min(first + k_run, width);
    Light sun = light;
    for (uint column = first + gl_LocalInvocationID.x; column < last; column += gl_WorkGroupSize.x) {
        uint place = (row * width + column) * 3u;
        vec3 mean = shade_pixel(sun, column, row);
        if (frame.new_share < 1.0)
            mean = mix(vec3(radiance[place], radiance[place + 1u], radiance[place + 2u]), mean, frame.new_share);
        radiance[place] = mean.r;
        radiance[place + 1u] = mean.g;
        radiance[place + 2u] = mean.b;
    }
}
