#include "canonpose/view/skeleton_strip.h"

#include <regex>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/view/page_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

ShownResult Walking(int people) { return {"walk.h5", {testing::WalkingScene(people, 50)}, "", ""}; }

int Count(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The mean x of lines of a colour within their figure.
double MeanX(const std::string& svg, const std::string& colour) {
  double sum = 0.0;
  int count = 0;
  const std::regex line("<line x1=\"([-0-9.]+)\"[^>]*x2=\"([-0-9.]+)\"[^>]*stroke=\"" + colour + "\"");
  for (std::sregex_iterator it(svg.begin(), svg.end(), line); it != std::sregex_iterator(); ++it) {
    sum += std::stod((*it)[1]) + std::stod((*it)[2]);
    count += 2;
  }
  return sum / count;
}

TEST(SkeletonStrip, DrawsEveryFrameWithEveryLimb) {
  const std::string svg = SkeletonStrip({Walking(1)}, {{0, 10, 20}});
  EXPECT_EQ(Count(svg, "<g transform"), 3);
  EXPECT_EQ(Count(svg, "stroke=\"#0072B2\""), 3 * 6);  // hip, knee, ankle, shoulder, elbow, wrist
  EXPECT_EQ(Count(svg, "stroke=\"#D55E00\""), 3 * 6);
  EXPECT_EQ(Count(svg, "<circle"), 3);
  EXPECT_THAT(svg, HasSubstr(">0.40 s<"));
}

TEST(SkeletonStrip, ShowsThePersonsLeftOnTheRightFromInFront) {
  const std::string front = SkeletonStrip({Walking(1)}, {{5}, 0.0});
  EXPECT_GT(MeanX(front, "#0072B2"), 10.0);
  EXPECT_LT(MeanX(front, "#D55E00"), -10.0);
  const std::string back = SkeletonStrip({Walking(1)}, {{5}, 180.0});
  EXPECT_LT(MeanX(back, "#0072B2"), -10.0);
}

TEST(SkeletonStrip, HasARowForEachResult) {
  const std::string svg = SkeletonStrip({Walking(1), Walking(2)}, {{0, 10}});
  EXPECT_EQ(Count(svg, "<g transform"), 4);
  EXPECT_EQ(Count(svg, "<circle"), 2 + 4);
}

TEST(SkeletonStrip, RefusesFramesThatAreNotThere) {
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [] {
                        SkeletonStrip({Walking(1)}, {{0, 50}});
                      }),
              HasSubstr("frame 50: walk.h5 has frames 0 to 49"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { SkeletonStrip({Walking(1)}, {}); }), HasSubstr("`frames`"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument,
                      [] {
                        SkeletonStrip({Walking(1)}, {{0}, 0.0, 1});
                      }),
              HasSubstr("1 scenes"));
}

}  // namespace
}  // namespace canonpose
