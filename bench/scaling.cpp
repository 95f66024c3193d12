// How the time of visibility (binning and covering, one thread) grows with triangles, samples, blur and size. JSON on
// stdout, for bench/plot_scaling.py; what it does on stderr:  scaling [RUNS [triangles|samples|blur|pixels]] >
// scaling.json
//
// Processor time of the whole process, the least of RUNS: others' work on the machine counts little.

#include <cstdlib>
#include <ctime>
#include <fmt/format.h>
#include <limits>
#include <unordered_map>

#include "base/parallel.h"
#include "cases.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"

namespace pentaprism::bench {
namespace {

// Each triangle in four, by the middles of its edges. All is affine before the division by w, so the surface and its
// motion stay what they are. Only for scenes without transparency, whose triangles ask nothing of their primitives.
Frame subdivided(const Frame& frame) {
    Frame finer = frame;
    finer.points.clear();
    finer.corners.clear();
    finer.part_of.clear();
    for (std::size_t p = 0; p < frame.parts.size(); ++p) {
        const Part& from = frame.parts[p];
        Part& to = finer.parts[p];
        std::unordered_map<std::uint64_t, std::uint32_t> middles;  // of edges: vertex
        std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto edge = std::minmax(a, b);
            const auto [found, is_new] = middles.emplace(std::uint64_t{edge.first} << 32 | edge.second,
                                                         from.vertex_count + static_cast<std::uint32_t>(edges.size()));
            if (is_new) edges.emplace_back(edge);
            return found->second;
        };
        to.first_triangle = static_cast<std::uint32_t>(finer.part_of.size());
        to.triangle_count = 4 * from.triangle_count;
        to.first_point = static_cast<std::uint32_t>(finer.points.size());
        for (std::uint32_t t = from.first_triangle; t < from.first_triangle + from.triangle_count; ++t) {
            std::uint32_t v[3], m[3];
            for (int i = 0; i < 3; ++i) v[i] = frame.corners[3 * std::size_t{t} + i] - from.first_point;
            for (int i = 0; i < 3; ++i) m[i] = middle(v[i], v[(i + 1) % 3]);
            for (const std::uint32_t corner : {v[0], m[0], m[2], m[0], v[1], m[1], m[2], m[1], v[2], m[0], m[1], m[2]})
                finer.corners.push_back(to.first_point + corner);
            finer.part_of.insert(finer.part_of.end(), 4, static_cast<std::uint32_t>(p));
        }
        to.vertex_count = from.vertex_count + static_cast<std::uint32_t>(edges.size());
        for (int knot = 0; knot <= (from.moves ? from.segments : 0); ++knot) {
            const std::size_t first = from.first_point + std::size_t{from.vertex_count} * knot;
            finer.points.insert(finer.points.end(), &frame.points[first], &frame.points[first] + from.vertex_count);
            for (const auto& [a, b] : edges)
                finer.points.push_back(0.5f * (frame.points[first + a] + frame.points[first + b]));
        }
    }
    return finer;
}

double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double time_of(const Frame& frame, const SampleTable& samples, const RenderSettings& settings, int runs) {
    double least = std::numeric_limits<double>::infinity();
    for (int run = 0; run < runs; ++run) {
        const double start = processor_ms();
        const Visibility visibility(frame, samples, settings.method,
                                    {0, settings.image.width, 0, settings.image.height});
        Hits hits;
        CoverCounts counts;
        for (const Tile& tile : visibility.tiles()) visibility.cover(tile, hits, counts);
        least = std::min(least, processor_ms() - start);
    }
    return least;
}

class Curves {
  public:
    explicit Curves(int runs) : runs_(runs) {}

    void triangles(const Case& which, int levels) {
        const Scene scene = load_scene(which.source);
        const RenderSettings settings = settings_for(which, scene);
        const PosedPicture picture = pose_picture(scene, settings, which.frame);
        begin("triangles", which.name);
        Frame frame = picture.frame;
        for (int level = 0; level < levels; ++level) {
            if (level > 0) frame = subdivided(frame);
            add(frame.triangle_count(), time_of(frame, picture.samples, settings, runs_));
        }
        end();
    }

