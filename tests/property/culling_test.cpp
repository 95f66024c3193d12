// No culling test rejects a sample that the exact test accepts (docs/develop/algorithms.md 4.0, 4.13). Every test of
// the table is proved here by being in the table; broken tests show that the method would notice.
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "cull/cull_test.h"
#include "support/hard_triangles.h"

namespace pentaprism {

// How GoogleTest shows a parameter.
void PrintTo(const CullTest* test, std::ostream* out) {
    *out << test->name;
}

namespace {

using support::effort;
using support::for_each_accepted;
using support::Hard;
using support::HardCase;
using support::kHardClasses;
using support::LensShape;
using support::name_of;
using support::Random;

struct Question {
    const char* what;
    Footprint footprint;
};

// Regions of the screen, the lens and the shutter that hold the sample, from a pixel to a whole cell.
class Questions {
  public:
    Questions(Random& r, const HardCase& hard_case, const LocalSample& s) : s_(s), ratio_(hard_case.ratio()) {
        const Domain whole{-1, 1, -ratio_, ratio_, 0, 1};
        questions_[0] = {"pixel", square(1, whole)};
        questions_[1] = {"block", square(kBlockSize, restricted(r))};
        questions_[2] = {"tile", square(8 << r.below(3), r.chance(0.5) ? whole : restricted(r))};
        questions_[3] = {"any rectangle", anywhere(r)};
    }
    const Question* begin() const { return questions_; }
    const Question* end() const { return questions_ + 4; }

  private:
    Footprint square(int size, const Domain& domain) const {
        const float f = static_cast<float>(size);
        const float x = std::floor((s_.hx + 16) / f) * f - 16, y = std::floor((s_.hy + 16) / f) * f - 16;
        return {x, x + f, y, y + f, domain};
    }
    static float lower(Random& r, float limit, float value) {
        return r.chance(0.2) ? value : limit + static_cast<float>(r.unit()) * (value - limit);
    }
    Domain restricted(Random& r) const {
        Domain d{lower(r, -1, s_.u),     lower(r, 1, s_.u), lower(r, -ratio_, s_.v),
                 lower(r, ratio_, s_.v), lower(r, 0, s_.t), lower(r, 1, s_.t)};
        return {std::min(d.u0, s_.u), std::max(d.u1, s_.u), std::min(d.v0, s_.v),
                std::max(d.v1, s_.v), std::min(d.t0, s_.t), std::max(d.t1, s_.t)};
    }
    Footprint anywhere(Random& r) const {
        Footprint f{lower(r, -16, s_.hx), lower(r, 16, s_.hx), lower(r, -16, s_.hy), lower(r, 16, s_.hy),
                    restricted(r)};
        return {std::min(f.x0, s_.hx), std::max(f.x1, s_.hx), std::min(f.y0, s_.hy), std::max(f.y1, s_.hy), f.domain};
    }

