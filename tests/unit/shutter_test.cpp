// The shutter's curve as a distribution of time, its file, and the times that a rolling shutter gives to places.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <unistd.h>

#include "camera/shutter_curve.h"
#include "sample/sample_times.h"

namespace pentaprism {
namespace {

constexpr float kTick = 1.0f / 16777216.0f;

TEST(ShutterCurve, ATrapezoidLetsTheLightInAtTheTimesOfItsQuadraticRamps) {
    // Ramps of 0.2 and 0.4, open for 0.4 between them: light 0.1 + 0.4 + 0.2.
    const ShutterCurve curve(trapezoid_shutter(0.2, 0.6));
    for (const double t : {0.05, 0.1, 0.2}) EXPECT_NEAR(curve.time_of(0.5 * t * t / 0.2 / 0.7), t, 1e-12);
    for (const double t : {0.3, 0.45, 0.6}) EXPECT_NEAR(curve.time_of((0.1 + t - 0.2) / 0.7), t, 1e-12);
    for (const double t : {0.7, 0.9, 1.0})
        EXPECT_NEAR(curve.time_of((0.7 - 0.5 * (1 - t) * (1 - t) / 0.4) / 0.7), t, 1e-7) << t;
    EXPECT_EQ(curve.time_of(0.0), 0.0);
}

TEST(ShutterCurve, NeverGoesBackAndStaysWhereThereIsLight) {
    const std::vector<std::vector<ShutterPoint>> curves = {
        trapezoid_shutter(0.0, 1.0),
        trapezoid_shutter(0.5, 0.5),
        trapezoid_shutter(0.0, 0.3),
        {{0.2, 0.0}, {0.4, 3.0}, {0.4, 0.0}, {0.7, 0.0}, {0.7, 1.0}, {0.9, 1.0}},  // two openings with a pause
        {{0.1, 1.0}, {0.2, 1e-9}, {0.3, 1e6}, {0.3, 0.0}},
    };
    for (const auto& points : curves) {
        const ShutterCurve curve(points);
        double before = points.front().t;
        for (int i = 0; i <= 10000; ++i) {
            const double t = curve.time_of(i / 10000.0);
            ASSERT_GE(t, before);
            ASSERT_LE(t, points.back().t);
            before = t;
        }
    }
    const ShutterCurve paused(curves[3]);
    for (int i = 0; i <= 1000; ++i) {
        const double t = paused.time_of(i / 1000.0);
        EXPECT_FALSE(t > 0.4 && t < 0.7) << "while the shutter is closed";
    }
}

TEST(ShutterCurve, OpenFromStartToEndIsNoCurve) {
    const ShutterCurve curve(trapezoid_shutter(0.0, 1.0));
    for (int i = 0; i < 1000; ++i) EXPECT_NEAR(curve.time_of(i / 1000.0), i / 1000.0, 1e-12);
}

TEST(ShutterCurve, IsReadFromAFileOrRefusedWithTheLine) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / ("shutter" + std::to_string(getpid()));
    const auto write = [&](const std::string& text) { std::ofstream(file) << text; };
    write("# of a leaf shutter\n0 0\n\n0.25, 1\n 0.5\t1   # here it begins to close\r\n1 0\n");
    const std::vector<ShutterPoint> points = read_shutter_curve(file.string());
    ASSERT_EQ(points.size(), 4u);
    EXPECT_EQ(points[1].t, 0.25);
    EXPECT_EQ(points[2].open, 1.0);
    for (const auto& [text, wanted] : {std::pair("0 0\n0.5\n1 1\n", "line 2"), std::pair("0 0\n1 1 1\n", "line 2"),
                                       std::pair("0 x\n", "line 1"), std::pair("0 1\n", "two points")}) {
        write(text);
        try {
            read_shutter_curve(file.string());
            ADD_FAILURE() << text;
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kUsage);
            EXPECT_NE(std::string(error.what()).find(wanted), std::string::npos) << error.what();
        }
    }
    std::filesystem::remove(file);
    EXPECT_THROW(read_shutter_curve(file.string()), Error);
}

Shutter rolling(RollingShutter edge, double exposure_share) {
    Shutter shutter;
    shutter.close = 1.0;
    shutter.rolling = edge;
    shutter.exposure_share = exposure_share;
    return shutter;
}

TEST(RollingShutter, OpensForTheFirstRowAtOnceAndClosesForTheLastAtTheEnd) {
    struct Case {
        RollingShutter edge;
        double x, y;  // of the place that comes first, in a picture of 40 x 20
    };
    for (const Case& c : {Case{RollingShutter::kTop, 7, 0}, Case{RollingShutter::kBottom, 7, 20},
                          Case{RollingShutter::kLeft, 0, 3}, Case{RollingShutter::kRight, 40, 3}}) {
        const SampleTimes times(rolling(c.edge, 0.25), 40, 20);
        const bool rows = c.edge == RollingShutter::kTop || c.edge == RollingShutter::kBottom;
        const double last_x = rows ? c.x : 40 - c.x, last_y = rows ? 20 - c.y : c.y;
        EXPECT_EQ(times.at(0.0f, c.x, c.y), 0.0f);
        EXPECT_EQ(times.at(0.5f, c.x, c.y), 0.125f);
        EXPECT_EQ(times.at(0.0f, last_x, last_y), 0.75f);
        EXPECT_EQ(times.at(1.0f - kTick, last_x, last_y), 1.0f - kTick);
        EXPECT_EQ(times.at(0.5f, 20, 10), 0.5f) << "the middle of the picture is exposed about the middle of the time";
    }
}

TEST(RollingShutter, GivesTimesWithinTheRangeItAnnounces) {
    for (const double share : {0.0, 0.1, 1.0 / 3.0, 0.9})
        for (const RollingShutter edge :
             {RollingShutter::kTop, RollingShutter::kBottom, RollingShutter::kLeft, RollingShutter::kRight}) {
            const SampleTimes times(rolling(edge, share), 97, 53);
            for (int i = 0; i < 2000; ++i) {
                const double x0 = i % 80, y0 = i % 37, x1 = x0 + 32, y1 = y0 + 32;
                const float t0 = static_cast<float>(i % 701) / 701.0f, t1 = std::min(1.0f - kTick, t0 + 0.1f);
                const auto [low, high] = times.range(t0, t1, x0, x1, y0, y1);
                for (const float t : {t0, 0.5f * (t0 + t1), t1})
                    for (const double x : {x0, x0 + 13.25, x1})
                        for (const double y : {y0, y0 + 1.0 / 256.0, y1}) {
                            const float at = times.at(t, x, y);
                            ASSERT_TRUE(at >= low && at <= high && at >= 0.0f && at < 1.0f) << at;
                            ASSERT_EQ(at / kTick, std::floor(at / kTick)) << "no multiple of 2^-24";
                        }
            }
        }
}

}  // namespace
}  // namespace pentaprism
