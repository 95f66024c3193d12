#pragma once
// OpenGL objects that end with their owner. All of it needs a Device::Current.

#include <cstddef>
#include <epoxy/gl.h>
#include <utility>

namespace pentaprism::gl {

/// A name of OpenGL. `Kind::end` deletes it.
template <class Kind>
class Object {
  public:
    Object() = default;
    explicit Object(GLuint name) : name_(name) {}
    Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Object& operator=(Object&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~Object() {
        if (name_ != 0) Kind::end(name_);
    }
    operator GLuint() const { return name_; }

  private:
    GLuint name_ = 0;
};

struct BufferKind {
    static void end(GLuint name) { glDeleteBuffers(1, &name); }
};
struct TextureKind {
    static void end(GLuint name) { glDeleteTextures(1, &name); }
};
struct FramebufferKind {
    static void end(GLuint name) { glDeleteFramebuffers(1, &name); }
};
struct RenderbufferKind {
    static void end(GLuint name) { glDeleteRenderbuffers(1, &name); }
};
struct VertexArrayKind {
    static void end(GLuint name) { glDeleteVertexArrays(1, &name); }
};

/// Memory of the device, of a size that stays. `data`: what it begins with, or nullptr.
class Buffer {
  public:
    Buffer() = default;
    explicit Buffer(std::size_t bytes, const void* data = nullptr) {
        GLuint name = 0;
        glCreateBuffers(1, &name);
        object_ = Object<BufferKind>(name);
        glNamedBufferStorage(name, static_cast<GLsizeiptr>(bytes > 0 ? bytes : 1), bytes > 0 ? data : nullptr,
                             GL_DYNAMIC_STORAGE_BIT);
    }
    void bind(GLenum target, GLuint index) const { glBindBufferBase(target, index, object_); }
    void write(std::size_t offset, std::size_t bytes, const void* data) const {
        glNamedBufferSubData(object_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
    }
    void read(std::size_t offset, std::size_t bytes, void* data) const {
        glGetNamedBufferSubData(object_, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes), data);
    }
    operator GLuint() const { return object_; }

  private:
    Object<BufferKind> object_;
};

inline Object<TextureKind> make_texture(GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    return Object<TextureKind>(name);
}
/// A buffer that shaders read as a texture.
inline Object<TextureKind> view_of(const Buffer& buffer, GLenum format) {
    Object<TextureKind> view = make_texture(GL_TEXTURE_BUFFER);
    glTextureBuffer(view, format, buffer);
    return view;
}
inline Object<FramebufferKind> make_framebuffer() {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    return Object<FramebufferKind>(name);
}
inline Object<RenderbufferKind> make_renderbuffer() {
    GLuint name = 0;
    glCreateRenderbuffers(1, &name);
    return Object<RenderbufferKind>(name);
}
inline Object<VertexArrayKind> make_vertex_array() {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    return Object<VertexArrayKind>(name);
}

}  // namespace pentaprism::gl
