// One page that holds everything: plots as SVG, pictures as data, style and script inline.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>
#include <pentaprism/bench.h>

#include "lab/effects.h"
#include "lab/pixels.h"
#include "lab/plot.h"
#include "lab/report_style.h"

namespace pentaprism {
namespace {

constexpr const char* kProject = "Pentaprism";

std::string short_name(const std::string& scene) {
    const std::string prefix = "builtin:";
    return scene.rfind(prefix, 0) == 0 ? scene.substr(prefix.size()) : scene;
}

std::string percent(double ste) {
    if (ste == 0.0) return "\u2013";  // nothing was tested, as by a ray tracer
    const double value = 100.0 * ste;
    return fmt::format("{:.{}f}", value, value < 1.0 ? 2 : 1);
}
std::string milliseconds(double ms) {
    return fmt::format("{:.{}f}", ms, ms < 10.0 ? 2 : ms < 100.0 ? 1 : 0);
}

// 12345678 -> 12 345 678 with thin spaces.
std::string grouped(std::int64_t number) {
    std::string digits = std::to_string(number), result;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) result += "&#8239;";
        result += digits[i];
    }
    return result;
}

// What the rows hold, by name, in the order of the plan.
class Lookup {
  public:
    explicit Lookup(const BenchReport& report) : report_(report) {
        for (const BenchRow& row : report.rows) {
            add(methods, row.method);
            add(effects, row.effect);
            rows_[{row.scene, row.effect, row.method}] = &row;
        }
    }
    const BenchRow* row(const std::string& scene, const std::string& effect, const std::string& method) const {
        const auto found = rows_.find({scene, effect, method});
        return found == rows_.end() ? nullptr : found->second;
    }
    const BenchCell* cell(const std::string& scene, const std::string& effect) const {
        for (const BenchCell& cell : report_.cells)
            if (cell.scene == scene && cell.effect == effect) return &cell;
        return nullptr;
    }
    /// The colour of a method; 0, the ink, is kept for `auto`.
    int style(const std::string& method) const {
        const auto place = std::find(methods.begin(), methods.end(), method) - methods.begin();
        const bool has_auto = std::find(methods.begin(), methods.end(), "auto") != methods.end();
        return static_cast<int>(place) + (has_auto ? 0 : 1);
    }

    std::vector<std::string> methods, effects;

