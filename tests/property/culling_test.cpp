// No culling test rejects a sample that the exact test accepts (docs/develop/algorithms.md 4.0, 4.13). Every test of
// the table is proved here by being in the table; those that are as a paper prints it must be caught losing samples.
// tests/property/culling_mutations_test.cpp shows that the method notices small mistakes.
#include <algorithm>
#include <gtest/gtest.h>
#include <mutex>
#include <set>
#include <string>
#include <tbb/parallel_for.h>
#include <vector>

#include "bound/facing.h"
#include "support/ask_cull.h"

namespace pentaprism {

// How GoogleTest shows a parameter.
void PrintTo(const CullTest* test, std::ostream* out) {
    *out << test->name;
}

namespace {

using support::Asked;
using support::effort;
using support::for_each_accepted;
using support::Hard;
using support::HardCase;
using support::kHardClasses;
using support::kRegions;
using support::LensShape;
using support::name_of;
using support::Random;
using support::Region;

// What one test did with the samples it was asked about.
struct Tally {
    std::int64_t asked = 0, lost = 0, asked_at_pixels = 0, lost_at_pixels = 0;
    std::string first;  // what the first wrong rejection was about
    void add(const Tally& other) {
        asked += other.asked;
        lost += other.lost;
        asked_at_pixels += other.asked_at_pixels;
        lost_at_pixels += other.lost_at_pixels;
        if (first.empty()) first = other.first;
    }
};

std::string told(Hard hard, const HardCase& c, Region region, const LocalSample& s, bool at_border) {
    return name_of(hard) + ", over a " + name_of(region) + (at_border ? ", at the border" : "") + ", segment " +
           std::to_string(c.segment) + ", h = (" + std::to_string(s.hx) + ", " + std::to_string(s.hy) + "), uvt = (" +
           std::to_string(s.u) + ", " + std::to_string(s.v) + ", " + std::to_string(s.t) + ")";
}

// Asks tests about accepted samples of one class, in turn: half of the tests about each sample, each over one of the
// regions.
std::vector<Tally> ask_all(std::span<const CullTest* const> tests, Hard hard, std::uint64_t seed, int wanted,
                           std::int64_t& accepted) {
    std::vector<Asked> asked;
    for (const CullTest* test : tests) asked.emplace_back(*test);
    std::vector<Tally> tallies(tests.size());
    Random r(seed ^ 0x51ed270b);
    const LensShape shape = seed % 2 == 0 ? LensShape::kDisk : LensShape::kSquare;
    std::size_t turn = 0;
    accepted +=
        for_each_accepted(hard, seed, wanted, shape, true, [&](const HardCase& c, LocalSample s, SampleHit hit) {
            const bool at_border = r.chance(0.15);
            if (at_border) support::push_to_border(r, c, shape, s, hit);
            ++turn;
            Footprint footprints[4];
            for (int k = 0; k < 4; ++k) footprints[k] = region_around(r, kRegions[k], c.ratio(), s);
            for (std::size_t i = 0; i < tests.size(); ++i) {
                // 256 boxes for each triangle would take most of the time.
                if (std::string_view(tests[i]->name) == "interval-fine" && c.serial % 8 != 0) continue;
                if ((turn + i) % 2 == 0) continue;  // the next sample
                // Its sides know that the lens is round.
                if (std::string_view(tests[i]->name) == "hull" && shape == LensShape::kSquare) continue;
                const std::size_t k = (turn / 2 + i) % 4;
                const bool kept = asked[i].keeps(c, footprints[k], s);
                Tally& tally = tallies[i];
                ++tally.asked;
                tally.asked_at_pixels += kRegions[k] == Region::kPixel;
                if (kept) continue;
                tally.lost_at_pixels += kRegions[k] == Region::kPixel;
                if (tally.lost++ == 0) tally.first = told(hard, c, kRegions[k], s, at_border);
            }
        });
    return tallies;
}

TEST(Culling, KeepsEverySampleThatTheExactTestAccepts) {
    constexpr int kChunks = 8;  // of each class, for all processors
    const int wanted = 115'000 * effort();
    const auto tests = cull_table();
    std::vector<Tally> total(tests.size());
    std::int64_t accepted = 0;
    std::mutex mutex;
    tbb::parallel_for(std::size_t{0}, kHardClasses.size() * kChunks, [&](std::size_t job) {
        std::int64_t here = 0;
        const std::vector<Tally> tallies = ask_all(tests, kHardClasses[job / kChunks], 2 + job % kChunks, wanted, here);
        const std::lock_guard<std::mutex> lock(mutex);
        for (std::size_t i = 0; i < tests.size(); ++i) total[i].add(tallies[i]);
        accepted += here;
    });
    EXPECT_GE(accepted, std::int64_t{wanted} * kChunks * static_cast<std::int64_t>(kHardClasses.size()));
    std::int64_t questions = 0;
    for (std::size_t i = 0; i < tests.size(); ++i) {
        const CullTest& test = *tests[i];
        const Tally& tally = total[i];
        questions += tally.asked;
        if (test.conservative) {
            EXPECT_GT(tally.asked, accepted / 20) << test.name;
            EXPECT_EQ(tally.lost, 0) << test.name << " rejects " << tally.first;
        } else {
            EXPECT_GT(tally.lost_at_pixels * 100, tally.asked_at_pixels)
                << test.name << " is said to lose samples; " << tally.lost_at_pixels << " of " << tally.asked_at_pixels
                << " is not even a percent";
            std::printf("%s loses %.1f %% over pixels\n", test.name,
                        100.0 * static_cast<double>(tally.lost_at_pixels) / static_cast<double>(tally.asked_at_pixels));
        }
        RecordProperty(test.name, std::to_string(tally.lost) + " of " + std::to_string(tally.asked));
    }
    std::printf("%lld accepted samples, %lld questions\n", static_cast<long long>(accepted),
                static_cast<long long>(questions));
}

class EveryCullTest : public ::testing::TestWithParam<const CullTest*> {};

TEST_P(EveryCullTest, AnswersForAnEmptyDomainAndForNumbersThatAreNotFinite) {
    // No answer is wrong, but there must be one: an empty part of the shutter, and numbers that are not finite.
    Random r(5);
    HardCase c;
    Asked asked(*GetParam());
    for (int i = 0; i < 2000; ++i) {
        make_hard_case(r, kHardClasses[i % kHardClasses.size()], c);
        float* const numbers[] = {c.local.qx, c.local.qy, c.local.qw, c.local.qc, c.local.dx, c.local.dw, c.local.dc};
        numbers[r.below(7)][r.below(3)] = r.chance(0.5) ? INFINITY : NAN;
        for (const float t1 : {0.1f, 1.0f}) {
            const Footprint footprint{-4, -3, 7, 8, {-1, 1, -c.ratio(), c.ratio(), 0.9f, t1}};
            asked.keeps(c, footprint, {-3.5f, 7.5f, 0, 0, 0.95f});
        }
    }
}

// Most bounds are the same function of larger ranges. A plane or line that fits a large footprint well may lie, here
// and there, below the one that fits a small footprint in it, and stage 2 of clip-space draws other lines: of those
// four the law is not true, and they are not asked.
std::vector<const CullTest*> tests_of_ranges() {
    static const std::set<std::string_view> kOther = {"hyperplane", "ut-vt-lines", "clip-space",
                                                      "clip-space-as-printed"};
    std::vector<const CullTest*> tests;
    for (const CullTest* test : cull_table())
        if (!kOther.contains(test->name)) tests.push_back(test);
    return tests;
}
class CullTestOfRanges : public ::testing::TestWithParam<const CullTest*> {};

TEST_P(CullTestOfRanges, KeepsOverALargerFootprintWhatItKeepsOverASmallerOne) {
    Random r(6);
    HardCase c;
    Asked small(*GetParam()), large(*GetParam());
    int kept_by_both = 0, kept_by_neither = 0, kept_by_small = 0;
    for (int i = 0; i < 60'000 * effort(); ++i) {
        if (i % 12 == 0) make_hard_case(r, kHardClasses[i / 12 % kHardClasses.size()], c);
        LocalSample s{static_cast<float>(r.range(-16, 16)), static_cast<float>(r.range(-16, 16)),
                      static_cast<float>(r.range(-1, 1)), static_cast<float>(r.range(-1, 1)) * c.ratio(), 0};
        const double t = (r.unit() + c.local.segment) / c.local.segments;
        s.t = static_cast<float>(std::floor(t * 0x1p24) * 0x1p-24);
        const Domain whole{-1, 1, -c.ratio(), c.ratio(), 0, 1};
        const bool in_large = large.keeps(c, support::square_around(s, 8, whole), s);
        const bool in_small =
            small.keeps(c,
                        support::square_around(
                            s, 1, r.chance(0.5) ? whole : support::detail::part_of_lens_and_shutter(r, c.ratio(), s)),
                        s);
        kept_by_both += in_small && in_large;
        kept_by_neither += !in_small && !in_large;
        kept_by_small += in_small && !in_large;
    }
    EXPECT_EQ(kept_by_small, 0);
    EXPECT_GT(kept_by_both, 0);
    if (GetParam()->prepare != keeps_every_footprint && std::string_view(GetParam()->name) != "facing") {
        EXPECT_GT(kept_by_neither, 0) << "a test that keeps all proves nothing";
    }
}

std::string test_name(const ::testing::TestParamInfo<const CullTest*>& info) {
    std::string name = info.param->name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Culling, EveryCullTest, ::testing::ValuesIn(cull_table().begin(), cull_table().end()),
                         test_name);
INSTANTIATE_TEST_SUITE_P(Culling, CullTestOfRanges, ::testing::ValuesIn(tests_of_ranges()), test_name);

TEST(Facing, OfAPartOfLensAndShutterIsTheSideThatItsSamplesSee) {
    int wrong = 0, decided = 0, two_sided = 0;
    for (const Hard hard : kHardClasses) {
        Random r(8);
        for_each_accepted(hard, 7, 10'000 * effort(), LensShape::kSquare, true,
                          [&](const HardCase& c, const LocalSample& s, const SampleHit& hit) {
                              const SegmentDomain whole = segment_domain(c.local, {-1, 1, -c.ratio(), c.ratio(), 0, 1});
                              const SegmentDomain part =
                                  segment_domain(c.local, support::detail::part_of_lens_and_shutter(r, c.ratio(), s));
                              const Facing side = facing(c.local, part);
                              decided += side != Facing::kMixed;
                              two_sided += side != Facing::kMixed && facing(c.local, whole) == Facing::kMixed;
                              wrong += side == (hit.front ? Facing::kBack : Facing::kFront);
                          });
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(decided, 10'000);
    EXPECT_GT(two_sided, 1'000) << "a part of a turning triangle's domain is not decided more often than all of it";
}

}  // namespace
}  // namespace pentaprism
