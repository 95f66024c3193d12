#pragma once
// The papers' pipeline (McGuire, Enderton, Shirley, Luebke 2010; Wu 2013): the vertex shader takes both ends of a
// motion segment, the geometry shader emits the conservative bound, the fragment shader runs the culling test and the
// exact test for one sample, the framebuffer keeps the nearest of each sample.

#include "gl/pass.h"

namespace pentaprism::gl {

class RasterPass : public Pass {
  public:
    /// For regions of at most that many pixels, and passes of at most `slots` samples.
    RasterPass(Device& device, const PassData& data, const Culling& culling, int width, int height, int slots);
    void run(const Region& region, int count, bool is_first) override;

  private:
    void draw() const;

    PassData data_;
    const Program &raster_, &collector_;
    Object<TextureKind> seen_;
    Object<RenderbufferKind> depth_;
    Object<FramebufferKind> framebuffer_;
};

}  // namespace pentaprism::gl
