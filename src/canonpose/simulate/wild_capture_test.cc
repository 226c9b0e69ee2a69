#include "canonpose/simulate/wild_capture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

const Skeleton& Human() { return *FindSkeleton("h36m-17"); }

WildCaptureOptions Small() {
  WildCaptureOptions options;
  options.clips = 11;
  options.frames = 12;
  options.cameras = 2;
  options.seed = 4;
  return options;
}

/// Bitwise equality, including NaN.
bool SameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

bool SameBits(const Sequence& a, const Sequence& b) {
  return a.name == b.name && std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                                        [](const CameraView& x, const CameraView& y) {
                                          return SameBits(x.keypoints, y.keypoints) &&
                                                 SameBits(x.confidence, y.confidence) &&
                                                 SameBits(x.truth.positions(), y.truth.positions());
                                        });
}

TEST(WildCapture, ClipsDependOnOptionsAndNumberAlone) {
  WildCaptureOptions options = Small();
  options.threads = 1;
  const Dataset one = MakeWildCapture(Human(), options);
  options.threads = 3;
  const Dataset three = MakeWildCapture(Human(), options);
  ASSERT_EQ(one.sequences.size(), 11U);
  ASSERT_EQ(three.sequences.size(), 11U);
  for (std::size_t i = 0; i < one.sequences.size(); ++i) EXPECT_TRUE(SameBits(one.sequences[i], three.sequences[i]));
  EXPECT_TRUE(SameBits(MakeWildClip(Human(), options, 7), one.sequences[7]));
  options.seed = 5;
  EXPECT_FALSE(SameBits(MakeWildClip(Human(), options, 7), one.sequences[7]));
}

TEST(WildCapture, EveryBuiltinSkeletonCanBeMade) {
  for (const Skeleton& skeleton : BuiltinSkeletons()) {
    ASSERT_TRUE(IsKnownPerson(skeleton)) << skeleton.name;
    const Sequence clip = MakeWildClip(skeleton, Small(), 2);
    ASSERT_EQ(clip.cameras.size(), 2U);
    const std::size_t joints = skeleton.joints.size();
    for (const CameraView& view : clip.cameras) {
      ASSERT_EQ(view.truth.positions().size(), 12 * joints * 3);
      EXPECT_EQ(view.truth.confidence(), std::vector<float>(12 * joints, 1.0F)) << "all of it is known";
      const auto found = std::count_if(view.confidence.begin(), view.confidence.end(), [](float c) { return c > 0; });
      EXPECT_GT(found, static_cast<long>(12 * joints * 6 / 10)) << skeleton.name;
    }
  }
}

// Checks the correlation of columns of the image with x / z of the truth, and of rows with y / z.
TEST(WildCapture, KeypointsMatchTheTruth) {
  WildCaptureOptions options = Small();
  options.detector.noise = 0.0;
  for (int clip = 0; clip < options.clips; ++clip) {
    const Sequence sequence = MakeWildClip(Human(), options, clip);
    const CameraView& view = sequence.cameras[0];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double n = 0, sum_a = 0, sum_b = 0, aa = 0, bb = 0, ab = 0;
      for (std::size_t i = 0; i < view.confidence.size(); ++i) {
        if (!(view.confidence[i] > 0.0F)) continue;
        const double a = view.keypoints[2 * i + axis];
        const double b = view.truth.positions()[3 * i + axis] / view.truth.positions()[3 * i + 2];
        n += 1, sum_a += a, sum_b += b, aa += a * a, bb += b * b, ab += a * b;
      }
      const double covariance = ab / n - sum_a * sum_b / (n * n);
      const double variances = (aa / n - sum_a * sum_a / (n * n)) * (bb / n - sum_b * sum_b / (n * n));
      EXPECT_GT(covariance / std::sqrt(variances), 0.99) << "clip " << clip << " axis " << axis;
    }
  }
}

TEST(WildCapture, ALayoutsDerivedJointsAreMeansOfOthers) {
  WildCaptureOptions options = Small();
  options.layout = "coco-17";
  const Sequence clip = MakeWildClip(Human(), options, 3);
  const std::vector<float>& truth = clip.cameras[0].truth.positions();
  const auto at = [&](const char* joint, std::size_t c) {
    return truth[3 * static_cast<std::size_t>(Human().Find(joint).value()) + c];
  };
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(at("Hip", c), (at("LHip", c) + at("RHip", c)) / 2, 0.01);
    EXPECT_NEAR(at("Thorax", c), (at("LShoulder", c) + at("RShoulder", c)) / 2, 0.01);
  }
  options.layout = "coco-71";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { MakeWildClip(Human(), options, 3); }), HasSubstr("coco-17"));
}

TEST(WildCapture, UnknownJointsAreNeverSeen) {
  Skeleton skeleton = Human();
  skeleton.name = "";
  skeleton.joints.insert(skeleton.joints.begin() + 1, "tail");
  for (int& parent : skeleton.parents) parent += parent > 0 ? 1 : 0;
  for (int& mirror : skeleton.mirror) mirror += mirror > 0 ? 1 : 0;
  skeleton.parents.insert(skeleton.parents.begin() + 1, 0);
  skeleton.mirror.insert(skeleton.mirror.begin() + 1, 1);
  ASSERT_EQ(skeleton.Problem(), "");
  ASSERT_TRUE(IsKnownPerson(skeleton));
  EXPECT_EQ(KnownJointsOf(skeleton)[1], 0);
  const Sequence with = MakeWildClip(skeleton, Small(), 5);
  const Sequence without = MakeWildClip(Human(), Small(), 5);
  const CameraView& view = with.cameras[1];
  for (std::size_t t = 0; t < 12; ++t) {
    EXPECT_EQ(view.confidence[18 * t + 1], 0.0F);
    EXPECT_TRUE(std::isnan(view.keypoints[2 * (18 * t + 1)]));
    EXPECT_TRUE(std::isnan(view.truth.positions()[3 * (18 * t + 1)]));
    // The others are the same as without this joint.
    EXPECT_EQ(view.truth.positions()[3 * (18 * t + 2)], without.cameras[1].truth.positions()[3 * (17 * t + 1)]);
    EXPECT_EQ(view.confidence[18 * t + 17], without.cameras[1].confidence[17 * t + 16]);
  }
}

TEST(WildCapture, AnAnimalIsRefused) {
  Skeleton dog{"dog",
               {"withers", "tail", "left paw", "right paw", "left ear", "right ear"},
               {-1, 0, 0, 0, 0, 0},
               0,
               {0, 1, 3, 2, 5, 4}};
  ASSERT_EQ(dog.Problem(), "");
  EXPECT_FALSE(IsKnownPerson(dog));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { MakeWildClip(dog, Small(), 0); }), HasSubstr("withers"));
}

}  // namespace
}  // namespace canonpose
