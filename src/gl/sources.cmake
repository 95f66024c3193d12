# Puts every shader of src/ into the program: the *.glsl files beside the C++ files whose twins they are, and those of src/gl.
# gl_sources.cpp has each by its path in src/, which is how shaders include one another.
function(pentaprism_write_gl_sources output)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/*.glsl)
  list(SORT files)
  set(entries "")
  foreach(file IN LISTS files)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    file(READ ${file} text)
    string(APPEND entries "    {\"${file}\", R\"glsl(${text})glsl\"},\n")
  endforeach()
  file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[
// Written by src/gl/sources.cmake from the *.glsl files in src; changes here are lost.
#include "gl/program.h"

namespace pentaprism::gl {

std::span<const ShaderSource> shader_sources() {
    static constexpr ShaderSource kSources[] = {
@entries@    };
    return kSources;
}

}  // namespace pentaprism::gl
]])
endfunction()

if(PENTAPRISM_HAVE_GL)
  set(gl_sources ${CMAKE_CURRENT_BINARY_DIR}/gl_sources.cpp)
  pentaprism_write_gl_sources(${gl_sources})
  target_sources(pentaprism_gl PRIVATE ${gl_sources})
endif()