    void samples(const Case& which) {
        vary("samples", which, {4, 16, 64, 256},
             [](RenderSettings& settings, double spp) { settings.image.spp = static_cast<int>(spp); });
    }

    void size(const Case& which) {
        vary("pixels", which, {480, 768, 1536, 2160, 2880}, [](RenderSettings& settings, double height) {
            settings.image.height = static_cast<int>(height);
            settings.image.width = static_cast<int>(height) * 4 / 3;
            return height * height * 4 / 3;
        });
    }

    // Lens radius and open time of the shutter times a factor, as far as the case has them.
    void blur(const Case& which) {
        const Scene scene = load_scene(which.source);
        const LensInfo lens = scene.cameras.empty() ? LensInfo{} : scene.cameras.front().lens;
        vary("blur", which, {0, 0.5, 1, 2, 4, 8}, [&](RenderSettings& settings, double factor) {
            if (factor == 0.0) {
                settings.camera.defocus = settings.shutter.motion_blur = false;
                return;
            }
            settings.camera.fstop = lens.fstop.value_or(8.0) / factor;
            settings.shutter.shutter = lens.shutter.value_or(0.5) * factor;
        });
    }

    void finish() { fmt::print("\n]}}\n"); }

  private:
    template <class Change>
    void vary(const char* quantity, const Case& which, std::initializer_list<double> values, Change change) {
        const Scene scene = load_scene(which.source);
        begin(quantity, which.name);
        for (const double value : values) {
            RenderSettings settings = settings_for(which, scene);
            double x = value;
            if constexpr (std::is_void_v<decltype(change(settings, value))>)
                change(settings, value);
            else
                x = change(settings, value);
            const PosedPicture picture = pose_picture(scene, settings, which.frame);
            add(x, time_of(picture.frame, picture.samples, settings, runs_));
        }
        end();
    }

    void begin(const char* quantity, const std::string& name) {
        fmt::print("{}\n  {{\"quantity\": \"{}\", \"frame\": \"{}\", \"points\": [", first_ ? "{\"curves\": [" : ",",
                   quantity, name);
        first_ = false;
        first_point_ = true;
    }
    void add(double x, double ms) {
        fmt::print("{}[{}, {:.2f}]", first_point_ ? "" : ", ", x, ms);
        fmt::print(stderr, "{} {:.2f} ms\n", x, ms);
        first_point_ = false;
    }
    void end() {
        fmt::print("]}}");
        std::fflush(stdout);
    }

    int runs_;
    bool first_ = true, first_point_ = true;
};

}  // namespace
}  // namespace pentaprism::bench

int main(int argc, char** argv) {
    using namespace pentaprism::bench;
    const int runs = argc > 1 ? std::atoi(argv[1]) : 3;
    pentaprism::set_thread_count(1);
    const Case hand{"hand, defocus", "builtin:hand", Effect::kDefocus, 24},
        car{"car, motion", "builtin:car", Effect::kMotion, 24},
        forest{"fairy-forest, both", "builtin:fairy-forest", Effect::kBoth, 24},
        moving{"fairy-forest, motion", "builtin:fairy-forest", Effect::kMotion, 24},
        unfocused{"fairy-forest, defocus", "builtin:fairy-forest", Effect::kDefocus, 24};
    const std::string only = argc > 2 ? argv[2] : "";
    const auto wanted = [&](const char* quantity) { return only.empty() || only == quantity; };
    Curves curves(runs);
    if (wanted("triangles")) {
        curves.triangles(hand, 5);
        curves.triangles(car, 4);
    }
    if (wanted("samples"))
        for (const Case& which : {hand, car, forest}) curves.samples(which);
    if (wanted("blur"))
        for (const Case& which : {forest, moving, unfocused}) curves.blur(which);
    if (wanted("pixels")) curves.size(forest);
    curves.finish();
}
