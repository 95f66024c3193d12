// Single kernels, on one thread: what a triangle, a vector of sixteen samples, a question, a micropolygon and a vertex
// cost. The counter is the time of one; cover/* are the loops of the fast path on recorded tiles of a frame, without
// hidden triangles being left out.
//
//   build/ci/bench/kernel_bench --benchmark_filter=cull --benchmark_repetitions=5

#include <algorithm>
#include <benchmark/benchmark.h>
#include <functional>
#include <map>
#include <random>

#include "base/parallel.h"
#include "bin/bound_batch.h"
#include "cases.h"
#include "cover/dice.h"
#include "cover/exact.h"
#include "cover/scalar_walk.h"
#include "cover_kernels.h"
#include "cull/cull_test.h"
#include "peer/posed_picture.h"
#include "scene/pose.h"

namespace pentaprism::bench {
namespace {

// `count` of them in each iteration.
void set_time_of(benchmark::State& state, const char* unit, std::int64_t count) {
    state.counters[unit] = benchmark::Counter(
        static_cast<double>(count), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

PixelRect whole(const Frame& frame) {
    return {0, frame.view.width, 0, frame.view.height};
}

struct Loaded {
    Scene scene;
    RenderSettings settings;
    std::unique_ptr<PosedPicture> picture;
    std::unique_ptr<Bins> bins;
    std::unique_ptr<CoverKernels> kernels;
};

// One at a time.
Loaded& load(const Case& which) {
    static std::string name;
    static Loaded loaded;
    if (name != which.name) {
        loaded = {};
        loaded.scene = load_scene(which.source);
        loaded.settings = settings_for(which, loaded.scene);
        loaded.picture = std::make_unique<PosedPicture>(pose_picture(loaded.scene, loaded.settings, which.frame));
        const Frame& frame = loaded.picture->frame;
        loaded.bins = std::make_unique<Bins>(frame, kCellSize, whole(frame));
        name = which.name;
    }
    return loaded;
}

CoverKernels* recorded(benchmark::State& state, const Case& which) {
    Loaded& loaded = load(which);
    constexpr int kEveryTile = 37;
    if (!loaded.kernels)
        loaded.kernels = record_cover_kernels(loaded.picture->frame, loaded.picture->samples, *loaded.bins, kEveryTile);
    if (!loaded.kernels) state.SkipWithError("no vector code for this CPU target");
    return loaded.kernels.get();
}

void bench_bounds(benchmark::State& state, const Case& which) {
    const Frame& frame = load(which).picture->frame;
    std::vector<BinnedTriangle> out;
    out.reserve(load(which).bins->triangles().size());
    for (auto _ : state) {
        out.clear();
        bound_triangles(frame, 0, frame.triangle_count(), whole(frame), out);
        benchmark::DoNotOptimize(out.data());
    }
    set_time_of(state, "s/triangle", frame.triangle_count());
}

void bench_localize(benchmark::State& state, const Case& which) {
    const Loaded& loaded = load(which);
    const Frame& frame = loaded.picture->frame;
    for (auto _ : state)
        for (const BinnedTriangle& t : loaded.bins->triangles())
            benchmark::DoNotOptimize(
                localize(frame, t.triangle, t.segment, cell_centre(frame.view, t.x0 / kCellSize, t.y0 / kCellSize)));
    set_time_of(state, "s/triangle", static_cast<std::int64_t>(loaded.bins->triangles().size()));
}

void bench_set_up(benchmark::State& state, const Case& which) {
    CoverKernels* kernels = recorded(state, which);
    if (kernels == nullptr) return;
    for (auto _ : state) kernels->set_up();
    set_time_of(state, "s/triangle", kernels->triangles);
}

void bench_list(benchmark::State& state, const Case& which) {
    CoverKernels* kernels = recorded(state, which);
    if (kernels == nullptr) return;
    for (auto _ : state) kernels->list();
    set_time_of(state, "s/triangle", kernels->triangles);
    set_time_of(state, "s/vector", kernels->listed);
}

void bench_half_planes(benchmark::State& state, const Case& which) {
    CoverKernels* kernels = recorded(state, which);
    if (kernels == nullptr) return;
    for (auto _ : state) kernels->ask_half_planes();
    set_time_of(state, "s/vector", kernels->listed);
    state.counters["kept"] = static_cast<double>(kernels->kept) / static_cast<double>(kernels->listed);
}

void bench_exact(benchmark::State& state, const Case& which) {
    CoverKernels* kernels = recorded(state, which);
    if (kernels == nullptr) return;
    for (auto _ : state) {
        state.PauseTiming();
        kernels->start_depths();
        state.ResumeTiming();
        kernels->test_exactly();
    }
    set_time_of(state, "s/vector", kernels->kept);
    state.counters["hit"] = static_cast<double>(kernels->covered) / static_cast<double>(kernels->samples);
}

// Triangles of a frame, each in the cell of its box's middle, and what there is to ask of them there.
struct Question {
    int triangle;
    Footprint footprint;
    LocalSample sample;  // in it
};
struct Questions {
    std::vector<LocalTriangle> triangles;
    std::vector<CellCentre> centres;
    std::vector<Footprint> pictures;
    std::vector<Question> questions;
};

// Samples in the triangle's box, spread over it by a fixed rule.
Questions make_questions(const Loaded& loaded, Grain grain) {
    constexpr std::size_t kTriangles = 64;
    constexpr int kOfEach = 32;
    const Frame& frame = loaded.picture->frame;
    const View& view = frame.view;
    const float ratio = static_cast<float>(view.lens.ratio);
    const Domain all{-1.0f, 1.0f, -ratio, ratio, 0.0f, 1.0f};
    const auto triangles = loaded.bins->triangles();
    std::minstd_rand random(1);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    Questions out;
    for (std::size_t i = 0; i < kTriangles; ++i) {
        const BinnedTriangle& binned = triangles[triangles.size() * i / kTriangles];
        const int cx = (binned.x0 + binned.x1) / 2 / kCellSize, cy = (binned.y0 + binned.y1) / 2 / kCellSize;
        const CellCentre centre = cell_centre(view, cx, cy);
        const int left = cx * kCellSize, top = cy * kCellSize;
        const int x0 = std::max<int>(binned.x0, left), x1 = std::min<int>(binned.x1, left + kCellSize);
        const int y0 = std::max<int>(binned.y0, top), y1 = std::min<int>(binned.y1, top + kCellSize);
        if (x0 >= x1 || y0 >= y1) continue;
        out.triangles.push_back(localize(frame, binned.triangle, binned.segment, centre));
        out.centres.push_back(centre);
        const float px = -0.5f * static_cast<float>(view.width) - centre.x,
                    py = -0.5f * static_cast<float>(view.height) - centre.y;
        out.pictures.push_back(
            {px, px + static_cast<float>(view.width), py, py + static_cast<float>(view.height), all});
        for (int k = 0; k < kOfEach; ++k) {
            const int x = x0 + below(x1 - x0), y = y0 + below(y1 - y0);
            const int index = below(loaded.picture->samples.spp());
            Question question{static_cast<int>(out.triangles.size()) - 1, {}, {}};
            question.sample = local_sample(loaded.picture->samples.sample(x, y, index), x, y);
            const int cell_x = x - left, cell_y = y - top;
            if (grain == Grain::kTile)
                question.footprint = scalar_walk::square(cell_x / kCullTileSize * kCullTileSize,
                                                         cell_y / kCullTileSize * kCullTileSize, kCullTileSize, all);
            else if (grain == Grain::kPixel)
                question.footprint = scalar_walk::square(cell_x, cell_y, 1, all);
            else
                question.footprint = scalar_walk::bucket(loaded.picture->samples.block(
                    x / kBlockSize, y / kBlockSize)[loaded.picture->samples.slot_of(x, y, index)]);
            out.questions.push_back(question);
        }
    }
    return out;
}

void bench_cull_begin(benchmark::State& state, const Case& which, const CullTest* test) {
    const Questions Q = make_questions(load(which), test->grain);
    CullSetup setup;
    for (auto _ : state)
        for (std::size_t i = 0; i < Q.triangles.size(); ++i)
            benchmark::DoNotOptimize(test->begin(Q.triangles[i], Q.pictures[i], setup));
    set_time_of(state, "s/triangle", static_cast<std::int64_t>(Q.triangles.size()));
}

std::vector<CullSetup> setups(const Questions& Q, const CullTest* test) {
    std::vector<CullSetup> setups(Q.triangles.size());
    if (test->begin != nullptr)
        for (std::size_t i = 0; i < setups.size(); ++i) test->begin(Q.triangles[i], Q.pictures[i], setups[i]);
    return setups;
}

void bench_cull_prepare(benchmark::State& state, const Case& which, const CullTest* test) {
    const Questions Q = make_questions(load(which), test->grain);
    const std::vector<CullSetup> of_triangles = setups(Q, test);
    CullState cull;
    std::int64_t kept = 0;
    for (auto _ : state) {
        kept = 0;
        for (const Question& q : Q.questions) {
            cull.setup = &of_triangles[q.triangle];
            kept += test->prepare(Q.triangles[q.triangle], q.footprint, cull);
        }
        benchmark::DoNotOptimize(kept);
    }
    const auto count = static_cast<std::int64_t>(Q.questions.size());
    set_time_of(state, "s/footprint", count);
    state.counters["kept"] = static_cast<double>(kept) / static_cast<double>(count);
}

void bench_cull_keeps(benchmark::State& state, const Case& which, const CullTest* test) {
    const Questions Q = make_questions(load(which), test->grain);
    const std::vector<CullSetup> of_triangles = setups(Q, test);
    std::vector<CullState> states;
    std::vector<LocalSample> samples;
    for (const Question& q : Q.questions) {
        CullState& cull = states.emplace_back();
        cull.setup = &of_triangles[q.triangle];
        if (test->prepare(Q.triangles[q.triangle], q.footprint, cull))
            samples.push_back(q.sample);
        else
            states.pop_back();
    }
    if (states.empty()) return state.SkipWithError("every footprint was refused");
    std::int64_t kept = 0;
    for (auto _ : state) {
        kept = 0;
        for (std::size_t i = 0; i < states.size(); ++i) kept += test->keeps(states[i], samples[i]);
        benchmark::DoNotOptimize(kept);
    }
    set_time_of(state, "s/sample", static_cast<std::int64_t>(states.size()));
    state.counters["kept"] = static_cast<double>(kept) / static_cast<double>(states.size());
}

void bench_scalar_exact(benchmark::State& state, const Case& which) {
    const Questions Q = make_questions(load(which), Grain::kPixel);
    for (auto _ : state)
        for (const Question& q : Q.questions)
            benchmark::DoNotOptimize(cover_sample(Q.triangles[q.triangle], q.sample, Q.centres[q.triangle]));
    set_time_of(state, "s/sample", static_cast<std::int64_t>(Q.questions.size()));
}

void bench_dice(benchmark::State& state, const Case& which) {
    const Loaded& loaded = load(which);
    const Questions Q = make_questions(loaded, Grain::kPixel);
    const LocalBox cell{-16.0f, 16.0f, -16.0f, 16.0f};
    std::int64_t pieces = 0;
    Dicer::Visitor visitor;
    visitor.visit = [&](const Micropolygon&, bool) { ++pieces; };
    for (auto _ : state) {
        pieces = 0;
        for (std::size_t i = 0; i < Q.triangles.size(); ++i)
            Dicer(Q.centres[i], loaded.picture->frame.view.lens.ratio).dice(Q.triangles[i], cell, visitor);
    }
    set_time_of(state, "s/micropolygon", pieces);
    set_time_of(state, "s/triangle", static_cast<std::int64_t>(Q.triangles.size()));
}

// One mesh: placed by a matrix, with four joints of 32 for each vertex, or with four morph targets.
enum class Deform { kRigid, kSkin, kMorph };
Scene deformed_scene(Deform deform) {
    constexpr int kVertices = 20000, kJoints = 32, kTargets = 4;
    std::minstd_rand random(1);
    const auto number = [&] { return static_cast<float>(random() % 2001) * 1e-3f - 1.0f; };
    Scene scene;
    Primitive primitive;
    for (int i = 0; i < kVertices; ++i) {
        primitive.positions.emplace_back(number(), number(), number());
        primitive.normals.emplace_back(0.0f, 0.0f, 1.0f);
    }
    primitive.indices = {0, 1, 2};
    Node node;
    node.transform.translation = {0.1, 0.2, 0.3};
    node.mesh = 0;
    if (deform == Deform::kSkin) {
        primitive.influences = 4;
        for (int i = 0; i < 4 * kVertices; ++i) {
            primitive.joints.push_back(static_cast<std::uint16_t>(random() % kJoints));
            primitive.weights.push_back(0.25f);
        }
        node.skin = 0;
        Skin skin;
        for (int i = 0; i < kJoints; ++i) {
            skin.joints.push_back(1 + i);
            skin.inverse_bind_matrices.emplace_back(1.0f);
        }
        scene.skins.push_back(skin);
    }
    if (deform == Deform::kMorph) {
        for (int i = 0; i < kTargets; ++i) {
            MorphTarget& target = primitive.targets.emplace_back();
            for (int k = 0; k < kVertices; ++k) target.positions.emplace_back(number(), number(), number());
            node.weights.push_back(0.25f);
        }
    }
    scene.meshes.push_back({"mesh", {primitive}, node.weights});
    scene.nodes.push_back(node);
    scene.roots.push_back(0);
    if (deform == Deform::kSkin)
        for (int i = 0; i < kJoints; ++i) {
            Node joint;
            joint.transform.translation = {0.01 * i, 0.0, 0.0};
            scene.nodes.push_back(joint);
            scene.roots.push_back(1 + i);
        }
    return scene;
}

void bench_pose(benchmark::State& state, Deform deform) {
    const Scene scene = deformed_scene(deform);
    const Pose pose = evaluate(scene, {}, 0.0);
    const Placement placement = placements(scene).front();
    std::vector<glm::dvec3> out(scene.meshes[0].primitives[0].positions.size());
    for (auto _ : state) {
        pose_positions(scene, pose, placement, out);
        benchmark::DoNotOptimize(out.data());
    }
    set_time_of(state, "s/vertex", static_cast<std::int64_t>(out.size()));
}

void bench_animation(benchmark::State& state, const Case& which) {
    const Scene& scene = load(which).scene;
    const std::vector<Index> animations = choose_animations(scene, "all");
    double time = 0.0;
    for (auto _ : state) benchmark::DoNotOptimize(evaluate(scene, animations, time += 1e-3));
    set_time_of(state, "s/node", static_cast<std::int64_t>(scene.nodes.size()));
}

template <class Function, class... Arguments>
void add(const std::string& name, Function function, Arguments... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), function, arguments...)->Unit(benchmark::kMicrosecond);
}

}  // namespace
}  // namespace pentaprism::bench

