#pragma once
// Line plots as inline SVG: colours come from the page's style sheet, so that a plot follows light and dark.

#include <string>
#include <vector>

namespace pentaprism {

struct PlotPoint {
    double x = 0.0, y = 0.0;
    std::string tip;  ///< shown when the pointer rests on it
};

struct PlotSeries {
    int style = 0;  ///< which of the page's series colours; the class is `sN`
    std::vector<PlotPoint> points;
};

struct PlotTick {
    double at = 0.0;
    std::string label;
};

/// Axes are linear in x and logarithmic in y.
struct Plot {
    std::string title, x_title, y_title;
    std::vector<PlotTick> x_ticks;
    double y_low = 1.0, y_high = 10.0;  ///< above 0
    std::string y_unit;                 ///< after the numbers of the ticks
    std::vector<PlotSeries> series;
};

/// `<svg>` with a title for readers who cannot see it.
std::string svg(const Plot& plot);

/// Text for HTML and SVG, attributes included.
std::string escape_html(const std::string& text);

}  // namespace pentaprism
