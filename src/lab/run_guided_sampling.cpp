// The experiment of include/pentaprism/experiment.h: pictures of each estimator, again and again, against the truth.

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <pentaprism/error.h>
#include <pentaprism/experiment.h>

#include "base/parallel.h"
#include "lab/guided_sampling.h"
#include "peer/posed_picture.h"
#include "sample/net.h"

namespace pentaprism {
namespace {

constexpr int kBlock = 4;         // pixels a side of what z is asked of
constexpr int kTruthRepeats = 4;  // times as many as of an estimator

// The part's own colour, told apart by a hash where materials are alike.
std::vector<glm::vec3> flat_colors(const Frame& frame) {
    std::vector<glm::vec3> of_part;
    for (std::size_t i = 0; i < frame.parts.size(); ++i) {
        const Index material = frame.parts[i].material;
        glm::vec3 color(0.8f);
        if (material != kNone) color = glm::vec3(frame.scene->materials[material].base_color);
        for (int c = 0; c < 3; ++c)
            color[c] *=
                0.3f + 0.7f * static_cast<float>(mix(static_cast<std::uint32_t>(3 * i) + c + 1u) >> 8) * 0x1p-24f;
        of_part.push_back(color);
    }
    std::vector<glm::vec3> colors;
    for (const std::uint32_t part : frame.part_of) colors.push_back(of_part[part]);
    return colors;
}

// Sums over repeats of pixels and of blocks of pixels; three channels each.
struct Sums {
    std::vector<double> pixel, pixel_squares, block, block_squares;
    std::int64_t tests = 0;
    int repeats = 0;
    Sums(std::size_t pixels, std::size_t blocks)
        : pixel(3 * pixels), pixel_squares(3 * pixels), block(3 * blocks), block_squares(3 * blocks) {}

