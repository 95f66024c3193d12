// The laboratory: what it measures, what it tells of it, and in which words.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <pentaprism/bench.h>
#include <pentaprism/error.h>
#include <png.h>
#include <set>

#include "lab/effects.h"
#include "lab/pixels.h"
#include "lab/plot.h"
#include "lab/walk.h"
#include "peer/posed_picture.h"
#include "render/visibility.h"

namespace pentaprism {
namespace {

BenchPlan small_plan() {
    BenchPlan plan;
    plan.scenes = {"builtin:cubes"};
    plan.settings.image.width = 96;
    plan.settings.image.height = 64;
    plan.settings.image.spp = 4;
    plan.runs = 1;
    plan.images = false;
    return plan;
}

BenchReport made_up_report() {
    BenchReport report;
    report.machine = {"A <b>CPU</b> & more", "avx2", "GCC", "Linux", 2, 2, 8.0};
    report.width = 64, report.height = 48, report.spp = 4;
    report.scenes.push_back({"odd, \"name\" & <tag>_1", "", 12, 0, 24, 0.5, 0.01, 2.8, 3.0, false});
    for (const char* effect : {"still", "both"}) {
        report.cells.push_back({report.scenes[0].name, effect, 0.25, 3.0, 2.0, 0.5});
        for (const char* method : {"auto", "none", "improved-dual-space@tile"}) {
            BenchRow row;
            row.scene = report.scenes[0].name;
            row.effect = effect;
            row.method = method;
            row.samples = 1000, row.tested = 400, row.covered = 100;
            row.setup_ms = 1.5, row.test_ms = 2.5, row.frame_ms = 4.0, row.runs = 3;
            report.rows.push_back(row);
        }
    }
    report.peers.push_back({report.scenes[0].name, "both", "embree 3", 2, 3, 10.0, 20.0, 15.0});
    report.images.push_back({report.scenes[0].name, "both", "none", BenchImageKind::kTested, 1, 1, 5.0, 1.0,
                             encode_png({1, 1, {1, 2, 3}})});
    return report;
}

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(BenchEffects, AreTheSevenOfTheContract) {
    std::vector<std::string> names;
    for (const BenchEffect& effect : bench_effects()) names.push_back(effect.name);
    EXPECT_EQ(names,
              (std::vector<std::string>{"still", "motion", "motion-x2", "defocus", "defocus-x2", "both", "both-x2"}));
    EXPECT_EQ(find_effect("both-x8").motion, 8.0);
    EXPECT_EQ(find_effect("both-x8").defocus, 8.0);
    EXPECT_EQ(find_effect("motion-x0.5").motion, 0.5);
    EXPECT_EQ(find_effect("motion-x0.5").defocus, 0.0);
    for (const char* name : {"Motion", "motion-x", "motion-x0", "motion-x-1", "motion-xinf", "motion-xnan",
                             "motion-x65", "motion-x2x", "still-x2", "both-x2-x2", "both-x2 "})
        EXPECT_THROW(find_effect(name), Error) << name;
}

TEST(BenchEffects, DoublingDoublesTheShutterAndTheLensAndKeepsTheFocus) {
    const Scene scene = make_builtin_scene("car");
    const RenderSettings settings = small_plan().settings;
    const BenchScene description = describe_scene(scene, settings, 24);
    EXPECT_TRUE(description.own_lens);
    const View once = make_view(scene, with_effect(settings, description, find_effect("both")), 24);
    const View twice = make_view(scene, with_effect(settings, description, find_effect("both-x2")), 24);
    const View own = make_view(scene, settings, 24);
    EXPECT_DOUBLE_EQ(once.lens.radius, own.lens.radius);
    EXPECT_DOUBLE_EQ(twice.lens.radius, 2 * own.lens.radius);
    EXPECT_DOUBLE_EQ(twice.lens.focus_distance, own.lens.focus_distance);
    EXPECT_NEAR(once.shutter.close - once.shutter.open, own.shutter.close - own.shutter.open, 1e-12);
    EXPECT_NEAR(twice.shutter.close - twice.shutter.open, 2 * (own.shutter.close - own.shutter.open), 1e-12);
    EXPECT_NEAR(twice.shutter.middle(), own.shutter.middle(), 1e-12);
    const View still = make_view(scene, with_effect(settings, description, find_effect("still")), 24);
    EXPECT_TRUE(still.lens.pinhole());
    EXPECT_EQ(still.shutter.open, still.shutter.close);
}

TEST(BenchEffects, ASceneWithoutALensGetsTheStatedOne) {
    Scene scene = make_builtin_scene("car");
    for (Camera& camera : scene.cameras) camera.lens.fstop.reset();
    const BenchScene description = describe_scene(scene, small_plan().settings, 24);
    EXPECT_FALSE(description.own_lens);
    EXPECT_NEAR(description.fstop, 2.8, 1e-9);
    EXPECT_GT(description.lens_radius, 0.0);
    for (Camera& camera : scene.cameras) camera.perspective = false;
    const BenchScene orthographic = describe_scene(scene, small_plan().settings, 24);
    EXPECT_NEAR(orthographic.lens_radius, 0.005 * orthographic.focus_distance, 1e-9);
}

TEST(Bench, CountsWhatTheRendererCountsAndLosesNothing) {
    BenchPlan plan = small_plan();
    plan.effects = {"still", "both"};
    plan.methods = {"none", "improved-dual-space", "auto"};
    const BenchReport report = run_bench(plan);
    ASSERT_EQ(report.rows.size(), 6u);
    const Scene scene = make_builtin_scene("cubes");
    const BenchScene description = describe_scene(scene, plan.settings, 24);
    for (const BenchRow& row : report.rows) {
        EXPECT_EQ(row.false_culls, 0) << row.method;
        EXPECT_EQ(row.samples, 96 * 64 * 4);
        EXPECT_GT(row.covered, 0);
        EXPECT_GT(row.tested, row.covered);
        EXPECT_GT(row.frame_ms, 0.0);
        EXPECT_NEAR(row.setup_ms + row.test_ms, row.frame_ms, 1e-9);
        EXPECT_GT(row.peak_mb, 1.0);
        RenderSettings settings = with_effect(plan.settings, description, find_effect(row.effect));
        settings.method.culling = row.method;
        settings.image.filter = Filter::kBox;  // the picture's pixels alone are rendered
        RenderStats stats;
        render_picture(scene, settings, 24, stats);
        EXPECT_EQ(row.tested, stats.tested) << row.method << " " << row.effect;
        EXPECT_EQ(row.covered, stats.covered) << row.method << " " << row.effect;
    }
    EXPECT_EQ(report.rows[3].covered, report.rows[4].covered);
    EXPECT_LT(report.rows[4].tested, report.rows[3].tested);
    EXPECT_EQ(report.cells[0].motion_px, 0.0);
    EXPECT_GT(report.cells[1].motion_px, 0.0);
    EXPECT_GT(report.cells[1].blur_px, 0.0);
}

TEST(Bench, OtherWaysToSeeAreComparedOnTheirOwnSamples) {
    BenchPlan plan = small_plan();
    plan.effects = {"both"};
    plan.methods = {"accumulation", "interleaved", "micropolygon"};
    const BenchReport report = run_bench(plan);
    ASSERT_EQ(report.rows.size(), 3u);
    for (const BenchRow& row : report.rows) {
        EXPECT_EQ(row.own_arithmetic, row.method == "micropolygon");
        EXPECT_GT(row.tested, row.covered) << row.method;
        EXPECT_LE(row.false_culls, row.own_arithmetic ? row.samples / 500 : 0) << row.method;
    }
}

TEST(Bench, ATestAsPrintedIsSeenToLoseSamples) {
    BenchPlan plan = small_plan();
    plan.scenes = {"builtin:car"};
    plan.effects = {"both"};
    plan.methods = {"clip-space-as-printed", "clip-space"};
    const BenchReport report = run_bench(plan);
    EXPECT_FALSE(report.rows[0].conservative);
    EXPECT_GT(report.rows[0].false_culls, 100);
    EXPECT_TRUE(report.rows[1].conservative);
    EXPECT_EQ(report.rows[1].false_culls, 0);
}

TEST(Bench, APartOfTheTilesIsAlwaysTheSameAndNeedsAboutTheTestsAskedFor) {
    RenderSettings settings = small_plan().settings;
    settings.image.width = 512, settings.image.height = 384;
    settings.camera.fstop = 2.0;
    settings.shutter.motion_blur = false;  // every sample of a box is tested: there are no pieces of paths
    const Scene scene = make_builtin_scene("cubes");
    const PosedPicture picture = pose_picture(scene, settings, 24);
    const KeepGoing go = [](const std::string&) { return true; };
    FrameWalk all(picture.frame, picture.samples, settings.method, 0, go);
    all.make_reference();
    const std::int64_t tests = all.count("none", nullptr).cover.tested;
    EXPECT_EQ(all.share(), 1.0);
    FrameWalk limited(picture.frame, picture.samples, settings.method, tests / 4, go),
        again(picture.frame, picture.samples, settings.method, tests / 4, go);
    EXPECT_NEAR(limited.share(), 0.25, 0.01);
    EXPECT_EQ(limited.share(), again.share());
    limited.make_reference();
    again.make_reference();
    const FrameWalk::Counts counts = limited.count("none", nullptr);
    EXPECT_EQ(counts.cover.tested, again.count("none", nullptr).cover.tested);
    EXPECT_NEAR(static_cast<double>(counts.cover.tested), tests / 4.0, tests / 16.0);
    EXPECT_EQ(counts.lost, 0);
    FrameWalk least(picture.frame, picture.samples, settings.method, 1, go);
    EXPECT_EQ(least.samples(), 32 * 32 * 4);
}

TEST(Bench, SetupAsksEveryQuestionAndTestsNothing) {
    const Scene scene = make_builtin_scene("cubes");
    RenderSettings settings = small_plan().settings;
    settings.camera.fstop = 2.0;
    const PosedPicture picture = pose_picture(scene, settings, 24);
    FrameWalk walk(picture.frame, picture.samples, settings.method, 0, [](const std::string&) { return true; });
    for (const char* method : {"none", "improved-dual-space", "improved-dual-space@tile+none@bucket"}) {
        const CoverCounts setup = walk.time_setup(method).cover, frame = walk.time_frame(method).cover;
        EXPECT_EQ(setup.tested, 0) << method;
        EXPECT_GT(frame.tested, 0) << method;
        // The step that refuses is asked once for each sample that would be tested, and once for each footprint that
        // reaches it.
        EXPECT_EQ(setup.asked, frame.asked + frame.tested) << method;
        EXPECT_GE(setup.footprints, frame.footprints) << method;
        EXPECT_EQ(setup.footprints - frame.footprints, setup.kept_footprints - frame.kept_footprints) << method;
    }
    EXPECT_GT(walk.time_setup("auto").ms, 0.0);
}

TEST(Bench, StopsWhenItIsTold) {
    int calls = 0;
    try {
        run_bench(small_plan(), [&](const BenchStep&) { return ++calls < 4; });
        FAIL() << "it went on";
    } catch (const Error& error) {
        EXPECT_STREQ(error.what(), "interrupted");
        EXPECT_EQ(calls, 4);
    }
}

TEST(Bench, RefusesNamesThatAreNone) {
    BenchPlan plan = small_plan();
    plan.methods = {"none", "nonsense"};
    EXPECT_THROW(run_bench(plan), Error);
    plan = small_plan();
    plan.effects = {"blur"};
    EXPECT_THROW(run_bench(plan), Error);
    plan = small_plan();
    plan.scenes = {"builtin:nothing"};
    EXPECT_THROW(run_bench(plan), Error);
}

TEST(Bench, TellsOfASceneThatIsNoneBeforeMeasuringTheOthers) {
    BenchPlan plan = small_plan();
    plan.scenes = {"builtin:cubes", "no such scene.glb"};
    std::vector<std::string> steps;
    const auto note = [&](const BenchStep& step) {
        steps.push_back(step.what);
        return true;
    };
    EXPECT_THROW(run_bench(plan, note), Error);
    EXPECT_EQ(steps, (std::vector<std::string>{"cubes: checking", "no such scene.glb: checking"}));
}

TEST(BenchReport, JsonHasTheKeysOfTheContract) {
    const nlohmann::json json = nlohmann::json::parse(bench_json(made_up_report()));
    EXPECT_TRUE(json.contains("machine"));
    ASSERT_EQ(json["rows"].size(), 6u);
    for (const char* key : {"scene", "effect", "method", "backend", "ste", "tested", "covered", "false_culls",
                            "setup_ms", "test_ms", "frame_ms", "peak_mb"})
        EXPECT_TRUE(json["rows"][0].contains(key)) << key;
    EXPECT_EQ(json["rows"][0]["ste"], 0.25);
    ASSERT_EQ(json["peers"].size(), 1u);
    for (const char* key : {"scene", "effect", "threads", "peer", "build_ms", "trace_ms", "ours_ms", "ratio"})
        EXPECT_TRUE(json["peers"][0].contains(key)) << key;
    EXPECT_EQ(json["peers"][0]["ratio"], 2.0);
}

TEST(BenchReport, CsvHasALineForEachRowAndAsManyFieldsAsItsHeading) {
    BenchReport report = made_up_report();
    report.rows.resize(1);
    report.rows[0].scene = "a,\"b\"";
    const std::string csv = bench_csv(report);
    EXPECT_EQ(count_of(csv, "\n"), 2u);
    EXPECT_EQ(csv.rfind("scene,effect,method,backend,ste,", 0), 0u);
    const std::string line = csv.substr(csv.find('\n') + 1);
    EXPECT_EQ(line.rfind("\"a,\"\"b\"\"\",still,auto,cpu,0.250000,", 0), 0u) << line;
    EXPECT_EQ(count_of(line, ","), count_of(csv.substr(0, csv.find('\n')), ",") + 1);
}

TEST(BenchReport, LatexEscapesNames) {
    const std::string latex = bench_latex(made_up_report());
    EXPECT_NE(latex.find("odd, \"name\" \\& <tag>\\_1"), std::string::npos) << latex;
    EXPECT_NE(latex.find("none & 25.0 / 4 & 25.0 / 4 \\\\"), std::string::npos) << latex;
    EXPECT_EQ(count_of(latex, "\\begin{tabular}"), count_of(latex, "\\end{tabular}"));
}

TEST(BenchReport, TheTableTellsEveryRow) {
    const std::string table = bench_table(made_up_report());
    EXPECT_EQ(count_of(table, "25.00%"), 6u) << table;
    EXPECT_EQ(count_of(table, "ratio 2.00"), 1u) << table;
}

TEST(BenchReport, ThePageNeedsNothingElseAndItsTagsAreBalanced) {
    const std::string page = bench_html(made_up_report());
    EXPECT_EQ(page.rfind("<!DOCTYPE html>", 0), 0u);
    EXPECT_EQ(page.find("http"), std::string::npos);
    EXPECT_EQ(page.find("<link"), std::string::npos);
    EXPECT_EQ(count_of(page, " src=\""), count_of(page, " src=\"data:image/png;base64,"));
    EXPECT_EQ(page.find("<tag>"), std::string::npos);
    EXPECT_EQ(page.find("<b>CPU"), std::string::npos);
    for (const char* tag :
         {"html", "head", "body", "main", "header", "nav",    "div",    "table",  "thead", "tbody",  "tr",   "th",
          "td",   "p",    "svg",  "g",    "text",   "figure", "button", "script", "style", "select", "label"}) {
        const std::string name = tag;
        EXPECT_EQ(count_of(page, "<" + name + ">") + count_of(page, "<" + name + " "),
                  count_of(page, "</" + name + ">"))
            << tag;
    }
    // A point for each time against a ray tracer, at the place of its ratio.
    EXPECT_EQ(count_of(page, "both: 10.0 + 20.0 ms over 15.0 ms"), 1u);
    EXPECT_NE(page.find("Embree's time over ours"), std::string::npos);
    // Every row stands in the table of all rows.
    EXPECT_EQ(count_of(page.substr(page.find("id=\"all\"")), "<tr>"), 7u);
}

TEST(BenchReport, PublishedFiguresAreThoseOfTheTables) {
    std::set<std::string> effects;
    for (const BenchEffect& effect : bench_effects()) effects.insert(effect.name);
    int with_ste = 0;
    for (const PublishedFigure& figure : published_figures()) {
        EXPECT_TRUE(effects.count(figure.effect)) << figure.effect;
        EXPECT_FALSE(published_difference(figure.our_scene).empty()) << figure.our_scene;
        EXPECT_TRUE(figure.ste > 0.0 || figure.milliseconds > 0.0);
        EXPECT_LT(figure.ste, 0.3);
        with_ste += figure.ste > 0.0;
        if (figure.paper == "Laine & Karras 2011" && figure.effect == "both-x2" &&
            figure.our_method == "improved-dual-space") {
            EXPECT_DOUBLE_EQ(figure.ste, 0.237);
        }
    }
    EXPECT_EQ(with_ste, 45);  // 8 rows of Wu's and 7 of Laine and Karras's, 3 methods each
}

TEST(BenchPixels, Base64IsThatOfRfc4648) {
    const auto encoded = [](const std::string& text) { return base64({text.begin(), text.end()}); };
    EXPECT_EQ(encoded(""), "");
    EXPECT_EQ(encoded("f"), "Zg==");
    EXPECT_EQ(encoded("fo"), "Zm8=");
    EXPECT_EQ(encoded("foo"), "Zm9v");
    EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(BenchPixels, PngHoldsTheVeryPixels) {
    Pixels pixels{3, 2, {}};
    for (int i = 0; i < 18; ++i) pixels.rgb.push_back(static_cast<std::uint8_t>(13 * i));
    const std::vector<std::uint8_t> file = encode_png(pixels);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&image, file.data(), file.size()));
    EXPECT_EQ(image.width, 3u);
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> back(PNG_IMAGE_SIZE(image));
    ASSERT_TRUE(png_image_finish_read(&image, nullptr, back.data(), 0, nullptr));
    EXPECT_EQ(back, pixels.rgb);
}

TEST(BenchPixels, HotterIsLighter) {
    Field field{200, 1, {}};
    for (int i = 0; i < 200; ++i)
        field.values.push_back(i == 0 ? 0.0f : std::pow(10.0f, -3.0f + 3.0f * static_cast<float>(i) / 199.0f));
    const Pixels pixels = heat_colours(field, 1.0f);
    double last = -1.0;
    for (int i = 0; i < 200; ++i) {
        const double light =
            0.2126 * pixels.rgb[3 * i] + 0.7152 * pixels.rgb[3 * i + 1] + 0.0722 * pixels.rgb[3 * i + 2];
        EXPECT_GE(light, last - 1.5) << i;  // colours are rounded to whole numbers
        last = std::max(last, light);
    }
    EXPECT_GT(last, 240.0);
}

TEST(BenchPlot, PutsPointsWhereTheAxesSayAndEscapesTips) {
    Plot plot;
    plot.title = "a < b";
    plot.x_ticks = {{0, "none"}, {1, "x1"}, {2, "x2"}};
    plot.y_low = 1, plot.y_high = 100;
    plot.series.push_back({3, {{0, 1, "low"}, {1, 10, "mid & more"}, {2, 100, "high"}}});
    const std::string text = svg(plot);
    EXPECT_NE(text.find("a &lt; b"), std::string::npos);
    EXPECT_NE(text.find("mid &amp; more"), std::string::npos);
    std::vector<double> xs, ys;
    for (std::size_t at = text.find("cx=\""); at != std::string::npos; at = text.find("cx=\"", at + 1)) {
        xs.push_back(std::stod(text.substr(at + 4)));
        ys.push_back(std::stod(text.substr(text.find("cy=\"", at) + 4)));
    }
    ASSERT_EQ(xs.size(), 3u);
    EXPECT_NEAR(xs[1] - xs[0], xs[2] - xs[1], 0.11);
    EXPECT_NEAR(ys[0] - ys[1], ys[1] - ys[2], 0.11);  // a decade is a decade
    EXPECT_GT(ys[0], ys[2]);
}

}  // namespace
}  // namespace pentaprism
