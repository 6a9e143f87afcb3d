// One lane computes one element: target = source * factor + term.
#version 460
layout(local_size_x_id = 0) in;
layout(binding = 0, std430) readonly buffer Source { uint source[]; };
layout(binding = 1, std430) writeonly buffer Target { uint target[]; };
layout(push_constant) uniform Push {
    uint element_count;
    uint factor;
    uint term;
};

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < element_count) target[i] = source[i] * factor + term;
}
