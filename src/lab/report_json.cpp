// One JSON document. Keys are a contract: more may be added, none is renamed.

#include <nlohmann/json.hpp>
#include <pentaprism/bench.h>

namespace pentaprism {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const BenchMachine& m) {
    return {{"cpu", m.cpu},
            {"isa", m.isa},
            {"processors", m.processors},
            {"threads", m.threads},
            {"memory_gb", m.memory_gb},
            {"compiler", m.compiler},
            {"system", m.system}};
}

Json to_json(const BenchRow& r) {
    return {{"scene", r.scene},
            {"effect", r.effect},
            {"method", r.method},
            {"backend", r.backend},
            {"conservative", r.conservative},
            {"own_arithmetic", r.own_arithmetic},
            {"own_samples", r.own_samples},
            {"ste", r.ste()},
            {"samples", r.samples},
            {"tested", r.tested},
            {"covered", r.covered},
            {"tests_per_covered", r.tests_per_covered()},
            {"footprints", r.footprints},
            {"kept_footprints", r.kept_footprints},
            {"asked", r.asked},
            {"false_culls", r.false_culls},
            {"setup_ms", r.setup_ms},
            {"test_ms", r.test_ms},
            {"frame_ms", r.frame_ms},
            {"runs", r.runs},
            {"peak_mb", r.peak_mb}};
}

Json to_json(const BenchPeer& p) {
    return {{"scene", p.scene},       {"effect", p.effect},   {"threads", p.threads},
            {"peer", p.peer},         {"runs", p.runs},       {"build_ms", p.build_ms},
            {"trace_ms", p.trace_ms}, {"ours_ms", p.ours_ms}, {"ratio", p.ratio()}};
}

Json to_json(const BenchScene& s) {
    return {{"scene", s.name},
            {"description", s.description},
            {"triangles", s.triangles},
            {"frame", s.frame},
            {"fps", s.fps},
            {"shutter", s.shutter_frames},
            {"lens_radius", s.lens_radius},
            {"fstop", s.fstop},
            {"focus_distance", s.focus_distance},
            {"own_lens", s.own_lens}};
}

Json to_json(const BenchCell& c) {
    return {{"scene", c.scene},         {"effect", c.effect},   {"share", c.share},
            {"motion_px", c.motion_px}, {"blur_px", c.blur_px}, {"hit", c.hit}};
}

template <class T>
Json array_of(const std::vector<T>& values) {
    Json array = Json::array();
    for (const T& value : values) array.push_back(to_json(value));
    return array;
}

}  // namespace

std::string bench_json(const BenchReport& report) {
    const Json json{{"machine", to_json(report.machine)},
                    {"width", report.width},
                    {"height", report.height},
                    {"spp", report.spp},
                    {"seed", report.seed},
                    {"seconds", report.seconds},
                    {"rows", array_of(report.rows)},
                    {"peers", array_of(report.peers)},
                    {"scenes", array_of(report.scenes)},
                    {"cells", array_of(report.cells)}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pentaprism
