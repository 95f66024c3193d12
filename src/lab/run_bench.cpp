// The order of a whole plan: scenes, effects of each, methods of each.

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <pentaprism/bench.h>
#include <pentaprism/error.h>
#include <pentaprism/verify.h>

#include "base/parallel.h"
#include "gl/rasterizer.h"
#include "lab/effects.h"
#include "lab/images.h"
#include "lab/machine.h"
#include "lab/measure.h"
#include "trace/tracer.h"

namespace pentaprism {
namespace {

constexpr double kBuiltinFrame = 24.0;  // each built-in scene is at its best there

std::vector<BenchEffect> chosen_effects(const BenchPlan& plan) {
    if (plan.effects.empty()) return bench_effects();
    std::vector<BenchEffect> effects;
    for (const std::string& name : plan.effects) effects.push_back(find_effect(name));
    return effects;
}

std::vector<std::string> chosen_methods(const BenchPlan& plan) {
    if (plan.methods.empty())
        return plan.settings.method.backend == Backend::kGl ? gl_culling_choices() : bench_default_methods();
    for (const std::string& method : plan.methods) settings_of(method, plan.settings.method);
    return plan.methods;
}

double frame_of(const BenchPlan& plan, const std::string& scene) {
    if (plan.frame >= 0.0) return plan.frame;
    return scene.rfind("builtin:", 0) == 0 ? kBuiltinFrame : 0.0;
}

std::string short_name(const std::string& scene) {
    const std::string prefix = "builtin:";
    return scene.rfind(prefix, 0) == 0 ? scene.substr(prefix.size()) : scene;
}

class Laboratory {
  public:
    Laboratory(const BenchPlan& plan, const BenchProgress& progress)
        : plan_(plan),
          progress_(progress),
          scenes_(plan.scenes.empty() ? bench_default_scenes() : plan.scenes),
          effects_(chosen_effects(plan)),
          methods_(chosen_methods(plan)) {
        validate(plan.settings);
    }

    BenchReport run() {
        const auto start = std::chrono::steady_clock::now();
        set_thread_count(plan_.settings.method.threads);
        report_.machine = this_machine();
        report_.width = plan_.settings.image.width;
        report_.height = plan_.settings.image.height;
        report_.spp = plan_.settings.image.spp;
        report_.seed = plan_.settings.method.seed;
        check_scenes();
        for (const std::string& name : scenes_) run_scene(name);
        report_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        return std::move(report_);
    }

  private:
    // Scenes that cannot be read are told of now, not after hours of measuring the others.
    void check_scenes() const {
        if (scenes_.size() == 1) return;  // read at once
        for (const std::string& name : scenes_) {
            tell(short_name(name) + ": checking");
            load_scene(name);
        }
    }

    void run_scene(const std::string& name) {
        tell(short_name(name) + ": reading");
        const Scene scene = load_scene(name);
        const double frame = frame_of(plan_, name);
        const BenchScene description = describe_scene(scene, plan_.settings, frame);
        report_.scenes.push_back(description);
        for (const BenchEffect& effect : effects_) {
            const RenderSettings settings = with_effect(plan_.settings, description, effect);
            run_effect(scene, settings, frame, effect);
            if (!plan_.peer_threads.empty()) time_peers(scene, settings, frame, effect);
            ++done_;
        }
    }

    void run_effect(const Scene& scene, const RenderSettings& settings, double frame, const BenchEffect& effect) {
        const std::string place = short_name(scene.name) + " " + effect.name;
        const KeepGoing keep_going = [&](const std::string& what) {
            return !progress_ || progress_(step(place + ", " + what));
        };
        tell(place + ": posing");
        set_thread_count(settings.method.threads);
        const PosedPicture picture = pose_picture(scene, settings, frame);
        Measurements measured = measure_methods(
            picture, {methods_, settings.method, plan_.most_tests, plan_.runs, plan_.seconds}, keep_going);
        measured.cell.scene = scene.name;
        measured.cell.effect = effect.name;
        report_.cells.push_back(measured.cell);
        for (BenchRow& row : measured.rows) {
            row.scene = scene.name;
            row.effect = effect.name;
            report_.rows.push_back(std::move(row));
        }
        if (!plan_.images) return;
        tell(place + ": rendering the picture");
        RenderStats stats;
        const Picture rendered =
            render_picture(scene, resized(settings, plan_.picture_width, plan_.picture_spp), frame, stats);
        report_.images.push_back(picture_image(rendered, scene.name, effect.name));
        if (effect.name == map_effect()) make_maps(scene, settings, frame, effect, keep_going);
    }

