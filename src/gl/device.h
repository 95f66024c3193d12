#pragma once
// The OpenGL context of this process: made without a display when it is first asked for, kept to the end. Contexts
// belong to one thread at a time, so whoever works with it holds a Current.

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "gl/program.h"

namespace pentaprism::gl {

class Device {
  public:
    /// Throws Error(kBackend) if there is no driver, or none of OpenGL 4.5; the next call tries again.
    static Device& get();

    /// The context belongs to this thread, and to nobody else, as long as it lives. Every GL call and the end of every
    /// GL object (gl/objects.h) needs one around it.
    class Current {
      public:
        explicit Current(Device& device);
        ~Current();
        Current(const Current&) = delete;
        Current& operator=(const Current&) = delete;

      private:
        Device& device_;
        std::lock_guard<std::recursive_mutex> lock_;
        bool outermost_;
    };

    const std::string& name() const { return name_; }            ///< renderer and version, as the driver says
    int samples() const { return samples_; }                     ///< most samples of a pixel in one pass
    int max_size() const { return max_size_; }                   ///< pixels a side of a framebuffer
    std::int64_t most_entries() const { return most_entries_; }  ///< samples that a buffer holds
    std::int64_t most_texels() const { return most_texels_; }    ///< elements of a buffer that is read as a texture
    std::int64_t most_block_bytes() const {                      ///< of a storage block
        return pretended_block_bytes_ > 0 ? pretended_block_bytes_ : most_block_bytes_;
    }

    /// For tests: as on a device with smaller storage blocks. 0: its own again.
    void pretend_block_bytes(std::int64_t bytes) { pretended_block_bytes_ = bytes; }

    /// The program of that name, kept for all frames; made by `make` when it is first asked for.
    const Program& program(const std::string& name, const std::function<Program()>& make);

    /// Names that shaders ask for: FUSED_FMA if fma() rounds once.
    std::vector<std::string> defines() const;

  private:
    Device();
    void make_context();
    void look_around();

    void *display_ = nullptr, *context_ = nullptr;  // EGLDisplay, EGLContext
    std::recursive_mutex mutex_;
    int depth_ = 0;  // Currents of the thread that has it
    std::string name_;
    std::map<std::string, Program> programs_;
    int samples_ = 1, max_size_ = 0;
    std::int64_t most_entries_ = 0, most_texels_ = 0, most_block_bytes_ = 0, pretended_block_bytes_ = 0;
    bool fused_ = false;
};

/// Throws Error(kBackend) with one line if GL has met an error since it was last asked. `doing`: what was done.
void check(const char* doing);

}  // namespace pentaprism::gl
