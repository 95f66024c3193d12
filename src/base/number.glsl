// Arithmetic that gives the bits of the C++ code on any driver. Everything that decides is `precise`: nothing may be
// reordered or fused but where it is written so.

// std::fma. A driver may carry out fma() as two roundings (Mesa's llvmpipe does); src/gl/device.cpp asks, and defines
// FUSED_FMA where it is one. Otherwise in double, where the product is exact: that differs only where the sum, rounded to
// 53 bits, lies exactly between two floats, once in about 2^29 sums.
float fused(float a, float b, float c) {
#ifdef FUSED_FMA
    precise float sum = fma(a, b, c);
#else
    precise double exact = double(a) * double(b) + double(c);
    precise float sum = float(exact);
#endif
    return sum;
}

vec3 fused(float a, vec3 b, vec3 c) {
    return vec3(fused(a, b.x, c.x), fused(a, b.y, c.y), fused(a, b.z, c.z));
}

// a / b, rounded once: a driver may be off by some units in the last place, which one step from the exact remainder
// repairs.
float quotient(float a, float b) {
    precise float q = a / b;
#ifdef FUSED_FMA
    precise float rest = fma(-q, b, a);
    precise float better = q + rest / b;
    if (!isinf(q) && !isnan(better)) q = better;
#endif
    return q;
}

float least(vec3 v) {
    return min(min(v.x, v.y), v.z);
}
float largest(vec3 v) {
    return max(max(v.x, v.y), v.z);
}
double least(dvec3 v) {
    return min(min(v.x, v.y), v.z);
}
double largest(dvec3 v) {
    return max(max(v.x, v.y), v.z);
}

const double kUnitRoundoff = 1.0lf / 16777216.0lf;
const double kHuge = 1e300lf;  // stands for infinity