    static RenderSettings resized(RenderSettings settings, int width, int spp) {
        ImageSettings& image = settings.image;
        image.height = std::max(1, image.height * width / image.width);
        image.width = width;
        image.spp = spp;
        return settings;
    }

    void make_maps(const Scene& scene, const RenderSettings& as_measured, double frame, const BenchEffect& effect,
                   const KeepGoing& keep_going) {
        const RenderSettings settings =
            resized(as_measured, std::min(as_measured.image.width, plan_.map_width), plan_.map_spp);
        const PosedPicture picture = pose_picture(scene, settings, frame);
        FrameWalk walk(picture.frame, picture.samples, settings.method, 0, keep_going);
        walk.make_reference();
        std::vector<MethodMap> maps;
        for (const std::string& method : methods_) {
            // Other ways of sampling and the vector path record no maps.
            if (settings_of(method, settings.method).culling != "auto") walk.count(method, &maps.emplace_back());
        }
        RenderStats stats;
        const Picture rendered = render_picture(scene, settings, frame, stats);
        add_map_images(maps, rendered, plan_.map_spp, scene.name, effect.name, report_.images);
    }

    // Heat maps are made of one effect: both blurs, or the last that is measured.
    const std::string& map_effect() const {
        for (const BenchEffect& effect : effects_)
            if (effect.name == "both") return effect.name;
        return effects_.back().name;
    }

    void time_peers(const Scene& scene, RenderSettings settings, double frame, const BenchEffect& effect) {
        for (const int threads : plan_.peer_threads) {
            settings.method.threads = threads;
            tell(fmt::format("{} {}: against Embree", short_name(scene.name), effect.name));
            const PeerTimes times = time_against_embree(scene, settings, frame, plan_.runs);
            report_.peers.push_back({scene.name, effect.name, times.peer, times.threads, times.runs, times.build_ms,
                                     times.trace_ms, times.ours_ms});
        }
        set_thread_count(plan_.settings.method.threads);
    }

    BenchStep step(const std::string& what) const {
        return {what, static_cast<double>(done_) / static_cast<double>(scenes_.size() * effects_.size())};
    }
    void tell(const std::string& what) const {
        if (progress_ && !progress_(step(what))) throw Error(ErrorKind::kRender, "interrupted");
    }

    const BenchPlan& plan_;
    const BenchProgress& progress_;
    std::vector<std::string> scenes_;
    std::vector<BenchEffect> effects_;
    std::vector<std::string> methods_;
    BenchReport report_;
    std::size_t done_ = 0;
};

}  // namespace

std::vector<std::string> bench_methods() {
    std::vector<std::string> names;
    for (const CullingChoice& choice : culling_tests()) names.push_back(choice.name);
    for (const char* visibility : {"accumulation", "interleaved", "micropolygon"}) names.emplace_back(visibility);
    if (!tracer_name().empty()) names.emplace_back("raytrace");
    return names;
}

std::vector<std::string> bench_default_methods() {
    std::vector<std::string> names = bench_methods();
    std::erase(names, "micropolygon");
    return names;
}

std::vector<std::string> bench_default_scenes() {
    std::vector<std::string> scenes;
    for (const char* name : {"hand", "car", "dragonfly", "fairy-forest", "conan"})
        for (const BuiltinScene& scene : builtin_scenes())
            if (scene.name == name) scenes.push_back("builtin:" + std::string(name));
    return scenes;
}

BenchPlan full_bench_plan() {
    BenchPlan plan;
    plan.settings.image.width = 1024;
    plan.settings.image.height = 768;
    return plan;
}

BenchPlan quick_bench_plan() {
    BenchPlan plan;
    plan.scenes = {"builtin:hand", "builtin:car"};
    plan.settings.image.width = 160;
    plan.settings.image.height = 120;
    plan.settings.image.spp = 4;
    plan.settings.method.tile_size = 16;
    plan.runs = 3;
    plan.seconds = 0.05;
    plan.most_tests = 1'000'000;
    plan.picture_width = 320;
    plan.picture_spp = 16;
    plan.map_width = 160;
    plan.map_spp = 2;
    return plan;
}

BenchReport run_bench(const BenchPlan& plan, const BenchProgress& progress) {
    return Laboratory(plan, progress).run();
}

}  // namespace pentaprism
