// Frame lists as the command line takes them, and the names of a sequence's files.

#include <gtest/gtest.h>
#include <pentaprism/error.h>
#include <pentaprism/frames.h>

namespace pentaprism {
namespace {

using Frames = std::vector<std::int64_t>;

TEST(FrameList, RangesSinglesAndStepsComeInTheOrderGiven) {
    EXPECT_EQ(parse_frames("7"), Frames({7}));
    EXPECT_EQ(parse_frames("0-3"), Frames({0, 1, 2, 3}));
    EXPECT_EQ(parse_frames("1-3,60,100-110x4"), Frames({1, 2, 3, 60, 100, 104, 108}));
    EXPECT_EQ(parse_frames("60,1-2"), Frames({60, 1, 2}));
    EXPECT_EQ(parse_frames("5-5"), Frames({5}));
}

TEST(FrameList, LargerFirstRunsBackwards) {
    EXPECT_EQ(parse_frames("3-0"), Frames({3, 2, 1, 0}));
    EXPECT_EQ(parse_frames("10-1x4"), Frames({10, 6, 2}));
}

TEST(FrameList, WrongListsAreUsageErrorsInOneLine) {
    for (const char* list : {"",           ",",         "1,",     ",1",  "a",  "1-",  "-1",    "1--2",
                             "1-2x0",      "1-2x",      "1-2x-1", "1.5", "1 ", "1;2", "1-3,2", "99999999999999999999",
                             "1000000000", "0-2000000", "1-2-3",  "+1"}) {
        try {
            parse_frames(list);
            ADD_FAILURE() << "'" << list << "' was taken";
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::kUsage) << list;
            EXPECT_NE(std::string(error.what()).find(list), std::string::npos) << "the message shows the list";
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    }
}

TEST(FrameList, NumberIsPaddedToTheNumberOfSigns) {
    EXPECT_EQ(frame_file("out/a.####.exr", 12), "out/a.0012.exr");
    EXPECT_EQ(frame_file("a#.png", 12), "a12.png");
    EXPECT_EQ(frame_file("##.png", 123), "123.png");
    EXPECT_EQ(frame_file("take#2_###.png", 5), "take#2_005.png");
    EXPECT_EQ(frame_file("a.exr", 5), "a.exr");
}

TEST(FrameList, FolderKeepsItsSigns) {
    EXPECT_EQ(frame_file("shot##/a.##.exr", 5), "shot##/a.05.exr");
    EXPECT_FALSE(has_frame_number("shot##/a.exr"));
    EXPECT_TRUE(has_frame_number("shot/a#.exr"));
}

}  // namespace
}  // namespace pentaprism
