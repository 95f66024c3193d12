// Does fma() round once? (gl/device.cpp)

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Terms { vec4 terms[]; };
layout(std430, binding = 1) writeonly buffer Sums { float sums[]; };

void main() {
    vec4 t = terms[gl_LocalInvocationIndex];
    precise float sum = fma(t.x, t.y, t.z);
    sums[gl_LocalInvocationIndex] = sum;
}
