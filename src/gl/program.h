#pragma once
// Programs of shaders that are files: found by their path in src/, with #include as in C++.

#include <epoxy/gl.h>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gl/objects.h"

namespace pentaprism::gl {

struct ShaderSource {
    std::string_view path, text;
};

/// All *.glsl files of src/, built in (gl/sources.cmake).
std::span<const ShaderSource> shader_sources();

/// A file with all that it includes, each file once. `extra`: further files, asked for first. Throws Error(kBackend)
/// for a file that does not exist.
std::string assemble(std::string_view path, std::span<const ShaderSource> extra = {});

struct ProgramKind {
    static void end(GLuint name) { glDeleteProgram(name); }
};

struct Stage {
    GLenum kind;  ///< such as GL_VERTEX_SHADER
    std::string_view path;
};

class Program {
  public:
    Program() = default;

    /// `defines`: names that shaders ask for with #ifdef. Throws Error(kBackend) with the compiler's first complaint.
    Program(const std::vector<Stage>& stages, const std::vector<std::string>& defines,
            std::span<const ShaderSource> extra = {});

    void use() const { glUseProgram(object_); }

    // Uniforms; one that the program does not use is left alone.
    void set(const char* name, int value) const { glProgramUniform1i(object_, at(name), value); }
    void set(const char* name, unsigned value) const { glProgramUniform1ui(object_, at(name), value); }
    void set(const char* name, float value) const { glProgramUniform1f(object_, at(name), value); }
    void set(const char* name, double value) const { glProgramUniform1d(object_, at(name), value); }
    void set(const char* name, float a, float b) const { glProgramUniform2f(object_, at(name), a, b); }
    void set(const char* name, float a, float b, float c, float d) const {
        glProgramUniform4f(object_, at(name), a, b, c, d);
    }
    void set(const char* name, int a, int b) const { glProgramUniform2i(object_, at(name), a, b); }
    void set(const char* name, unsigned a, unsigned b) const { glProgramUniform2ui(object_, at(name), a, b); }
    void set(const char* name, int a, int b, int c, int d) const { glProgramUniform4i(object_, at(name), a, b, c, d); }

  private:
    GLint at(const char* name) const { return glGetUniformLocation(object_, name); }

    Object<ProgramKind> object_;
};

}  // namespace pentaprism::gl