  private:
    static void add(std::vector<std::string>& names, const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    const BenchReport& report_;
    std::map<std::array<std::string, 3>, const BenchRow*> rows_;
};

std::string method_label(const Lookup& lookup, const std::string& method) {
    const int style = lookup.style(method);
    return fmt::format(
        "<button data-light=\"{}\" title=\"show it alone in the plots\"><span class=\"swatch s{}\"></span>{}</button>",
        style, style, escape_html(method));
}

std::string image_tag(const BenchImage& image, const std::string& alt) {
    return fmt::format("<img width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">", image.width,
                       image.height, escape_html(alt), base64(image.png));
}

// ---- head of the page ----

std::string card(const std::string& number, const std::string& text) {
    return fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", number, text);
}

std::string cards(const BenchReport& report, const Lookup& lookup) {
    std::int64_t lost = 0, flawed = 0;
    double worst = 1.0, best = 1.0, least_auto = 0.0;
    for (const BenchRow& row : report.rows)
        if (!row.own_arithmetic) (row.conservative ? lost : flawed) += row.false_culls;
    for (const BenchRow& row : report.rows) {
        if (row.method != "auto") continue;
        const BenchRow* none = lookup.row(row.scene, row.effect, "none");
        if (none == nullptr) continue;
        const double factor = none->frame_ms / std::max(1e-6, row.frame_ms);
        least_auto = least_auto == 0.0 ? factor : std::min(least_auto, factor);
        best = std::max(best, factor);
    }
    for (const BenchRow& row : report.rows)
        if (row.method == "none") worst = std::min(worst, row.ste());
    std::string out = "<div class=\"cards\">\n";
    out += card(grouped(lost), "samples lost by all tests that promise to lose none");
    if (flawed > 0) out += card(grouped(flawed), "samples lost by tests as their papers print them");
    if (worst < 1.0) out += card(percent(worst) + " %", "lowest STE of the bounding box alone");
    if (best > 1.0)
        out += card(fmt::format("{:.1f} to {:.0f} times", least_auto, best),
                    "as fast as the bounding box alone, in scalar code: <i>auto</i>");
    out += card(std::to_string(report.rows.size()), fmt::format("measurements in {:.0f} s", report.seconds));
    return out + "</div>\n";
}

std::string head(const BenchReport& report, const Lookup& lookup) {
    const BenchMachine& m = report.machine;
    std::string out = fmt::format(
        "<header><h1>Culling tests for stochastic rasterization, measured</h1>\n"
        "<p>Motion blur and defocus blur by 5D samples: every sample has a place in the pixel (x, y), on the lens (u, "
        "v) and in time t. A "
        "culling test keeps samples away from the exact test without losing one that it would accept. <b>Sample test "
        "efficiency</b> (STE) is "
        "the part of the exact tests that hit: covered over tested.</p>\n"
        "<p class=\"soft\">{}x{} pixels, {} samples per pixel, seed {}. {} ({}), {} of {} processors, {:.0f} GB; {}; "
        "{}.</p>\n",
        report.width, report.height, report.spp, report.seed, escape_html(m.cpu), m.isa, m.threads, m.processors,
        m.memory_gb, escape_html(m.compiler), escape_html(m.system));
    out += cards(report, lookup) + "</header>\n<nav><div>";
    for (const BenchScene& scene : report.scenes)
        out += fmt::format("<a href=\"#{0}\">{0}</a>", escape_html(short_name(scene.name)));
    out += "<a href=\"#published\">as published</a>";
    if (!report.peers.empty()) out += "<a href=\"#peers\">ray tracer</a>";
    return out + "<a href=\"#rows\">all rows</a><a href=\"#method\">how it was measured</a></div></nav>\n";
}

// ---- a scene ----

std::string motion_pixels(const BenchCell& cell) {
    return fmt::format("{:.1f} px", cell.motion_px);
}
std::string blur_pixels(const BenchCell& cell) {
    return fmt::format("{:.1f} px", cell.blur_px);
}
std::string both_pixels(const BenchCell& cell) {
    return fmt::format("{:.1f}, {:.1f} px", cell.motion_px, cell.blur_px);
}

// One way from no blur to much.
struct Path {
    const char *title, *x_title, *kind;
    std::string (*pixels)(const BenchCell&);
};
constexpr Path kPaths[] = {{"Motion blur", "motion over the open shutter, in the mean", "motion", motion_pixels},
                           {"Defocus blur", "radius of the circle of confusion, in the mean", "defocus", blur_pixels},
                           {"Both", "motion, radius", "both", both_pixels}};

// The effects of a path that were measured, by their factor.
std::vector<std::pair<double, std::string>> effects_of(const Path& path, const Lookup& lookup) {
    std::vector<std::pair<double, std::string>> effects;
    for (const std::string& name : lookup.effects)
        if (name == "still" || name == path.kind || name.rfind(path.kind + std::string("-x"), 0) == 0) {
            const BenchEffect effect = find_effect(name);
            effects.emplace_back(std::max(effect.motion, effect.defocus), name);
        }
    std::sort(effects.begin(), effects.end());
    return effects;
}

// From the decade below the least to the decade above the largest, in steps of 1 and 3.
void fit(Plot& plot, double least, double largest) {
    const auto down = [](double v) {
        const double decade = std::pow(10.0, std::floor(std::log10(v)));
        return v >= 3.0 * decade ? 3.0 * decade : decade;
    };
    const auto up = [](double v) {
        const double decade = std::pow(10.0, std::floor(std::log10(v)));
        return v <= decade ? decade : v <= 3.0 * decade ? 3.0 * decade : 10.0 * decade;
    };
    plot.y_low = down(least);
    plot.y_high = up(largest);
}

template <class Value>
std::string plots(const BenchScene& scene, const Lookup& lookup, const std::string& y_title, const std::string& unit,
                  Value value) {
    double least = 1e300, largest = 0.0;
    for (const std::string& effect : lookup.effects)
        for (const std::string& method : lookup.methods)
            if (const BenchRow* row = lookup.row(scene.name, effect, method); row && value(*row) > 0.0) {
                least = std::min(least, value(*row));
                largest = std::max(largest, value(*row));
            }
    if (largest == 0.0) return "";
    std::string out = "<div class=\"panels\">\n";
    for (const Path& path : kPaths) {
        const auto effects = effects_of(path, lookup);
        Plot plot;
        plot.title = path.title;
        plot.y_title = y_title;
        plot.y_unit = unit;
        plot.x_title = path.x_title;
        for (std::size_t i = 0; i < effects.size(); ++i) {
            const BenchCell* cell = lookup.cell(scene.name, effects[i].second);
            const std::string label = effects[i].first == 0.0 ? "none" : fmt::format("x{:g}", effects[i].first);
            // Pixels are told where there is room for them.
            const bool room = cell != nullptr && effects[i].first > 0.0 && effects.size() < 4;
            plot.x_ticks.push_back({static_cast<double>(i), label + (room ? ": " + path.pixels(*cell) : "")});
        }
        fit(plot, least, largest);
        int measured = 0;
        for (const std::string& method : lookup.methods) {
            PlotSeries series{lookup.style(method), {}};
            for (std::size_t i = 0; i < effects.size(); ++i)
                if (const BenchRow* row = lookup.row(scene.name, effects[i].second, method); row && value(*row) > 0.0)
                    series.points.push_back({static_cast<double>(i), value(*row),
                                             fmt::format("{}, {}: STE {} %, {} ms", method, effects[i].second,
                                                         percent(row->ste()), milliseconds(row->frame_ms))});
            measured = std::max(measured, static_cast<int>(series.points.size()));
            plot.series.push_back(std::move(series));
        }
        if (measured > 1) out += "<div class=\"panel\">" + svg(plot) + "</div>\n";
    }
    return out + "</div>\n";
}

// One column of a matrix: the best of the conservative methods stands out.
template <class Value>
const BenchRow* best_of(const BenchScene& scene, const std::string& effect, const Lookup& lookup, Value better) {
    const BenchRow* best = nullptr;
    for (const std::string& method : lookup.methods) {
        const BenchRow* row = lookup.row(scene.name, effect, method);
        const bool fair = row && row->conservative && !row->own_arithmetic && !row->own_samples;
        if (fair && (best == nullptr || better(*row, *best))) best = row;
    }
    return best;
}

std::string matrix(const BenchScene& scene, const Lookup& lookup) {
    const std::size_t n = lookup.effects.size();
    std::string out = fmt::format(
        "<div class=\"scroll\"><table class=\"tight\"><thead><tr><th class=\"t\" rowspan=\"2\">method</th><th "
        "class=\"gap\" "
        "colspan=\"{0}\">STE in "
        "percent</th><th class=\"gap\" colspan=\"{0}\">visibility of a frame in ms</th></tr>\n<tr>",
        n);
    for (int side = 0; side < 2; ++side)
        for (std::size_t i = 0; i < n; ++i)
            out += fmt::format("<th{}>{}</th>", i == 0 ? " class=\"gap\"" : "", lookup.effects[i]);
    out += "</tr></thead><tbody>\n";
    for (const std::string& method : lookup.methods) {
        out += "<tr><td class=\"t\">" + method_label(lookup, method) + "</td>";
        for (int side = 0; side < 2; ++side)
            for (std::size_t i = 0; i < n; ++i) {
                const BenchRow* row = lookup.row(scene.name, lookup.effects[i], method);
                const BenchRow* best = side == 0 ? best_of(scene, lookup.effects[i], lookup,
                                                           [](auto& a, auto& b) { return a.ste() > b.ste(); })
                                                 : best_of(scene, lookup.effects[i], lookup,
                                                           [](auto& a, auto& b) { return a.frame_ms < b.frame_ms; });
                const std::string kind = std::string(i == 0 ? "gap" : "") + (row && row == best ? " best" : "");
                out += fmt::format("<td class=\"{}\">{}</td>", kind,
                                   row == nullptr ? ""
                                   : side == 0    ? percent(row->ste())
                                                  : milliseconds(row->frame_ms));
            }
        out += "</tr>\n";
    }
    return out + "</tbody></table></div>\n";
}

std::string pictures(const BenchReport& report, const BenchScene& scene, const Lookup& lookup) {
    std::string out;
    for (const BenchImage& image : report.images) {
        if (image.scene != scene.name || image.kind != BenchImageKind::kPicture) continue;
        const BenchCell* cell = lookup.cell(scene.name, image.effect);
        out += "<figure>" + image_tag(image, short_name(scene.name) + ", " + image.effect) + "<figcaption><b>" +
               image.effect + "</b>";
        if (cell)
            out += fmt::format(": {:.1f} px of motion, circles of confusion of {:.1f} px radius in the mean",
                               cell->motion_px, cell->blur_px);
        out += "</figcaption></figure>\n";
    }
    return out.empty() ? "" : "<div class=\"pictures\">\n" + out + "</div>\n";
}

std::string heat_maps(const BenchReport& report, const BenchScene& scene) {
    std::string out, effect;
    double largest = 0.0;
    for (const BenchImage& tested : report.images) {
        if (tested.scene != scene.name || tested.kind != BenchImageKind::kTested) continue;
        effect = tested.effect;
        largest = tested.largest;
        out += "<figure><div class=\"pair\">" + image_tag(tested, tested.method + ": tests");
        for (const BenchImage& wasted : report.images)
            if (wasted.kind == BenchImageKind::kWasted && wasted.scene == tested.scene &&
                wasted.effect == tested.effect && wasted.method == tested.method)
                out += image_tag(wasted, tested.method + ": wasted tests");
        out += "</div><figcaption><b>" + escape_html(tested.method) + "</b>";
        out += fmt::format(": {:.2f} tests a sample", tested.mean);
        for (const BenchImage& wasted : report.images)
            if (wasted.kind == BenchImageKind::kWasted && wasted.scene == tested.scene &&
                wasted.effect == tested.effect && wasted.method == tested.method)
                out += fmt::format(", {:.2f} of them wasted", wasted.mean);
        out += "</figcaption></figure>\n";
    }
    if (out.empty()) return "";
    return fmt::format(
               "<h3>Where the tests are ({})</h3>\n<p class=\"small soft\">Left: exact tests a sample, pixel by pixel. "
               "Right: those of them "
               "that missed. The scale is logarithmic and the same for all.</p>\n"
               "<div class=\"heat\"></div><div class=\"heatscale\"><span>0</span><span>{:.3g}</span><span>{:.3g} a "
               "sample</span></div>\n"
               "<div class=\"maps\">\n",
               effect, largest * std::pow(10.0, -1.5), largest) +
           out + "</div>\n";
}

std::string missing(const BenchReport& report, const BenchScene& scene) {
    std::string out;
    for (const BenchImage& image : report.images) {
        if (image.scene != scene.name || image.kind != BenchImageKind::kMissing) continue;
        out += "<figure>" + image_tag(image, image.method + ": lost samples") +
               fmt::format("<figcaption><b>{}</b>, {}: {:.2f} % of the samples lost</figcaption></figure>\n",
                           escape_html(image.method), image.effect, 100.0 * image.mean);
    }
    if (out.empty()) return "";
    return "<h3>What is lost by tests as printed</h3>\n<p class=\"small soft\">Red: samples whose hit is missing or is "
           "another surface than "
           "without culling.</p>\n<div class=\"pictures\">\n" +
           out + "</div>\n";
}

std::string shares(const BenchScene& scene, const Lookup& lookup) {
    std::string out;
    for (const std::string& effect : lookup.effects)
        if (const BenchCell* cell = lookup.cell(scene.name, effect); cell && cell->share < 1.0)
            out += fmt::format("{}{} {:.2g} %", out.empty() ? "" : ", ", effect, 100.0 * cell->share);
    return out.empty() ? ""
                       : "<p class=\"small soft\">Part of the picture's tiles that was measured: " + out +
                             "; the others whole.</p>\n";
}

std::string scene_section(const BenchReport& report, const BenchScene& scene, const Lookup& lookup) {
    const std::string name = short_name(scene.name);
    std::string out = fmt::format("<h2 id=\"{0}\">{0}</h2>\n<p>", escape_html(name));
    if (!scene.description.empty()) out += escape_html(scene.description) + ". ";
    out += fmt::format("{} triangles; frame {:g}; shutter open for {:.2f} frames at {:g} a second; ",
                       grouped(scene.triangles), scene.frame, scene.shutter_frames, scene.fps);
    if (scene.fstop > 0.0) out += fmt::format("f/{:.2g}, ", scene.fstop);
    out += fmt::format("lens radius {:.3g} mm, in focus at {:.3g} m{}.</p>\n", 1000.0 * scene.lens_radius,
                       scene.focus_distance, scene.own_lens ? "" : " (this scene has no lens of its own: a default)");
    out += pictures(report, scene, lookup);
    out += "<h3>Sample test efficiency</h3>\n" +
           plots(scene, lookup, "STE", "%", [](const BenchRow& row) { return 100.0 * row.ste(); });
    out += "<h3>Time</h3>\n" + plots(scene, lookup, "ms", "", [](const BenchRow& row) { return row.frame_ms; });
    out +=
        "<p class=\"small soft\">Click a method to see it alone; rest on a point to read it. Green: the best of a "
        "column among tests that "
        "lose nothing.</p>\n";
    out += matrix(scene, lookup);
    out += shares(scene, lookup);
    return out + heat_maps(report, scene) + missing(report, scene);
}

// ---- published figures ----

std::string published(const BenchReport& report, const Lookup& lookup) {
    std::string out =
        "<h2 id=\"published\">As published, and here</h2>\n<p>STE counts work and knows nothing of the machine; times "
        "are set beside each "
        "other for their ratios alone. What differs is told below, scene by scene.</p>\n"
        "<div class=\"scroll\"><table class=\"sortable\"><thead><tr>";
    for (const char* title : {"paper", "scene", "effect", "their method", "STE there, %", "STE here, %", "our method",
                              "ms there", "ms here"}) {
        const bool text =
            std::string(title).find("STE") == std::string::npos && std::string(title).find("ms") == std::string::npos;
        out += fmt::format("<th{} aria-sort=\"none\"><button>{}</button></th>", text ? " class=\"t\"" : "", title);
    }
    out += "</tr></thead><tbody>\n";
    for (const PublishedFigure& figure : published_figures()) {
        const BenchRow* ours = lookup.row("builtin:" + figure.our_scene, figure.effect, figure.our_method);
        const auto number = [](bool known, double value, const std::string& text) {
            return known ? fmt::format("<td data-v=\"{:g}\">{}</td>", value, text)
                         : std::string("<td data-v=\"-1\"></td>");
        };
        out += fmt::format(
            "<tr><td class=\"t\">{}</td><td class=\"t\">{}</td><td class=\"t\">{}</td><td class=\"t\">{}</td>",
            escape_html(figure.paper), figure.scene, figure.effect, escape_html(figure.method));
        out += number(figure.ste > 0.0, figure.ste, fmt::format("{:g}", 100.0 * figure.ste));
        out += number(ours != nullptr, ours ? ours->ste() : 0.0, ours ? percent(ours->ste()) : "");
        out += fmt::format("<td class=\"t\">{}</td>", escape_html(figure.our_method));
        out += number(figure.milliseconds > 0.0, figure.milliseconds, milliseconds(figure.milliseconds));
        out +=
            number(ours != nullptr, ours ? ours->frame_ms : 0.0, ours ? milliseconds(ours->frame_ms) : "") + "</tr>\n";
    }
    out += "</tbody></table></div>\n<h3>What differs</h3>\n";
    for (const BenchScene& scene : report.scenes)
        if (const std::string difference = published_difference(short_name(scene.name)); !difference.empty())
            out += fmt::format("<p><b>{}.</b> {}</p>\n", escape_html(short_name(scene.name)), escape_html(difference));
    return out;
}

// ---- ray tracer ----

// The ratio by effect, a line for each scene, a plot for each number of threads.
std::string peer_plots(const BenchReport& report) {
    std::vector<std::string> scenes, effects;
    std::vector<int> threads;
    const auto place = [](auto& names, const auto& name) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found != names.end()) return static_cast<int>(found - names.begin());
        names.push_back(name);
        return static_cast<int>(names.size()) - 1;
    };
    double least = 1.0, largest = 1.0;
    for (const BenchPeer& p : report.peers) {
        place(scenes, p.scene);
        place(effects, p.effect);
        place(threads, p.threads);
        if (p.ratio() <= 0.0) continue;
        least = std::min(least, p.ratio());
        largest = std::max(largest, p.ratio());
    }
    std::string out = "<p>";
    for (std::size_t i = 0; i < scenes.size(); ++i)
        out += fmt::format("<span class=\"swatch s{}\"></span>{} &#160; ", i + 1, escape_html(short_name(scenes[i])));
    out += "</p>\n<div class=\"panels\">\n";
    for (const int count : threads) {
        Plot plot;
        plot.title = fmt::format("{} {}", count, count == 1 ? "thread" : "threads");
        plot.y_title = "Embree's time over ours";
        plot.x_title = "effect";
        for (std::size_t i = 0; i < effects.size(); ++i) plot.x_ticks.push_back({static_cast<double>(i), effects[i]});
        fit(plot, least, largest);
        for (std::size_t s = 0; s < scenes.size(); ++s) {
            PlotSeries series{static_cast<int>(s) + 1, {}};
            for (const BenchPeer& p : report.peers)
                if (p.threads == count && p.scene == scenes[s] && p.ratio() > 0.0)
                    series.points.push_back(
                        {static_cast<double>(place(effects, p.effect)), p.ratio(),
                         fmt::format("{}, {}: {:.1f} + {:.1f} ms over {:.1f} ms", short_name(p.scene), p.effect,
                                     p.build_ms, p.trace_ms, p.ours_ms)});
            plot.series.push_back(std::move(series));
        }
        out += "<div class=\"panel\">" + svg(plot) + "</div>\n";
    }
    return out + "</div>\n";
}

