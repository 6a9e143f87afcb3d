// One lane adds to one of a few counters.
#version 460
layout(local_size_x_id = 0) in;
layout(binding = 0, std430) buffer Counters { uint counters[]; };
layout(push_constant) uniform Push {
    uint element_count;
    uint counter_count;
    uint amount;
};

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < element_count) atomicAdd(counters[i % counter_count], amount);
}
