#include "gl/program.h"

#include <algorithm>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <set>

namespace pentaprism::gl {
namespace {

struct ShaderKind {
    static void end(GLuint name) { glDeleteShader(name); }
};

[[noreturn]] void refuse(std::string_view path, const std::string& complaint) {
    const std::string first = complaint.substr(0, complaint.find('\n'));
    throw Error(ErrorKind::kBackend, fmt::format("--backend gl: the driver refuses shader {}: {}", path,
                                                 first.empty() ? "without a reason" : first));
}

std::string_view find(std::string_view path, std::span<const ShaderSource> extra) {
    for (const std::span<const ShaderSource> some : {extra, shader_sources()})
        for (const ShaderSource& source : some)
            if (source.path == path) return source.text;
    throw Error(ErrorKind::kBackend, fmt::format("--backend gl: there is no shader {}", path));
}

// Line numbers stay those of the file; which file, the compiler does not need to know.
void append(std::string_view path, std::span<const ShaderSource> extra, std::set<std::string, std::less<>>& known,
            std::string& out) {
    if (!known.insert(std::string(path)).second) return;
    std::string_view text = find(path, extra);
    for (int line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view here = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        constexpr std::string_view kInclude = "#include \"";
        if (here.substr(0, kInclude.size()) != kInclude) {
            out.append(here).append("\n");
            continue;
        }
        append(here.substr(kInclude.size(), here.rfind('"') - kInclude.size()), extra, known, out);
        out += fmt::format("#line {}\n", line + 1);
    }
}

Object<ShaderKind> compile(const Stage& stage, const std::string& head, std::span<const ShaderSource> extra) {
    Object<ShaderKind> shader(glCreateShader(stage.kind));
    const std::string text = head + assemble(stage.path, extra);
    const char* const lines = text.c_str();
    glShaderSource(shader, 1, &lines, nullptr);
    glCompileShader(shader);
    GLint good = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (good) return shader;
    char complaint[1024] = "";
    glGetShaderInfoLog(shader, sizeof complaint, nullptr, complaint);
    refuse(stage.path, complaint);
}

}  // namespace

std::string assemble(std::string_view path, std::span<const ShaderSource> extra) {
    std::string text;
    std::set<std::string, std::less<>> known;
    append(path, extra, known, text);
    return text;
}

Program::Program(const std::vector<Stage>& stages, const std::vector<std::string>& defines,
                 std::span<const ShaderSource> extra)
    : object_(glCreateProgram()) {
    std::string head = "#version 450 core\n";
    for (const std::string& name : defines) head += fmt::format("#define {}\n", name);
    std::vector<Object<ShaderKind>> shaders;
    for (const Stage& stage : stages) {
        shaders.push_back(compile(stage, head, extra));
        glAttachShader(object_, shaders.back());
    }
    glLinkProgram(object_);
    for (const auto& shader : shaders) glDetachShader(object_, shader);
    GLint good = GL_FALSE;
    glGetProgramiv(object_, GL_LINK_STATUS, &good);
    if (good) return;
    char complaint[1024] = "";
    glGetProgramInfoLog(object_, sizeof complaint, nullptr, complaint);
    refuse(stages.back().path, complaint);
}

}  // namespace pentaprism::gl