std::string peers(const BenchReport& report) {
    if (report.peers.empty()) return "";
    std::string out =
        "<h2 id=\"peers\">Against a ray tracer</h2>\n<p>Embree finds the same visible triangle of the same samples. "
        "Its time is that of building "
        "its hierarchy and of tracing, ours that of bounds, bins, culling and coverage (<i>auto</i>), runs in turn, "
        "medians. Ratio: its "
        "build and trace over ours; above 1 rasterization is the faster one. Embree's set-up is the fastest of some "
        "fifteen "
        "that were tried on the frame.</p>\n" +
        peer_plots(report) + "<div class=\"scroll\"><table class=\"sortable\"><thead><tr>";
    for (const char* title : {"scene", "effect", "threads", "build ms", "trace ms", "ours ms", "ratio", "ray tracer"})
        out += fmt::format("<th aria-sort=\"none\"><button>{}</button></th>", title);
    out += "</tr></thead><tbody>\n";
    for (const BenchPeer& p : report.peers)
        out += fmt::format(
            "<tr><td class=\"t\">{}</td><td "
            "class=\"t\">{}</td><td>{}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td><td{}>{:.2f}</td><td "
            "class=\"t\">{}</td></tr>\n",
            escape_html(short_name(p.scene)), p.effect, p.threads, p.build_ms, p.trace_ms, p.ours_ms,
            p.ratio() >= 1.0 ? " class=\"best\"" : "", p.ratio(), escape_html(p.peer));
    return out + "</tbody></table></div>\n";
}