int main(int argc, char** argv) {
    using namespace pentaprism;
    using namespace pentaprism::bench;
    benchmark::Initialize(&argc, argv);
    set_thread_count(1);
    const std::vector<Case> all = cases();
    for (const char* name : {"hand/defocus", "car/motion", "fairy-forest/both", "fairy-forest/both-x2"}) {
        const Case which = *std::find_if(all.begin(), all.end(), [&](const Case& c) { return c.name == name; });
        add("bounds/" + which.name, bench_bounds, which);
        add("localize/" + which.name, bench_localize, which);
        add("cover/set_up/" + which.name, bench_set_up, which);
        add("cover/list/" + which.name, bench_list, which);
        add("cover/half_planes/" + which.name, bench_half_planes, which);
        add("cover/exact/" + which.name, bench_exact, which);
        add("exact_scalar/" + which.name, bench_scalar_exact, which);
        add("dice/" + which.name, bench_dice, which);
        add("animation/" + which.name, bench_animation, which);
        if (which.name != "fairy-forest/both") continue;
        for (const CullTest* test : cull_table()) {
            const std::string of = std::string("cull/") + test->name;
            if (test->begin != nullptr) add(of + "/begin", bench_cull_begin, which, test);
            add(of + "/prepare", bench_cull_prepare, which, test);
            add(of + "/keeps", bench_cull_keeps, which, test);
        }
    }
    add("pose/rigid", bench_pose, Deform::kRigid);
    add("pose/skinned", bench_pose, Deform::kSkin);
    add("pose/morphed", bench_pose, Deform::kMorph);
    benchmark::RunSpecifiedBenchmarks();
}
