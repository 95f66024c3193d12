// The figures of docs/learn/culling: which part of a plane through the five dimensions a culling test keeps, and which
// part really hits. Both are asked of the renderer's own code, place by place. Writes NAME.svg into the folder given.

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "bound/screen_bounds.h"
#include "cover/exact.h"
#include "cull/cull_choice.h"

namespace pentaprism {
namespace {

// The plane that is drawn: u and t, u and v, or x and y; of what is not drawn, all values count.
enum class Axes { kUT, kUV, kXY };

// A triangle in a picture of one cell. Corners in pixels from its middle, with the depth w and the circle of confusion
// as a radius in pixels, at both ends of the shutter.
struct Corner {
    double x, y, w, blur;
};
using Corners = std::array<std::array<Corner, 3>, 2>;

struct Example {
    Corners corners;
    bool two_sided = true;
    double near = 0.1;
};

struct Figure {
    const char* name;
    const char* culling;
    Example example;
    Axes axes;
    int x, y, size;          // the footprint: pixels from the cell's top left corner
    bool one_place = false;  // UT and UV: only the footprint's middle, not all of it
    int parts = 0;           // ask about domains of 1/parts of lens and shutter instead of samples
    double fixed = 0;        // UT: v; UV: t
    bool in_box = true;      // XY: within the screen box, as the renderer asks
};

Frame make_frame(const Example& example) {
    Frame frame;
    frame.view.width = frame.view.height = kCellSize;
    frame.view.depth_near = example.near;
    Part part;
    part.triangle_count = 1;
    part.vertex_count = 3;
    part.moves = true;
    part.two_sided = example.two_sided;
    frame.parts.push_back(part);
    for (const auto& end : example.corners)
        for (const Corner& c : end)
            frame.points.emplace_back(static_cast<float>(c.x * c.w), static_cast<float>(c.y * c.w),
                                      static_cast<float>(c.w), static_cast<float>(c.blur * c.w));
    frame.corners = {0, 1, 2};
    frame.part_of = {0};
    return frame;
}

enum class Mark : char { kRefused, kKept, kHit, kLost };

// Asks everything about one figure.
class Plane {
  public:
    explicit Plane(const Figure& figure)
        : figure_(figure),
          frame_(make_frame(figure.example)),
          centre_(cell_centre(frame_.view, 0, 0)),
          triangle_(localize(frame_, 0, 0, centre_)),
          steps_(parse_culling(figure.culling)),
          setups_(steps_.size()),
          states_(steps_.size()) {
        for (std::size_t i = 0; i < steps_.size(); ++i) {
            states_[i].setup = &setups_[i];
            if (steps_[i].test->begin != nullptr &&
                !steps_[i].test->begin(triangle_, square(0, 0, kCellSize), setups_[i]))
                begun_ = false;
        }
        box_ = covered_pixels(screen_bounds(moving_triangle(frame_, 0, 0), frame_.view.w_near(), 1), kCellSize,
                              kCellSize, {0, kCellSize, 0, kCellSize});
        prepared_ = figure.axes != Axes::kXY && prepare(square(figure.x, figure.y, figure.size));
    }