// ---- all rows ----

std::string filter_box(const char* title, int column, const std::vector<std::string>& names) {
    std::string out =
        fmt::format("<label>{} <select data-column=\"{}\"><option value=\"\">all</option>", title, column);
    for (const std::string& name : names) out += "<option>" + escape_html(name) + "</option>";
    return out + "</select></label>\n";
}

std::string all_rows(const BenchReport& report, const Lookup& lookup) {
    std::vector<std::string> scenes;
    for (const BenchScene& scene : report.scenes) scenes.push_back(short_name(scene.name));
    std::string out = "<h2 id=\"rows\">All rows</h2>\n<div class=\"filters\">" + filter_box("scene", 0, scenes) +
                      filter_box("effect", 1, lookup.effects) + filter_box("method", 2, lookup.methods) +
                      "</div>\n<div class=\"scroll\"><table class=\"sortable\" id=\"all\"><thead><tr>";
    int column = 0;
    for (const char* title : {"scene", "effect", "method", "STE, %", "tests", "tests a sample", "tests a hit",
                              "setup ms", "test ms", "frame ms", "lost", "tiles, %", "runs", "peak MB"})
        out +=
            fmt::format("<th{} aria-sort=\"none\"><button>{}</button></th>", column++ < 3 ? " class=\"t\"" : "", title);
    out += "</tr></thead><tbody>\n";
    const auto cell = [](double value, const std::string& text, const char* kind = "") {
        return fmt::format("<td class=\"{}\" data-v=\"{}\">{}</td>", kind, value, text);
    };
    for (const BenchRow& row : report.rows) {
        out += fmt::format("<tr><td class=\"t\">{}</td><td class=\"t\">{}</td><td class=\"t\">{}</td>",
                           escape_html(short_name(row.scene)), row.effect, escape_html(row.method));
        const double per_sample =
            static_cast<double>(row.tested) / static_cast<double>(std::max<std::int64_t>(1, row.samples));
        const BenchCell* measured = lookup.cell(row.scene, row.effect);
        const double share = measured ? measured->share : 1.0;
        out += cell(row.ste(), percent(row.ste())) + cell(static_cast<double>(row.tested), grouped(row.tested)) +
               cell(per_sample, fmt::format("{:.2f}", per_sample)) +
               cell(row.tests_per_covered(), fmt::format("{:.2f}", row.tests_per_covered())) +
               cell(row.setup_ms, milliseconds(row.setup_ms)) + cell(row.test_ms, milliseconds(row.test_ms)) +
               cell(row.frame_ms, milliseconds(row.frame_ms)) +
               cell(static_cast<double>(row.false_culls), grouped(row.false_culls), row.false_culls > 0 ? "bad" : "") +
               cell(share, fmt::format("{:.3g}", 100.0 * share)) + cell(row.runs, std::to_string(row.runs)) +
               cell(row.peak_mb, fmt::format("{:.0f}", row.peak_mb)) + "</tr>\n";
    }
    return out + "</tbody></table></div>\n";
}

