// The report for a terminal: one table for each scene and effect.

#include <algorithm>
#include <fmt/format.h>
#include <pentaprism/bench.h>

namespace pentaprism {

std::string bench_table(const BenchReport& report) {
    const BenchMachine& m = report.machine;
    std::string text = fmt::format("{}, {}, {} of {} processors, {}; {}x{}, {} samples per pixel; times in ms\n", m.cpu,
                                   m.isa, m.threads, m.processors, m.compiler, report.width, report.height, report.spp);
    std::size_t widest = 6;
    for (const BenchRow& row : report.rows) widest = std::max(widest, row.method.size());
    const BenchRow* last = nullptr;
    for (const BenchRow& row : report.rows) {
        if (last == nullptr || last->scene != row.scene || last->effect != row.effect) {
            text += fmt::format("\n{} {}\n", row.scene, row.effect);
            for (const BenchCell& cell : report.cells)
                if (cell.scene == row.scene && cell.effect == row.effect)
                    text.insert(text.size() - 1, fmt::format(": {:.1f} px of motion, circles of {:.1f} px radius",
                                                             cell.motion_px, cell.blur_px));
            text += fmt::format("  {:<{}} {:>7} {:>15} {:>12} {:>9} {:>10} {:>9} {:>9} {:>8}\n", "method", widest,
                                "STE", "tested", "tests/cover", "setup", "test", "frame", "lost", "MB");
        }
        text += fmt::format("  {:<{}} {:>6.2f}% {:>15} {:>12.2f} {:>9.1f} {:>10.1f} {:>9.1f} {:>9} {:>8.0f}\n",
                            row.method, widest, 100.0 * row.ste(), row.tested, row.tests_per_covered(), row.setup_ms,
                            row.test_ms, row.frame_ms, row.false_culls, row.peak_mb);
        last = &row;
    }
    if (!report.peers.empty()) text += "\nagainst a ray tracer, visibility alone\n";
    for (const BenchPeer& peer : report.peers) {
        text +=
            fmt::format("  {} {}, {} threads: {} {:.1f} build + {:.1f} trace, ours {:.1f}: ratio {:.2f}\n", peer.scene,
                        peer.effect, peer.threads, peer.peer, peer.build_ms, peer.trace_ms, peer.ours_ms, peer.ratio());
    }
    return text;
}

}  // namespace pentaprism