    double mean(const std::vector<double>& sums, std::size_t i) const { return sums[i] / repeats; }
    /// Of the mean.
    double variance(const std::vector<double>& sums, const std::vector<double>& squares, std::size_t i) const {
        const double m = sums[i] / repeats;
        return std::max(0.0, squares[i] / repeats - m * m) / (repeats - 1);
    }
};

struct Size {
    int width, height;
    int columns() const { return (width + kBlock - 1) / kBlock; }
    int rows() const { return (height + kBlock - 1) / kBlock; }
    std::size_t pixels() const { return static_cast<std::size_t>(width) * height; }
    std::size_t blocks() const { return static_cast<std::size_t>(columns()) * rows(); }
};

// All repeats of one estimator over one cell of the picture. A cell is whole blocks, and belongs to one thread.
void sample_cell(const GuidedSampler& sampler, const GuidedSampler::Cell& cell, Guidance guidance, int samples,
                 int first_seed, int repeats, const Size& size, Sums& sums, std::atomic<std::int64_t>& tests) {
    std::vector<std::size_t> blocks;
    for (const GuidedPixel& pixel : cell.pixels)
        blocks.push_back(static_cast<std::size_t>(pixel.py / kBlock) * size.columns() + pixel.px / kBlock);
    std::vector<double> block_sums(3 * size.blocks());
    std::vector<int> block_pixels(size.blocks());
    for (const std::size_t b : blocks) ++block_pixels[b];
    std::int64_t here = 0;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        for (const std::size_t b : blocks) std::fill_n(&block_sums[3 * b], 3, 0.0);
        for (std::size_t i = 0; i < cell.pixels.size(); ++i) {
            const GuidedPixel& pixel = cell.pixels[i];
            const glm::dvec3 color = sampler.estimate(
                guidance, pixel, samples, 0x9e3779b9u * static_cast<std::uint32_t>(first_seed + repeat + 1), here);
            const std::size_t at = static_cast<std::size_t>(pixel.py) * size.width + pixel.px;
            for (int c = 0; c < 3; ++c) {
                sums.pixel[3 * at + c] += color[c];
                sums.pixel_squares[3 * at + c] += color[c] * color[c];
                block_sums[3 * blocks[i] + c] += color[c] / block_pixels[blocks[i]];
            }
        }
        std::vector<std::size_t> each = blocks;
        std::sort(each.begin(), each.end());
        each.erase(std::unique(each.begin(), each.end()), each.end());
        for (const std::size_t b : each)
            for (int c = 0; c < 3; ++c) {
                sums.block[3 * b + c] += block_sums[3 * b + c];
                sums.block_squares[3 * b + c] += block_sums[3 * b + c] * block_sums[3 * b + c];
            }
    }
    tests += here;
}

Picture to_picture(const Sums& sums, const Size& size) {
    Picture picture;
    picture.width = size.width;
    picture.height = size.height;
    for (std::size_t i = 0; i < size.pixels(); ++i) {
        for (int c = 0; c < 3; ++c) picture.rgba.push_back(static_cast<float>(sums.mean(sums.pixel, 3 * i + c)));
        picture.rgba.push_back(1.0f);
    }
    picture.z.assign(size.pixels(), 0.0f);
    return picture;
}

void compare(const Sums& sums, const Sums& truth, GuidedRow& row) {
    double z2 = 0.0, squares = 0.0, bias = 0.0;
    int asked = 0;
    for (std::size_t i = 0; i < sums.block.size(); ++i) {
        const double difference = sums.mean(sums.block, i) - truth.mean(truth.block, i);
        const double variance =
            sums.variance(sums.block, sums.block_squares, i) + truth.variance(truth.block, truth.block_squares, i);
        bias += difference * difference - variance;
        if (!(variance > 1e-16)) continue;  // one surface alone: every sample tells the same
        const double z = difference / std::sqrt(variance);
        z2 += z * z;
        ++asked;
        row.worst_z = std::max(row.worst_z, std::abs(z));
    }
    row.rms_z = asked > 0 ? std::sqrt(z2 / asked) : 0.0;
    row.bias = std::sqrt(std::max(0.0, bias / static_cast<double>(sums.block.size())));
    for (std::size_t i = 0; i < sums.pixel.size(); ++i) {
        const double m = truth.mean(truth.pixel, i);
        squares += sums.pixel_squares[i] / sums.repeats - 2.0 * m * sums.mean(sums.pixel, i) + m * m;
    }
    row.error = std::sqrt(std::max(0.0, squares / static_cast<double>(sums.pixel.size())));
}

struct Estimator {
    Guidance guidance;
    const char *name, *description;
};
constexpr Estimator kEstimators[] = {
    {Guidance::kUnguided, "unguided", "one set of samples, each tested against every triangle of the pixel"},
    {Guidance::kEnumerated, "enumerated", "the same samples, tested only against triangles whose bounds hold them"},
    {Guidance::kPrivate, "private", "samples inside each triangle's own bounds, compared by a z-buffer"},
    {Guidance::kStrata, "strata", "one set of samples, denser where more bounds overlap, weighted"},
    {Guidance::kTraced, "traced", "samples inside each triangle's own bounds, each with its true visibility"}};

void check(const GuidedPlan& plan) {
    if (plan.settings.image.spp < kGuideCells)
        throw Error(ErrorKind::kUsage, "--spp: this experiment takes 32 samples per pixel or more");
    if (plan.repeats < 2) throw Error(ErrorKind::kUsage, "--repeats: 2 or more are needed to see noise");
}

void put(Picture& to, const Picture& from, int x0, int y0, int zoom, float scale, float shift) {
    for (int y = 0; y < from.height * zoom; ++y)
        for (int x = 0; x < from.width * zoom; ++x)
            for (int c = 0; c < 3; ++c)
                to.rgba[4 * (static_cast<std::size_t>(y0 + y) * to.width + x0 + x) + c] =
                    from.rgba[4 * (static_cast<std::size_t>(y / zoom) * from.width + x / zoom) + c] * scale + shift;
}

Picture difference(const Picture& a, const Picture& b) {
    Picture d = a;
    for (std::size_t i = 0; i < d.rgba.size(); ++i) d.rgba[i] = a.rgba[i] - b.rgba[i];
    return d;
}

}  // namespace