    // a, b in [0, 1]: along the two axes, b upwards.
    Mark at(double a, double b) {
        bool hit = false, kept = false;
        if (figure_.axes == Axes::kXY) {
            const float x = static_cast<float>(a * kCellSize) - 16, y = static_cast<float>(b * kCellSize) - 16;
            const int px = static_cast<int>(a * kCellSize), py = static_cast<int>((1 - b) * kCellSize);
            kept = !figure_.in_box || (px >= box_.x0 && px < box_.x1 && py >= box_.y0 && py < box_.y1);
            kept = kept && prepare(square(px, py, 1));
            constexpr int n = 12;
            for (int i = 0; i < n * n * n && !hit; ++i) {
                const double u = 2.0 * (i % n) / (n - 1) - 1, v = 2.0 * (i / n % n) / (n - 1) - 1;
                if (u * u + v * v > 1) continue;
                hit = hits({x, y, static_cast<float>(u), static_cast<float>(v), time(double(i / n / n) / n)});
            }
        } else {
            const int n = figure_.one_place ? 1 : 9;
            const bool ut = figure_.axes == Axes::kUT;
            const double u = 2 * a - 1, v = ut ? figure_.fixed : 2 * b - 1, t = ut ? b : figure_.fixed;
            if (!ut && u * u + v * v > 1) return Mark::kRefused;
            for (int i = 0; i < n * n; ++i) {
                const double fx = n == 1 ? 0.5 : (i % n + 0.5) / n, fy = n == 1 ? 0.5 : (i / n + 0.5) / n;
                const LocalSample s{static_cast<float>(figure_.x + fx * figure_.size - 16),
                                    static_cast<float>(16 - figure_.y - fy * figure_.size), static_cast<float>(u),
                                    static_cast<float>(v), time(t)};
                hit = hit || hits(s);
                kept = kept || (figure_.parts > 0 ? keeps_part(u, t) : prepared_ && keeps(s));
            }
        }
        return hit ? kept ? Mark::kHit : Mark::kLost : kept ? Mark::kKept : Mark::kRefused;
    }

  private:
    static float time(double t) { return static_cast<float>(std::floor(std::min(t, 1 - 0x1p-24) * 0x1p24) * 0x1p-24); }

    static Footprint square(int x, int y, int size) {
        const float left = static_cast<float>(x - 16), top = static_cast<float>(16 - y),
                    side = static_cast<float>(size);
        return {left, left + side, top - side, top, {-1, 1, -1, 1, 0, 1}};
    }
    bool prepare(const Footprint& footprint) {
        if (!begun_) return false;
        for (std::size_t i = 0; i < steps_.size(); ++i)
            if (!steps_[i].test->prepare(triangle_, footprint, states_[i])) return false;
        return true;
    }
    bool keeps(const LocalSample& sample) const {
        for (std::size_t i = 0; i < steps_.size(); ++i)
            if (!steps_[i].test->keeps(states_[i], sample)) return false;
        return true;
    }
    bool keeps_part(double u, double t) {
        const double n = figure_.parts, u0 = std::floor((u + 1) / 2 * n) / n * 2 - 1, t0 = std::floor(t * n) / n;
        Footprint f = square(figure_.x, figure_.y, figure_.size);
        f.domain = {static_cast<float>(u0),
                    static_cast<float>(u0 + 2 / n),
                    static_cast<float>(figure_.fixed),
                    static_cast<float>(figure_.fixed),
                    static_cast<float>(t0),
                    static_cast<float>(t0 + 1 / n)};
        return prepare(f);
    }
    bool hits(const LocalSample& sample) const { return cover_sample(triangle_, sample, centre_).hit; }

