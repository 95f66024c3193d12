#pragma once
// Tests that run on each CPU target the machine has.

#include <cstdlib>
#include <pentaprism/error.h>
#include <string>

#include "base/cpu.h"

namespace pentaprism::support {

// The CPU target of the environment while this lives.
class UseIsa {
  public:
    explicit UseIsa(const char* name) {
        if (const char* old = std::getenv("PENTAPRISM_ISA")) old_ = old;
        setenv("PENTAPRISM_ISA", name, 1);
    }
    ~UseIsa() {
        if (old_.empty())
            unsetenv("PENTAPRISM_ISA");
        else
            setenv("PENTAPRISM_ISA", old_.c_str(), 1);
    }

  private:
    std::string old_;
};

inline bool has_isa(const char* name) {
    const UseIsa use(name);
    try {
        cpu_isa();
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace pentaprism::support
