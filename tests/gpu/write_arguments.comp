// One lane writes the arguments of an indirect dispatch.
#version 460
layout(local_size_x_id = 0) in;
layout(binding = 0, std430) buffer Arguments { uint arguments[]; };
layout(push_constant) uniform Push { uint group_count; };

void main() {
    if (gl_GlobalInvocationID.x != 0) return;
    arguments[0] = 7;  // not part of the arguments: they start at an offset
    arguments[1] = group_count;
    arguments[2] = 1;
    arguments[3] = 1;
}
