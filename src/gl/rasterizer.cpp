#include "gl/rasterizer.h"

#include <pentaprism/error.h>

#ifdef PENTAPRISM_HAVE_GL
#include "gl/culling.h"
#include "gl/device.h"
#include "gl/gl_rasterizer.h"
#endif

namespace pentaprism {

#ifdef PENTAPRISM_HAVE_GL

std::unique_ptr<Rasterizer> make_gl_rasterizer(const Frame& frame, const SampleTable& table,
                                               const MethodSettings& method, const PixelRect& limits) {
    return std::make_unique<gl::GlRasterizer>(frame, table, method, limits);
}

std::vector<std::string> gl_culling_choices() {
    std::vector<std::string> names = gl::culling_names();
    names.insert(names.begin(), "auto");
    return names;
}

std::string gl_device_name() {
    return gl::Device::get().name();
}

#else

namespace {
[[noreturn]] void refuse() {
    throw Error(ErrorKind::kBackend,
                "--backend gl: this build has no OpenGL; install libepoxy-dev and libegl-dev and build again");
}
}  // namespace

std::unique_ptr<Rasterizer> make_gl_rasterizer(const Frame&, const SampleTable&, const MethodSettings&,
                                               const PixelRect&) {
    refuse();
}

std::vector<std::string> gl_culling_choices() {
    return {};
}

std::string gl_device_name() {
    refuse();
}

#endif

}  // namespace pentaprism
