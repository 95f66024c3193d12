// What the layout of the samples does to pictures: frames of what is seen and nothing else (each triangle in one grey)
// by each sampler with many seeds, and a reference of many samples. Raw float32 pictures and index.json in FOLDER, for
// bench/sample_layout.py, which calls this:  sample_layout FOLDER [SEEDS [REFERENCE_SPP]]
//
// A part of the 1024x768 frame is rendered, so that blur is as many pixels as there. Times: processor time of covering,
// one thread, the least over the seeds.

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <limits>

#include "base/parallel.h"
#include "cases.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"
#include "support/flat_pictures.h"

namespace pentaprism::bench {
namespace {

// Whole cells, two periods of the patterns wide, where much moves and is out of focus.
PixelRect part_of(const std::string& name) {
    const int x = name.starts_with("fairy") ? 160 : name.starts_with("car") ? 480 : 384;
    const int y = name.starts_with("fairy") ? 288 : name.starts_with("car") ? 192 : 320;
    return {x, x + 256, y, y + 128};
}

struct Pattern {
    const char* name;
    Sampler sampler;
};
constexpr Pattern kPatterns[] = {{"stratified", Sampler::kStratified},
                                 {"sobol", Sampler::kSobol},
                                 {"blue-noise", Sampler::kBlueNoise},
                                 {"independent", Sampler::kIndependent}};

double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void write_floats(const std::filesystem::path& file, const std::vector<float>& values) {
    std::ofstream out(file, std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(4 * values.size()));
    if (!out) {
        fmt::print(stderr, "sample_layout: cannot write {}\n", file.string());
        std::exit(4);
    }
}

class Layouts {
  public:
    Layouts(std::filesystem::path folder, int seeds, int reference_spp)
        : folder_(std::move(folder)), seeds_(seeds), reference_spp_(reference_spp) {}

    // With two steps: frames that follow each other, for what a pattern does to an animation.
    void measure(const Case& which, int steps) {
        const Scene scene = load_scene(which.source);
        const RenderSettings settings = settings_for(which, scene);
        part_ = part_of(which.name);
        for (int step = 0; step < steps; ++step) {
            const PosedPicture picture = pose_picture(scene, settings, which.frame + step);
            const Visibility visibility(picture.frame, picture.samples, settings.method, part_);
            const std::vector<float> greys = support::flat_greys(picture.frame);
            const auto render = [&](Sampler sampler, int spp, std::uint32_t seed, double& ms) {
                MethodSettings method = settings.method;
                method.sampler = sampler;
                method.seed = seed;
                const SampleTable samples = make_samples(picture.frame, spp, method);
                const double start = processor_ms();
                auto out = support::flat_picture(visibility, samples, greys, part_);
                ms = std::min(ms, processor_ms() - start);
                return out;
            };
            double reference_ms = std::numeric_limits<double>::infinity();
            const auto reference = render(Sampler::kStratified, reference_spp_, 999'999, reference_ms);
            write(which, step, "reference", reference_spp_, 1, reference, reference_ms);
            for (const Pattern& pattern : kPatterns) {
                double ms = std::numeric_limits<double>::infinity();
                std::vector<float> all;
                for (int seed = 0; seed < seeds_; ++seed) {
                    const std::vector<float> one =
                        render(pattern.sampler, settings.image.spp, static_cast<std::uint32_t>(seed), ms);
                    all.insert(all.end(), one.begin(), one.end());
                }
                write(which, step, pattern.name, settings.image.spp, seeds_, all, ms);
            }
        }
    }

    void finish() { std::ofstream(folder_ / "index.json") << "[\n" << index_ << "\n]\n"; }

  private:
    void write(const Case& which, int step, const std::string& sampler, int spp, int seeds,
               const std::vector<float>& pictures, double ms) {
        std::string file = fmt::format("{}-{}-{}.f32", which.name, step, sampler);
        std::replace(file.begin(), file.end(), '/', '-');
        write_floats(folder_ / file, pictures);
        index_ += fmt::format(
            "{}{{\"frame\": \"{}\", \"step\": {}, \"sampler\": \"{}\", \"spp\": {}, \"seeds\": {}, "
            "\"width\": {}, \"height\": {}, \"ms\": {:.3f}, \"file\": \"{}\"}}",
            index_.empty() ? "" : ",\n", which.name, step, sampler, spp, seeds, part_.x1 - part_.x0,
            part_.y1 - part_.y0, ms, file);
        fmt::print(stderr, "{} {} {}: {:.1f} ms\n", which.name, step, sampler, ms);
    }

    std::filesystem::path folder_;
    int seeds_, reference_spp_;
    std::string index_;
    PixelRect part_;
};

}  // namespace
}  // namespace pentaprism::bench

int main(int argc, char** argv) {
    using namespace pentaprism::bench;
    if (argc < 2) {
        fmt::print(stderr, "usage: sample_layout FOLDER [SEEDS [REFERENCE_SPP]]\n");
        return 2;
    }
    pentaprism::set_thread_count(1);
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    Layouts layouts(folder, argc > 2 ? std::atoi(argv[2]) : 24, argc > 3 ? std::atoi(argv[3]) : 4096);
    std::vector<Case> frames;
    for (const Case& which : cases())
        if (which.name == "fairy-forest/both" || which.name == "fairy-forest/both-x2" || which.name == "forest/both" ||
            which.name == "car/motion")
            frames.push_back(which);
    for (const Case& both : std::vector<Case>(frames)) {
        if (both.effect != Effect::kBoth) continue;
        const std::string scene = both.name.substr(0, both.name.find('/'));
        for (const auto& [name, effect] :
             {std::pair("motion", Effect::kMotion), std::pair("defocus", Effect::kDefocus)}) {
            Case one = both;
            one.name = scene + "/" + name;
            one.effect = effect;
            frames.push_back(one);
        }
    }
    for (const Case& which : frames)
        layouts.measure(which, which.name.starts_with("fairy-forest") && which.effect != Effect::kBothTwice ? 2 : 1);
    layouts.finish();
}