GuidedReport run_guided_sampling(const Scene& scene, const GuidedPlan& plan, const Progress& progress) {
    validate(plan.settings);
    check(plan);
    set_thread_count(plan.settings.method.threads);
    const PosedPicture picture = pose_picture(scene, plan.settings, plan.frame);
    const Frame& frame = picture.frame;
    const Size size{frame.view.width, frame.view.height};
    const GuidedSampler sampler(frame, flat_colors(frame), scene.background.value_or(glm::vec3(0.0f)));

    Sums truth(size.pixels(), size.blocks());
    truth.repeats = kTruthRepeats * plan.repeats;
    std::vector<Sums> sums(std::size(kEstimators), Sums(size.pixels(), size.blocks()));
    std::vector<std::atomic<std::int64_t>> tests(std::size(kEstimators));
    const int columns = (size.width + kCellSize - 1) / kCellSize, rows = (size.height + kCellSize - 1) / kCellSize;
    const std::size_t cells = static_cast<std::size_t>(columns) * rows;
    std::atomic<std::size_t> done{0};
    std::mutex mutex;
    parallel_for(cells, [&](std::size_t i) {
        const GuidedSampler::Cell cell = sampler.bound(static_cast<int>(i) % columns, static_cast<int>(i) / columns);
        const int samples = plan.settings.image.spp,
                  seed = static_cast<int>(plan.settings.method.seed % 1000u) * 1000000;
        std::atomic<std::int64_t> of_truth{0};
        // The truth is found with the bounds, too: that they lose nothing is what the first two rows show.
        sample_cell(sampler, cell, Guidance::kEnumerated, samples, seed + 500000, truth.repeats, size, truth, of_truth);
        for (std::size_t e = 0; e < std::size(kEstimators); ++e) {
            // "enumerated" has the samples of "unguided".
            const int first = seed + (e == 1 ? 0 : static_cast<int>(e)) * 10000;
            sample_cell(sampler, cell, kEstimators[e].guidance, samples, first, plan.repeats, size, sums[e], tests[e]);
        }
        const std::size_t now = ++done;
        const std::unique_lock<std::mutex> lock(mutex, std::try_to_lock);
        if (progress && lock && !progress(static_cast<double>(now) / static_cast<double>(cells)))
            throw Error(ErrorKind::kRender, "interrupted");
    });

    GuidedReport report;
    report.width = size.width;
    report.height = size.height;
    report.blocks = static_cast<int>(size.blocks());
    report.truth = to_picture(truth, size);
    for (std::size_t e = 0; e < std::size(kEstimators); ++e) {
        GuidedRow row;
        row.name = kEstimators[e].name;
        row.description = kEstimators[e].description;
        sums[e].repeats = plan.repeats;
        row.tests_per_pixel = static_cast<double>(tests[e]) / plan.repeats / static_cast<double>(size.pixels());
        compare(sums[e], truth, row);
        row.mean = to_picture(sums[e], size);
        report.rows.push_back(std::move(row));
    }
    return report;
}

Picture guided_picture(const GuidedReport& report, int zoom) {
    constexpr int kGap = 4;
    constexpr float kEnlarged = 8.0f;
    const int w = report.width * zoom + kGap, h = report.height * zoom + kGap;
    Picture picture;
    picture.width = 4 * w - kGap;
    picture.height = 2 * h - kGap;
    picture.rgba.assign(4 * static_cast<std::size_t>(picture.width) * picture.height, 1.0f);
    picture.z.assign(static_cast<std::size_t>(picture.width) * picture.height, 0.0f);
    put(picture, report.truth, 0, 0, zoom, 1.0f, 0.0f);
    put(picture, report.truth, 0, h, zoom, 0.0f, 0.5f);
    int column = 1;
    for (const GuidedRow& row : report.rows) {
        if (row.name != "private" && row.name != "strata" && row.name != "traced") continue;
        put(picture, row.mean, column * w, 0, zoom, 1.0f, 0.0f);
        put(picture, difference(row.mean, report.truth), column * w, h, zoom, kEnlarged, 0.5f);
        ++column;
    }
    picture.info.width = picture.info.x1 = picture.width;
    picture.info.height = picture.info.y1 = picture.height;
    return picture;
}

}  // namespace pentaprism
