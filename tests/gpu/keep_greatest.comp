// One lane takes one key, scales it, and keeps the greatest in the word it belongs to.
#version 460
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint k_scale = 1;

layout(binding = 0, std430) buffer Words { uint64_t words[]; };
layout(binding = 1) uniform utextureBuffer keys;
layout(push_constant) uniform Push {
    uint key_count;
    uint word_count;
};

void main() {
    uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    uint key = group * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (key >= key_count) return;
    uint64_t value = uint64_t(texelFetch(keys, int(key)).x * k_scale) << 32 | key;
    atomicMax(words[key % word_count], value);
}
