#pragma once
// Where the program's memory comes from.

namespace pentaprism::cli {

/// Large arrays on pages of 2 MB, if the system has any to give: to be called first. A frame's arrays are tens of
/// megabytes, on pages of 4 KB thousands of faults and misses in the translation buffer ever after
/// (docs/develop/performance.md). Does nothing without mimalloc.
void ask_for_huge_pages();

}  // namespace pentaprism::cli
