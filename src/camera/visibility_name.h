#pragma once

#include <pentaprism/settings.h>

namespace pentaprism {

/// As `--visibility` has it.
const char* name_of(VisibilityMethod method);

}  // namespace pentaprism
