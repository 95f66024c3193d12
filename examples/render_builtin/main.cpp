// The smallest use of the library: a built-in scene, both blurs, the mean colour of the picture.
#include <cstdio>
#include <pentaprism/error.h>
#include <pentaprism/render.h>
#include <pentaprism/scene.h>

int main() {
    try {
        const pentaprism::Scene scene = pentaprism::make_builtin_scene("cubes");
        pentaprism::RenderSettings settings;
        settings.image.width = 64;
        settings.image.height = 36;
        settings.camera.fstop = 1.4;  // an open lens; motion blur is on by itself
        pentaprism::RenderStats stats;
        const pentaprism::Picture picture = pentaprism::render_picture(scene, settings, /*frame=*/0, stats);

        double mean[3] = {0.0, 0.0, 0.0};  // rgba holds 4 floats a pixel, linear
        const int pixels = picture.width * picture.height;
        for (int i = 0; i < pixels; ++i) {
            for (int c = 0; c < 3; ++c) mean[c] += picture.rgba[4 * i + c] / pixels;
        }
        std::printf("mean %.4f %.4f %.4f of %d x %d pixels, %lld triangles\n", mean[0], mean[1], mean[2], picture.width,
                    picture.height, static_cast<long long>(stats.triangles));
    } catch (const pentaprism::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return static_cast<int>(error.kind());
    }
}
