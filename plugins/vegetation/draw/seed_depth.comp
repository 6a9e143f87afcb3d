#version 460
// The host's depth into the visibility buffer, in place of clearing it: without a surface, so that whatever is not nearer
// loses against it, and what is left can be told apart.
#extension GL_GOOGLE_include_directive : require
#include "plugins/vegetation/draw/host_picture.glsl"

layout(binding = 0) writeonly buffer Visibility { uint64_t visibility[]; };
layout(binding = 1) writeonly buffer Words { uint words[]; };
layout(binding = 2) readonly buffer Depth { float depth[]; };

void main() {
    uint row, first, last;
    if (!take_run(row, first, last)) return;
    for (uint column = first + gl_LocalInvocationID.x; column < last; column += gl_WorkGroupSize.x) {
        uint i = row * frame.width + column;
        float inverse_w = (depth[i] - frame.depth_offset) / frame.depth_scale;
        // What is nearer than our near distance hides all; what is no number, nothing.
        float ours = inverse_w > 0.0 ? min(inverse_w * frame.near_m, 1.0) : 0.0;
        uint word = floatBitsToUint(ours);
        words[i] = word;
        visibility[i] = uint64_t(word) << 32;
    }
}
