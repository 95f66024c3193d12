#include "lab/plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pentaprism {
namespace {

constexpr double kWidth = 340, kHeight = 290, kLeft = 52, kRight = 14, kTop = 28, kBottom = 40;

class Canvas {
  public:
    explicit Canvas(const Plot& plot) : plot_(plot) {
        x0_ = x1_ = plot.x_ticks.empty() ? 0.0 : plot.x_ticks.front().at;
        for (const PlotTick& tick : plot.x_ticks) x0_ = std::min(x0_, tick.at), x1_ = std::max(x1_, tick.at);
        if (x1_ <= x0_) x1_ = x0_ + 1.0;
        y0_ = std::log10(plot.y_low);
        y1_ = std::max(std::log10(plot.y_high), y0_ + 0.1);
    }
    double x(double value) const { return kLeft + (value - x0_) / (x1_ - x0_) * (kWidth - kLeft - kRight); }
    double y(double value) const {
        const double part = (std::log10(std::max(value, 1e-12)) - y0_) / (y1_ - y0_);
        return kHeight - kBottom - std::clamp(part, 0.0, 1.0) * (kHeight - kTop - kBottom);
    }

    // 1, 3, 10, 30, ... or, over many decades, powers of ten alone.
    std::vector<double> y_ticks() const {
        std::vector<double> ticks;
        const bool thirds = y1_ - y0_ < 3.2;
        for (int decade = static_cast<int>(std::floor(y0_)); decade <= static_cast<int>(std::ceil(y1_)); ++decade)
            for (const double step : {1.0, 3.0}) {
                const double value = step * std::pow(10.0, decade);
                if (step > 1.0 && !thirds) continue;
                if (value >= plot_.y_low * 0.999 && value <= plot_.y_high * 1.001) ticks.push_back(value);
            }
        return ticks;
    }

  private:
    const Plot& plot_;
    double x0_, x1_, y0_, y1_;
};

std::string text_at(double x, double y, const char* kind, const std::string& text) {
    return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"{}\">{}</text>", x, y, kind, escape_html(text));
}

std::string tick_label(double value) {
    return value >= 1e6   ? fmt::format("{:g}M", value / 1e6)
           : value >= 1e4 ? fmt::format("{:g}k", value / 1e3)
                          : fmt::format("{:g}", value);
}

std::string axes(const Plot& plot, const Canvas& canvas) {
    std::string out;
    for (const double value : canvas.y_ticks()) {
        const double y = canvas.y(value);
        out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", kLeft, y, kWidth - kRight);
        out += text_at(kLeft - 6, y + 3.5, "tick end", tick_label(value) + plot.y_unit);
    }
    for (const PlotTick& tick : plot.x_ticks) {
        out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", canvas.x(tick.at), kTop,
                           kHeight - kBottom);
        const bool last = &tick == &plot.x_ticks.back();  // a label in the middle would be cut off
        out += text_at(canvas.x(tick.at) + (last ? kRight - 2 : 0), kHeight - kBottom + 16,
                       last ? "tick end" : "tick mid", tick.label);
    }
    out += text_at(0.5 * (kLeft + kWidth - kRight), kHeight - 6, "tick mid", plot.x_title);
    out += text_at(kLeft, 16, "head", plot.title);
    out += text_at(kWidth - kRight, 16, "tick end", plot.y_title);
    return out;
}

std::string line(const PlotSeries& series, const Canvas& canvas) {
    std::string path;
    for (const PlotPoint& point : series.points)
        path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", canvas.x(point.x), canvas.y(point.y));
    std::string out =
        fmt::format("<g class=\"series s{}\" data-m=\"{}\"><path d=\"{}\"/>", series.style, series.style, path);
    for (const PlotPoint& point : series.points)
        out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\"><title>{}</title></circle>", canvas.x(point.x),
                           canvas.y(point.y), escape_html(point.tip));
    return out + "</g>";
}

}  // namespace

std::string escape_html(const std::string& text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

std::string svg(const Plot& plot) {
    const Canvas canvas(plot);
    std::string out = fmt::format("<svg viewBox=\"0 0 {:g} {:g}\" role=\"img\" aria-label=\"{}\">", kWidth, kHeight,
                                  escape_html(plot.title + ", " + plot.y_title));
    out += axes(plot, canvas);
    for (const PlotSeries& series : plot.series)
        if (!series.points.empty()) out += line(series, canvas);
    return out + "</svg>\n";
}

}  // namespace pentaprism
