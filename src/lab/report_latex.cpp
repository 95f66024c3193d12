// Rows for a tabular (booktabs): one table for each scene, methods down, effects across, STE in percent over
// milliseconds.

#include <algorithm>
#include <fmt/format.h>
#include <pentaprism/bench.h>

namespace pentaprism {
namespace {

std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\\') {
            result += "\\textbackslash{}";
        } else if (c == '~' || c == '^') {
            result += std::string("\\") + c + "{}";
        } else {
            if (std::string("&%$#_{}").find(c) != std::string::npos) result += '\\';
            result += c;
        }
    }
    return result;
}

template <class Name>
std::vector<std::string> names_in_order(const std::vector<BenchRow>& rows, Name name) {
    std::vector<std::string> names;
    for (const BenchRow& row : rows)
        if (std::find(names.begin(), names.end(), row.*name) == names.end()) names.push_back(row.*name);
    return names;
}

}  // namespace

std::string bench_latex(const BenchReport& report) {
    const auto effects = names_in_order(report.rows, &BenchRow::effect);
    const auto methods = names_in_order(report.rows, &BenchRow::method);
    std::string text = fmt::format(
        "% Sample test efficiency in percent / visibility of a frame in milliseconds; {}x{}, {} samples per pixel.\n"
        "% {}, {}, {} threads, {}. Needs \\usepackage{{booktabs}}.\n",
        report.width, report.height, report.spp, report.machine.cpu, report.machine.isa, report.machine.threads,
        report.machine.compiler);
    for (const BenchScene& scene : report.scenes) {
        text += fmt::format("\n% {}: {} triangles\n\\begin{{tabular}}{{l{}}}\n\\toprule\n{}", scene.name,
                            scene.triangles, std::string(effects.size(), 'r'), escaped(scene.name));
        for (const std::string& effect : effects) text += " & " + escaped(effect);
        text += " \\\\\n\\midrule\n";
        for (const std::string& method : methods) {
            text += escaped(method);
            for (const std::string& effect : effects) {
                text += " & ";
                for (const BenchRow& row : report.rows)
                    if (row.scene == scene.name && row.effect == effect && row.method == method)
                        text += fmt::format("{:.1f} / {:.0f}", 100.0 * row.ste(), row.frame_ms);
            }
            text += " \\\\\n";
        }
        text += "\\bottomrule\n\\end{tabular}\n";
    }
    return text;
}

}  // namespace pentaprism
