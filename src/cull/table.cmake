# Writes the table of culling tests: every src/cull/<stem>.cpp defines `extern const CullTest <stem>_test`, so a new test is
# one new file and no list to edit. Not tests by themselves: <stem>_fast.cpp (the vector sibling of <stem>.cpp) and
# cull_*.cpp (what tests share).
function(pentaprism_write_cull_table output)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/cull/*.cpp)
  set(declarations "")
  set(entries "")
  foreach(file IN LISTS files)
    get_filename_component(stem ${file} NAME_WE)
    if(stem MATCHES "_fast$|^cull_")
      continue()
    endif()
    string(APPEND declarations "extern const CullTest ${stem}_test;\n")
    list(APPEND entries "&${stem}_test")
  endforeach()
  list(LENGTH entries count)
  list(JOIN entries ", " entries)
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[
// Written by src/cull/table.cmake from the file names in src/cull; changes here are lost.
#include <array>

#include "cull/cull_test.h"

namespace pentaprism {

@declarations@
std::span<const CullTest* const> cull_table() {
    static constexpr std::array<const CullTest*, @count@> kTable{@entries@};
    return kTable;
}

}  // namespace pentaprism
]])
endfunction()

if(TARGET pentaprism_cull)
  set(cull_table ${CMAKE_CURRENT_BINARY_DIR}/cull_table.cpp)
  pentaprism_write_cull_table(${cull_table})
  target_sources(pentaprism_cull PRIVATE ${cull_table})
endif()
