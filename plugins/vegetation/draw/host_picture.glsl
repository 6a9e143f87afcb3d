// What seed_depth and composite share: the host's depth, as stored and as ours. A group takes up to 256 pixels of a row,
// a lane every n-th.
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
layout(local_size_x_id = 0) in;

layout(push_constant) uniform Frame {
    uint width, height;
    float near_m;                     // our depth is near / w, 0 far
    float depth_offset, depth_scale;  // the host's is depth_offset + depth_scale / w
    float side_weight;                // of a neighbour beside or above, over the pixel's own
    uint view;                        // RepresentationView of lod/settings.h
} frame;

const uint k_run = 256u;  // pixels of one row

// The row of this group and its columns [first, last); false: none.
bool take_run(out uint row, out uint first, out uint last) {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    uint runs_a_row = (frame.width + k_run - 1u) / k_run;
    row = group / runs_a_row;
    first = (group - row * runs_a_row) * k_run;
    last = min(first + k_run, frame.width);
    return row < frame.height;
}
