#pragma once
// How a source that Highway compiles once for each CPU target calls the version for the target in use. Include it in
// that source's HWY_ONCE part: which targets there are is known only there.

#include <hwy/detect_targets.h>

#include "base/cpu.h"

#if !defined(PENTAPRISM_SCALAR_ONLY) && (HWY_TARGETS & HWY_AVX3)
#define PENTAPRISM_CASE_AVX512(...) \
    case Isa::kAvx512:              \
        return N_AVX3::__VA_ARGS__;
#else
#define PENTAPRISM_CASE_AVX512(...)
#endif

#if !defined(PENTAPRISM_SCALAR_ONLY) && (HWY_TARGETS & HWY_AVX2)
#define PENTAPRISM_CASE_AVX2(...) \
    case Isa::kAvx2:              \
        return N_AVX2::__VA_ARGS__;
#else
#define PENTAPRISM_CASE_AVX2(...)
#endif

#if !defined(PENTAPRISM_SCALAR_ONLY) && (HWY_TARGETS & HWY_NEON)
#define PENTAPRISM_CASE_NEON(...) \
    case Isa::kNeon:              \
        return N_NEON::__VA_ARGS__;
#else
#define PENTAPRISM_CASE_NEON(...)
#endif

/// Returns from the surrounding function with the expression's value, a function or a call of one, as compiled for
/// cpu_isa(). Where nothing was compiled for it, the next statement follows: the scalar reference.
#define PENTAPRISM_RETURN_FOR_CPU(...)      \
    switch (cpu_isa()) {                    \
        PENTAPRISM_CASE_AVX512(__VA_ARGS__) \
        PENTAPRISM_CASE_AVX2(__VA_ARGS__)   \
        PENTAPRISM_CASE_NEON(__VA_ARGS__)   \
        default:                            \
            break;                          \
    }                                       \
    static_assert(true)
