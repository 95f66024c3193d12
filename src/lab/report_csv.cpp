// Comma-separated values as RFC 4180 has them: one line for each row, numbers with a point, names quoted where they
// must be.

#include <fmt/format.h>
#include <pentaprism/bench.h>

namespace pentaprism {
namespace {

std::string quoted(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string result = "\"";
    for (const char c : text) result += c == '"' ? "\"\"" : std::string(1, c);
    return result + "\"";
}

}  // namespace

std::string bench_csv(const BenchReport& report) {
    std::string text =
        "scene,effect,method,backend,ste,samples,tested,covered,tests_per_covered,footprints,kept_footprints,asked,"
        "false_culls,setup_ms,test_ms,frame_"
        "ms,"
        "runs,peak_mb\n";
    for (const BenchRow& r : report.rows) {
        text += fmt::format("{},{},{},{},{:.6f},{},{},{},{:.4f},{},{},{},{},{:.3f},{:.3f},{:.3f},{},{:.1f}\n",
                            quoted(r.scene), r.effect, quoted(r.method), r.backend, r.ste(), r.samples, r.tested,
                            r.covered, r.tests_per_covered(), r.footprints, r.kept_footprints, r.asked, r.false_culls,
                            r.setup_ms, r.test_ms, r.frame_ms, r.runs, r.peak_mb);
    }
    return text;
}

}  // namespace pentaprism
