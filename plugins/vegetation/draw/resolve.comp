#version 460
// Lights each pixel once and makes the picture. A sample a pixel is weighed with its neighbours by a tent, which is
// nearer to the mean over the pixel than the sample alone: what is drawn is finer than pixels.
// A lane takes k_columns columns of a block, row by row; a neighbour's light comes from the lane beside, the rows above
// and below from the loop, so nothing is lit or fetched twice but at the block's borders.
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle_relative : require
#include "plugins/vegetation/draw/shade_pixel.glsl"

layout(constant_id = 1) const bool k_mean = false;  // of the mean that accumulate made, not of the frame
layout(constant_id = 2) const int k_columns = 4;
layout(constant_id = 3) const int k_rows = 64;
layout(binding = 4) writeonly buffer Color { uint color[]; };

vec3 light_at(Light sun, int column, int row, int width, int height) {
    uint x = uint(clamp(column, 0, width - 1)), y = uint(clamp(row, 0, height - 1));
    if (!k_mean) return shade_pixel(sun, x, y);
    uint place = (y * uint(width) + x) * 3u;
    return vec3(radiance[place], radiance[place + 1u], radiance[place + 2u]);
}

void main() {
    int width = int(frame.right.w), height = int(frame.up.w);
    Light sun = light;
    float side = frame.side_weight, own = 1.0 / (1.0 + 2.0 * side);
    side *= own;
    int lanes = int(gl_SubgroupSize), lane = int(gl_SubgroupInvocationID);
    int block_width = lanes * k_columns - 2;  // the outermost columns have a neighbour missing
    int blocks_across = (width + block_width - 1) / block_width, blocks_down = (height + k_rows - 1) / k_rows;
    int group = int(gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x);
    int stride = int(gl_NumWorkGroups.x * gl_NumWorkGroups.y * gl_NumSubgroups);
    for (int block = group * int(gl_NumSubgroups) + int(gl_SubgroupID); block < blocks_across * blocks_down;
         block += stride) {
        int block_down = block / blocks_across;
        int first_column = (block - block_down * blocks_across) * block_width - 1;
        int end_column = min(first_column + 1 + block_width, width), lane_column = first_column + lane * k_columns;
        int first_row = block_down * k_rows, end_row = min(first_row + k_rows, height);
        vec3 above[k_columns], here[k_columns];
        for (int row = first_row - 1; row <= end_row; ++row) {
            vec3 lit[k_columns];
            for (int i = 0; i < k_columns; ++i) lit[i] = light_at(sun, lane_column + i, row, width, height);
            vec3 left = subgroupShuffleUp(lit[k_columns - 1], 1u), right = subgroupShuffleDown(lit[0], 1u);
            for (int i = 0; i < k_columns; ++i) {
                vec3 before = i > 0 ? lit[max(i - 1, 0)] : left;
                vec3 after = i < k_columns - 1 ? lit[min(i + 1, k_columns - 1)] : right;
                vec3 below = lit[i] * own + (before + after) * side;
                int column = lane_column + i;
                if (row > first_row && column > first_column && column < end_column) {
                    vec3 sum = here[i] * own + (above[i] + below) * side;
                    vec3 shown = frame.view == k_view_coverage ? encode_srgb(sum) : present(sun, sum);
                    uvec3 bytes = uvec3(shown * 255.0 + 0.5);
                    color[uint(row - 1) * uint(width) + uint(column)] =
                        bytes.x | bytes.y << 8 | bytes.z << 16 | 0xff000000u;
                }
                above[i] = here[i];
                here[i] = below;
            }
        }
    }
}