    LocalSample s_;
    float ratio_;
    Question questions_[4];
};

struct Tally {
    int accepted = 0, lost = 0;
    std::string first;  // what the first wrong rejection was about
};

Tally ask(const CullTest& test, Hard hard, std::uint64_t seed, int wanted) {
    Tally tally;
    Random r(seed ^ 0x51ed270b);
    const LensShape shape = seed % 2 == 0 ? LensShape::kDisk : LensShape::kSquare;
    CullState state;
    tally.accepted = for_each_accepted(
        hard, seed, wanted, shape, true, [&](const HardCase& c, const LocalSample& s, const SampleHit&) {
            for (const Question& question : Questions(r, c, s)) {
                const bool prepared = test.prepare(c.local, question.footprint, state);
                if (prepared && test.keeps(state, s)) continue;
                if (tally.lost++ == 0)
                    tally.first = std::string(prepared ? "keeps() " : "prepare() ") + "rejects a sample over a " +
                                  question.what + ", segment " + std::to_string(c.segment) + ", h = (" +
                                  std::to_string(s.hx) + ", " + std::to_string(s.hy) + "), uvt = (" +
                                  std::to_string(s.u) + ", " + std::to_string(s.v) + ", " + std::to_string(s.t) + ")";
            }
        });
    return tally;
}

class EveryCullTest : public ::testing::TestWithParam<const CullTest*> {};

TEST_P(EveryCullTest, KeepsEverySampleThatTheExactTestAccepts) {
    const int wanted = 50'000 * effort();
    for (const Hard hard : kHardClasses)
        for (const std::uint64_t seed : {2u, 3u}) {
            const Tally tally = ask(*GetParam(), hard, seed, wanted);
            EXPECT_GE(tally.accepted, wanted) << name_of(hard);
            EXPECT_EQ(tally.lost, 0) << GetParam()->name << ", " << name_of(hard) << ": " << tally.first;
        }
}

TEST_P(EveryCullTest, AnswersForAnEmptyDomainAndForNumbersThatAreNotFinite) {
    // No answer is wrong, but there must be one: an empty part of the shutter, and numbers that are not finite.
    Random r(5);
    HardCase c;
    CullState state;
    for (int i = 0; i < 2000; ++i) {
        make_hard_case(r, kHardClasses[i % kHardClasses.size()], c);
        c.local.qx[r.below(3)] = r.chance(0.5) ? INFINITY : NAN;
        const Footprint footprint{-4, -3, 7, 8, {-1, 1, -c.ratio(), c.ratio(), 0.9f, 0.1f}};
        if (GetParam()->prepare(c.local, footprint, state)) GetParam()->keeps(state, {-3.5f, 7.5f, 0, 0, 0.5f});
    }
}

std::string test_name(const ::testing::TestParamInfo<const CullTest*>& info) {
    std::string name = info.param->name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Culling, EveryCullTest, ::testing::ValuesIn(cull_table().begin(), cull_table().end()),
                         test_name);

// ---- Broken tests, each of which the method must notice
// ----------------------------------------------------------------

const CullTest& sound() {
    return *find_cull_test("improved-dual-space");
}
bool sound_keeps(const CullState& state, const LocalSample& sample) {
    return sound().keeps(state, sample);
}

bool without_footprint_width(const LocalTriangle& T, const Footprint& f, CullState& state) {
    const float x = 0.5f * (f.x0 + f.x1), y = 0.5f * (f.y0 + f.y1);
    return sound().prepare(T, {x, x, y, y, f.domain}, state);
}
bool with_one_vertex_forgotten(const LocalTriangle& T, const Footprint& f, CullState& state) {
    LocalTriangle wrong = T;
    for (auto* p : {&wrong.qx, &wrong.qy, &wrong.qw, &wrong.qc, &wrong.dx, &wrong.dy, &wrong.dw, &wrong.dc})
        (*p)[2] = (*p)[1];
    return sound().prepare(wrong, f, state);
}
bool with_unsigned_coc(const LocalTriangle& T, const Footprint& f, CullState& state) {
    LocalTriangle wrong = T;
    for (int i = 0; i < 3; ++i) {
        const float end = std::abs(T.qc[i] + T.dc[i]);
        wrong.qc[i] = std::abs(T.qc[i]);
        wrong.dc[i] = end - wrong.qc[i];
    }
    return sound().prepare(wrong, f, state);
}
bool at_the_middle_of_the_shutter(const LocalTriangle& T, const Footprint& f, CullState& state) {
    LocalTriangle wrong = T;
    for (int i = 0; i < 3; ++i) {
        wrong.qx[i] += 0.5f * T.dx[i];
        wrong.qy[i] += 0.5f * T.dy[i];
        wrong.dx[i] = wrong.dy[i] = 0;
    }
    return sound().prepare(wrong, f, state);
}
bool with_the_first_segment_for_all(const LocalTriangle& T, const Footprint& f, CullState& state) {
    LocalTriangle wrong = T;
    wrong.segment = 0;
    return sound().prepare(wrong, f, state);
}
bool with_one_lens_axis_for_both(const LocalTriangle& T, const Footprint& f, CullState& state) {
    Footprint wrong = f;
    wrong.domain.v0 = f.domain.u0;
    wrong.domain.v1 = f.domain.u1;
    return sound().prepare(T, wrong, state);
}

struct Broken {
    const char* name;
    CullTest test;
};
void PrintTo(const Broken& broken, std::ostream* out) {
    *out << broken.name;
}
class ABrokenCullTest : public ::testing::TestWithParam<Broken> {};

TEST_P(ABrokenCullTest, IsCaught) {
    int lost = 0;
    for (const Hard hard : kHardClasses)
        for (const std::uint64_t seed : {2u, 3u}) lost += ask(GetParam().test, hard, seed, 1000).lost;
    EXPECT_GT(lost, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Culling, ABrokenCullTest,
    ::testing::Values(Broken{"NoFootprintWidth", {"", "", without_footprint_width, sound_keeps}},
                      Broken{"VertexForgotten", {"", "", with_one_vertex_forgotten, sound_keeps}},
                      Broken{"UnsignedCoc", {"", "", with_unsigned_coc, sound_keeps}},
                      Broken{"MiddleOfShutter", {"", "", at_the_middle_of_the_shutter, sound_keeps}},
                      Broken{"FirstSegmentForAll", {"", "", with_the_first_segment_for_all, sound_keeps}},
                      Broken{"OneLensAxisForBoth", {"", "", with_one_lens_axis_for_both, sound_keeps}}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace pentaprism