    const Figure& figure_;
    Frame frame_;
    CellCentre centre_;
    LocalTriangle triangle_;
    Culling steps_;
    std::vector<CullSetup> setups_;
    std::vector<CullState> states_;
    PixelRect box_;
    bool begun_ = true, prepared_ = false;
};

constexpr int kCells = 128, kScale = 3, kMargin = 34;

// All places with that mark as one path, row by row.
std::string path_of(const std::vector<Mark>& marks, Mark mark) {
    std::ostringstream path;
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells;) {
            int end = x;
            while (end < kCells && marks[y * kCells + end] == mark) ++end;
            if (end > x) path << 'M' << x << ' ' << y << 'h' << end - x << "v1h-" << end - x << 'z';
            x = std::max(end, x + 1);
        }
    return path.str();
}

void text(std::ostream& out, double x, double y, const std::string& words, const char* anchor = "middle") {
    out << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">" << words << "</text>\n";
}

void draw(const Figure& figure, const std::string& folder) {
    Plane plane(figure);
    std::vector<Mark> marks(kCells * kCells);
    std::array<int, 4> count{};
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) {
            marks[y * kCells + x] = plane.at((x + 0.5) / kCells, 1 - (y + 0.5) / kCells);
            ++count[static_cast<int>(marks[y * kCells + x])];
        }
    const int side = kCells * kScale;
    std::ofstream out(folder + "/" + figure.name + ".svg");
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << side + 2 * kMargin << " " << side + 2 * kMargin
        << "\" width=\"" << side + 2 * kMargin << "\" font-family=\"sans-serif\" font-size=\"15\" fill=\"#333\">\n"
        << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n<g transform=\"translate(" << kMargin << " "
        << kMargin << ") scale(" << kScale << ")\" shape-rendering=\"crispEdges\">\n<rect width=\"" << kCells
        << "\" height=\"" << kCells << "\" fill=\"#eceff3\"/>\n";
    constexpr const char* kColours[] = {"", "#f2c14e", "#2f9e63", "#d1344b"};
    for (const Mark mark : {Mark::kKept, Mark::kHit, Mark::kLost}) {
        const std::string path = path_of(marks, mark);
        if (!path.empty()) out << "<path fill=\"" << kColours[static_cast<int>(mark)] << "\" d=\"" << path << "\"/>\n";
    }
    out << "</g>\n";
    const bool xy = figure.axes == Axes::kXY;
    text(out, side / 2.0 + kMargin, side + kMargin + 24, xy ? "x, pixels" : "u");
    text(out, kMargin, side + kMargin + 22, xy ? "0" : "-1", "start");
    text(out, side + kMargin, side + kMargin + 22, xy ? "32" : "1", "end");
    text(out, kMargin - 18, side / 2.0 + kMargin, xy ? "y" : figure.axes == Axes::kUT ? "t" : "v");
    text(out, kMargin - 6, side + kMargin, xy || figure.axes == Axes::kUT ? "0" : "-1", "end");
    text(out, kMargin - 6, kMargin + 12.0, xy ? "32" : "1", "end");
    text(out, side / 2.0 + kMargin, 22, figure.culling);
    out << "</svg>\n";
    std::cout << figure.name << ": hit " << count[2] << ", kept in vain " << count[1] << ", lost " << count[3] << " of "
              << kCells * kCells << "\n";
}

// A triangle of 6 pixels that moves right by 18 pixels, comes nearer and is out of focus.
const Example kBoth{{{{{{-12, -3, 4, 4.5}, {-6, -4, 4.4, 5.2}, {-9, 3, 3.8, 4}}},
                      {{{6, -3, 3.4, 3}, {12, -4, 3.6, 3.6}, {9, 3, 3.2, 2.6}}}}}};
// One that moves across aslant, with little blur of the lens.
const Example kAslant{{{{{{-13, -11, 4, 1.2}, {-7, -12, 4.4, 1.6}, {-10, -5, 3.8, 1}}},
                        {{{6, 5, 3.4, 0.8}, {12, 4, 3.6, 1}, {9, 12, 3.2, 0.6}}}}}};
// One of 20 pixels.
const Example kLarge{{{{{{-18, -10, 4, 3}, {2, -12, 4.4, 3.6}, {-9, 12, 3.8, 2.8}}},
                       {{{-8, -9, 3.4, 2.4}, {12, -12, 3.8, 3}, {3, 12, 3.2, 2.2}}}}}};
// One that stands still, out of focus.
const Example kStill{{{{{{-12, -9, 4, 8}, {6, -8, 4.4, 9}, {-9, 10, 3.8, 7.5}}},
                       {{{-12, -9, 4, 8}, {6, -8, 4.4, 9}, {-9, 10, 3.8, 7.5}}}}}};
// One that stands still and leans through the plane of focus.
const Example kThroughFocus{
    {{{{{-6, -6, 4, -6}, {5, -5, 6, 6}, {2, 7, 5.5, 5}}}, {{{-6, -6, 4, -6}, {5, -5, 6, 6}, {2, 7, 5.5, 5}}}}}};