constexpr const char* kHow = R"html(<h2 id="method">How it was measured</h2>
<p><b>Effects.</b> still: no motion, a pinhole. motion and defocus: the scene's own shutter and lens. x2: the shutter is open twice as long, the
lens has twice the radius.</p>
<p><b>Counts</b> come from one run of each method. Where the bounding box alone would need very many tests, a part of the picture's tiles is
measured, spread evenly, the same ones with every method; times are then those of the tiles over that part. tests: exact 5D tests of one sample against one triangle; a hit is one
that accepts, whether or not something nearer hides it. lost: samples whose visible triangle or depth differs in any bit from those without
culling (<i>none</i>, the bounding box alone).</p>
<p><b>Times</b> are medians of runs in which all methods take turns, wall times with all threads. frame: from posed triangles to the visible
triangle and depth of every sample, without shading. setup: bounds, bins, and the same walk with every question of the test asked but each
sample refused in the end, so that no exact test follows. test: the difference. The questions of <i>auto</i> depend on depths found so far;
its setup is bounds and bins alone. Slow methods get fewer runs, as their rows tell. Only ratios within one report mean something.</p>
<p><b>auto</b> is the vector path that renders; the culling tests by name run in a plain scalar walk, pixel by pixel, so that they are
compared with each other and with <i>none</i>, not with <i>auto</i>. auto also skips what is hidden, so its tests and hits are fewer.</p>
<p><b>Memory</b> is the largest resident memory while a method counted, scene and program included, what the laboratory keeps for comparisons not.</p>
)html";

}  // namespace

std::string bench_html(const BenchReport& report) {
    const Lookup lookup(report);
    std::string out = fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width\">\n"
        "<title>{}: culling tests measured</title>\n<style>{}</style></head>\n<body>\n",
        kProject, report_style(static_cast<int>(std::max(lookup.methods.size(), report.scenes.size())) + 1));
    out += head(report, lookup) + "<main>\n";
    for (const BenchScene& scene : report.scenes) out += scene_section(report, scene, lookup);
    out += published(report, lookup) + peers(report) + all_rows(report, lookup) + kHow;
    return out + "</main>\n<script>" + report_script() + "</script>\n</body></html>\n";
}

}  // namespace pentaprism
