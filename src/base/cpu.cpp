#include "base/cpu.h"

#include <hwy/targets.h>

#include <cstdlib>
#include <pentaprism/error.h>

namespace pentaprism {
namespace {

bool has(Isa isa) {
#ifdef PENTAPRISM_SCALAR_ONLY
    return isa == Isa::kScalar;
#else
    static const auto targets = hwy::SupportedTargets();  // asks the processor, which is slow on virtual machines
    switch (isa) {
        case Isa::kScalar: return true;
        case Isa::kNeon: return (targets & HWY_NEON) != 0;
        case Isa::kAvx2: return (targets & HWY_AVX2) != 0;
        case Isa::kAvx512: return (targets & HWY_AVX3) != 0;
    }
    return false;
#endif
}

}  // namespace

const char* isa_name(Isa isa) {
    switch (isa) {
        case Isa::kScalar: return "scalar";
        case Isa::kNeon: return "neon";
        case Isa::kAvx2: return "avx2";
        case Isa::kAvx512: return "avx512";
    }
    return "scalar";
}

Isa cpu_isa() {
    constexpr Isa kBestFirst[] = {Isa::kAvx512, Isa::kAvx2, Isa::kNeon, Isa::kScalar};
    if (const char* wanted = std::getenv("PENTAPRISM_ISA"); wanted != nullptr && *wanted != '\0') {
        for (const Isa isa : kBestFirst) {
            if (std::string(wanted) != isa_name(isa)) continue;
            if (has(isa)) return isa;
            throw Error(ErrorKind::kUsage, std::string("PENTAPRISM_ISA=") + wanted + ": this processor or build does not have it");
        }
        throw Error(ErrorKind::kUsage,
                    std::string("PENTAPRISM_ISA=") + wanted + ": unknown; it takes avx512, avx2, neon or scalar");
    }
    for (const Isa isa : kBestFirst)
        if (has(isa)) return isa;
    return Isa::kScalar;
}

}  // namespace pentaprism
