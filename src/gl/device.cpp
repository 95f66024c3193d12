// EGL without a display: EGL_EXT_platform_device for the first real device, else Mesa's surfaceless platform, which
// gives llvmpipe where there is none.

#include "gl/device.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <pentaprism/error.h>
#include <string_view>
#include <vector>

#include "base/parallel.h"
#include "gl/objects.h"
#include "gl/program.h"

namespace pentaprism::gl {
namespace {

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorKind::kBackend, fmt::format("--backend gl: {}; install a driver of OpenGL 4.5 (on Debian "
                                                 "libegl1 and libgl1-mesa-dri, which need no graphics card)",
                                                 why));
}

bool has(const char* extensions, std::string_view name) {
    return extensions != nullptr && std::string_view(extensions).find(name) != std::string_view::npos;
}

bool is_software(EGLDeviceEXT device) {
    return has(eglQueryDeviceStringEXT(device, EGL_EXTENSIONS), "EGL_MESA_device_software");
}

// Graphics cards first, in the order of the driver.
std::vector<EGLDisplay> displays() {
    std::vector<EGLDisplay> found;
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (has(client, "EGL_EXT_platform_device") && has(client, "EGL_EXT_device_enumeration") &&
        has(client, "EGL_EXT_device_query")) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        eglQueryDevicesEXT(devices.size(), devices.data(), &count);
        for (int i = 0; i < count; ++i)
            if (!is_software(devices[i]))
                found.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
    }
    if (has(client, "EGL_MESA_platform_surfaceless"))
        found.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    if (found.empty()) found.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
    return found;
}

EGLContext context_on(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return EGL_NO_CONTEXT;
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!has(extensions, "EGL_KHR_surfaceless_context") || !has(extensions, "EGL_KHR_no_config_context"))
        return EGL_NO_CONTEXT;
    if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
    // A robust context says when the driver has lost it (a card that was reset); without it, that is undefined.
    for (const EGLint strategy : {EGL_LOSE_CONTEXT_ON_RESET, EGL_NO_RESET_NOTIFICATION}) {
        const bool robust = strategy == EGL_LOSE_CONTEXT_ON_RESET;
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     robust ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY : EGL_NONE,
                                     strategy,
                                     EGL_NONE};
        const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
        if (context != EGL_NO_CONTEXT) return context;
    }
    return EGL_NO_CONTEXT;
}

int limit(GLenum name) {
    GLint value = 0;
    glGetIntegerv(name, &value);
    return value;
}

// Sums that come out otherwise if the product is rounded first.
bool fma_rounds_once() {
    constexpr int kCount = 64;
    std::array<std::array<float, 4>, kCount> terms{};
    for (int i = 0; i < kCount; ++i) {
        const float a = 1.0f + static_cast<float>(2 * i + 1) * 0x1p-20f,
                    b = 1.0f - static_cast<float>(i + 1) * 0x1p-19f;
        terms[i] = {a, b, -(a * b), 0.0f};
    }
    const Buffer in(sizeof terms, terms.data()), out(kCount * sizeof(float));
    const Program program({{GL_COMPUTE_SHADER, "gl/probe.comp.glsl"}}, {});
    in.bind(GL_SHADER_STORAGE_BUFFER, 0);
    out.bind(GL_SHADER_STORAGE_BUFFER, 1);
    program.use();
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::array<float, kCount> sums{};
    out.read(0, sizeof sums, sums.data());
    for (int i = 0; i < kCount; ++i)
        if (sums[i] != std::fma(terms[i][0], terms[i][1], terms[i][2])) return false;
    return true;
}

}  // namespace

Device& Device::get() {
    // Never destroyed: at exit the driver's own libraries may be gone before it.
    static Device* device = new Device();
    return *device;
}

Device::Device() {
    // epoxy ends the process if this library is not there.
    if (dlopen("libEGL.so.1", RTLD_LAZY) == nullptr) refuse("there is no libEGL.so.1");
    if (dlopen("libGL.so.1", RTLD_LAZY) == nullptr && dlopen("libOpenGL.so.0", RTLD_LAZY) == nullptr)
        refuse("there is no libGL.so.1");
    // Threads that have used OpenGL must be gone when its libraries are: both free what a thread keeps.
    std::atexit(end_threads);
    make_context();
    const Current current(*this);
    look_around();
}

void Device::make_context() {
    for (const EGLDisplay display : displays()) {
        context_ = context_on(display);
        display_ = display;
        if (context_ != EGL_NO_CONTEXT) return;
    }
    refuse("EGL gives no context of OpenGL 4.5 without a display");
}

void Device::look_around() {
    name_ = fmt::format("{}, OpenGL {}", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                        reinterpret_cast<const char*>(glGetString(GL_VERSION)));
    samples_ = std::max(
        1, std::min({limit(GL_MAX_INTEGER_SAMPLES), limit(GL_MAX_COLOR_TEXTURE_SAMPLES), limit(GL_MAX_SAMPLES)}));
    max_size_ = std::min(limit(GL_MAX_TEXTURE_SIZE), limit(GL_MAX_VIEWPORT_DIMS));
    // A sample takes a texel of a buffer texture and 8 bytes of a storage block.
    most_block_bytes_ = limit(GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    most_texels_ = limit(GL_MAX_TEXTURE_BUFFER_SIZE);
    most_entries_ = std::min(most_texels_, most_block_bytes_ / 8);
    fused_ = fma_rounds_once();
    check("asking the driver");
}

const Program& Device::program(const std::string& name, const std::function<Program()>& make) {
    const auto known = programs_.find(name);
    return known != programs_.end() ? known->second : programs_.emplace(name, make()).first->second;
}

std::vector<std::string> Device::defines() const {
    return fused_ ? std::vector<std::string>{"FUSED_FMA"} : std::vector<std::string>{};
}

Device::Current::Current(Device& device) : device_(device), lock_(device.mutex_), outermost_(device.depth_++ == 0) {
    if (outermost_ && !eglMakeCurrent(device.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, device.context_)) {
        --device.depth_;
        throw Error(ErrorKind::kBackend, "--backend gl: the OpenGL context cannot be used any more; start again");
    }
}

Device::Current::~Current() {
    --device_.depth_;
    if (outermost_) eglMakeCurrent(device_.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

void check(const char* doing) {
    GLenum error = glGetError();
    if (error == GL_NO_ERROR && glGetGraphicsResetStatus() != GL_NO_ERROR) error = GL_CONTEXT_LOST;
    if (error == GL_NO_ERROR) return;
    while (error != GL_CONTEXT_LOST && glGetError() != GL_NO_ERROR) {
    }
    const char* what = error == GL_OUT_OF_MEMORY  ? "out of graphics memory"
                       : error == GL_CONTEXT_LOST ? "the driver has lost the context"
                                                  : "an error of OpenGL";
    throw Error(ErrorKind::kBackend, fmt::format("--backend gl: {} while {} (0x{:04x})", what, doing, error));
}

}  // namespace pentaprism::gl
