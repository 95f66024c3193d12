// Visibility of whole frames by stage, on one thread. Counters say what a unit of each costs: ns for each triangle of
// the frame (bin) and for each tested vector of sixteen samples (cover, everything around the test included).
//
//   bench_visibility --benchmark_filter=fairy --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true

#include <benchmark/benchmark.h>
#include <bit>
#include <fmt/format.h>
#include <map>
#include <memory>

#include "base/parallel.h"
#include "cases.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"

namespace pentaprism::bench {
namespace {

struct Loaded {
    Scene scene;
    RenderSettings settings;
    std::unique_ptr<PosedPicture> picture;
    PixelRect whole() const { return {0, settings.image.width, 0, settings.image.height}; }
};

// Posed when first asked for; one at a time, so that large scenes do not add up.
Loaded& load(const Case& which) {
    static std::string name;
    static Loaded loaded;
    if (name != which.name) {
        loaded = {};
        loaded.scene = load_scene(which.source);
        loaded.settings = settings_for(which, loaded.scene);
        set_thread_count(loaded.settings.method.threads);
        loaded.picture = std::make_unique<PosedPicture>(pose_picture(loaded.scene, loaded.settings, which.frame));
        name = which.name;
    }
    return loaded;
}

void set_rate(benchmark::State& state, const char* unit, double count) {
    state.counters[unit] =
        benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void bench_pose(benchmark::State& state, const Case& which) {
    Loaded& loaded = load(which);
    const std::vector<Index> animations = choose_animations(loaded.scene, "all");
    for (auto _ : state)
        benchmark::DoNotOptimize(
            pose_frame(loaded.scene, loaded.picture->frame.view, animations, loaded.settings.shutter));
    set_rate(state, "s/triangle", loaded.picture->frame.triangle_count());
}

void bench_bin(benchmark::State& state, const Case& which) {
    Loaded& loaded = load(which);
    for (auto _ : state)
        benchmark::DoNotOptimize(
            Visibility(loaded.picture->frame, loaded.picture->samples, loaded.settings.method, loaded.whole()));
    set_rate(state, "s/triangle", loaded.picture->frame.triangle_count());
}

// Depends on every bit of every hit: equal for all CPU targets and versions that are right.
std::uint64_t fingerprint(const Visibility& visibility) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    const auto take = [&](std::uint32_t word) { hash = (hash ^ word) * 0x100000001b3u; };
    Hits hits;
    CoverCounts counts;
    for (const Tile& tile : visibility.tiles()) {
        visibility.cover(tile, hits, counts);
        for (const float depth : hits.depth) take(std::bit_cast<std::uint32_t>(depth));
        for (const std::uint32_t triangle : hits.triangle) take(triangle);
    }
    return hash;
}

void bench_cover(benchmark::State& state, const Case& which) {
    Loaded& loaded = load(which);
    const Visibility visibility(loaded.picture->frame, loaded.picture->samples, loaded.settings.method, loaded.whole());
    Hits hits;
    CoverCounts counts;
    for (auto _ : state) {
        counts = {};
        for (const Tile& tile : visibility.tiles()) visibility.cover(tile, hits, counts);
    }
    set_rate(state, "s/vector", static_cast<double>(counts.tested) / kLanes);
    state.counters["Mvectors"] = static_cast<double>(counts.tested) / kLanes * 1e-6;
    state.SetLabel(fmt::format("hits {:016x}", fingerprint(visibility)));
    state.counters["efficiency"] = static_cast<double>(counts.covered) / static_cast<double>(counts.tested);
}

void bench_samples(benchmark::State& state, int spp) {
    for (auto _ : state) benchmark::DoNotOptimize(SampleTable(spp, 0, Lens{}, Grouping::kBoth));
}

}  // namespace
}  // namespace pentaprism::bench

int main(int argc, char** argv) {
    using namespace pentaprism::bench;
    benchmark::Initialize(&argc, argv);
    const std::vector<Case> all = cases();
    for (const Case& which : all) {
        for (const auto& [stage, run] :
             {std::pair("cover", &bench_cover), std::pair("bin", &bench_bin), std::pair("pose", &bench_pose)})
            benchmark::RegisterBenchmark((which.name + "/" + stage).c_str(), run, which)->Unit(benchmark::kMillisecond);
    }
    for (const int spp : {16, 256})
        benchmark::RegisterBenchmark(("samples/" + std::to_string(spp)).c_str(), bench_samples, spp)
            ->Unit(benchmark::kMillisecond);
    benchmark::RunSpecifiedBenchmarks();
}