// One that grows: its corners leave the middle in different directions.
const Example kGrowing{
    {{{{{-4, -3, 5, 2}, {4, -3, 5, 2}, {0, 4, 5, 2}}}, {{{-14, -10, 5, 2}, {14, -10, 5, 2}, {0, 14, 5, 2}}}}}};
// One that comes past the camera.
const Example kPast{
    {{{{{-6, -4, 3, 2}, {2, -6, 3, 2}, {-2, 4, 4, 2.5}}}, {{{-4, -6, 0.5, 3}, {3, 9, -0.6, 3}, {0, 10, 1.2, 2}}}}},
    true,
    0.4};
// One that is seen nearly along its plane, and turns.
const Example kTurning{
    {{{{{-2.5, -8, 4, 6}, {2.5, -8, 4.5, 1}, {0, 9, 5, 3}}}, {{{2.5, -8, 5, 5}, {-2.5, -7, 4.5, 0.5}, {0, 9, 4, 3}}}}},
    false};

const Figure kFigures[] = {
    {"bbox", "bbox", kAslant, Axes::kXY, 0, 0, 1},
    {"hull", "hull", kAslant, Axes::kXY, 0, 0, 1},
    {"gamma-ranges", "gamma-ranges", kPast, Axes::kXY, 0, 0, 1, false, 0, 0, false},
    {"bbox-past-camera", "bbox", kPast, Axes::kXY, 0, 0, 1},
    {"dual-space", "dual-space@pixel", kBoth, Axes::kUT, 16, 15, 1},
    {"improved-dual-space", "improved-dual-space@pixel", kBoth, Axes::kUT, 16, 15, 1},
    {"improved-dual-space-tile", "improved-dual-space@tile", kBoth, Axes::kUT, 16, 8, 8},
    {"improved-dual-space-as-printed", "improved-dual-space-as-printed@tile", kBoth, Axes::kUT, 16, 8, 8},
    {"clip-space", "clip-space@pixel", kThroughFocus, Axes::kUV, 16, 15, 1, false, 0, 0.5},
    {"clip-space-as-printed", "clip-space-as-printed@pixel", kThroughFocus, Axes::kUV, 16, 15, 1, false, 0, 0.5},
    {"clip-space-growing", "clip-space@pixel", kGrowing, Axes::kUT, 7, 23, 1},
    {"clip-space-as-printed-growing", "clip-space-as-printed@pixel", kGrowing, Axes::kUT, 7, 23, 1},
    {"clip-space-affine", "clip-space-affine@pixel", kBoth, Axes::kUT, 16, 15, 1},
    {"ut-vt-lines", "ut-vt-lines@tile", kBoth, Axes::kUT, 16, 8, 8},
    {"hyperplane", "hyperplane@tile", kLarge, Axes::kUT, 16, 8, 8, true},
    {"hyperplane-slices", "improved-dual-space@tile", kLarge, Axes::kUT, 16, 8, 8, true},
    {"half-space", "half-space@tile", kStill, Axes::kUV, 8, 8, 8, false, 0, 0.5},
    {"half-space-bilinear", "improved-dual-space@tile", kStill, Axes::kUV, 8, 8, 8, false, 0, 0.5},
    {"hierarchical", "hierarchical@pixel", kBoth, Axes::kUT, 16, 15, 1},
    {"interval", "interval@pixel", kBoth, Axes::kUT, 16, 15, 1},
    {"interval-fine", "interval-fine@pixel", kBoth, Axes::kUT, 16, 15, 1},
    {"facing", "facing", kTurning, Axes::kUT, 15, 16, 1, false, 16},
};

}  // namespace
}  // namespace pentaprism

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: draw_figures FOLDER\n";
        return 2;
    }
    for (const auto& figure : pentaprism::kFigures) pentaprism::draw(figure, argv[1]);
    return 0;
}
