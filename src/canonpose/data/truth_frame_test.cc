#include "canonpose/data/truth_frame.h"

#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/ring_testing.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::PersonInRing;

template <typename Change>
void ChangeTruth(CameraView& view, Change change) {
  std::vector<float>& truth = view.truth.positions();
  for (std::size_t i = 0; i < truth.size(); i += 3) {
    Eigen::Map<Eigen::Vector3f> point(&truth[i]);
    point = change(point.cast<double>().eval()).template cast<float>();
  }
}

std::string Refusal(const Dataset& dataset) {
  return ErrorOf(ErrorKind::kBadInput, [&] { RequireTruthInCameraFrame(dataset, "data.h5"); });
}

TEST(TruthFrame, TruthInTheCamerasFrameFits) {
  const Dataset dataset = PersonInRing();
  const TruthFrame frame = MeasureTruthFrame(dataset.sequences[0].cameras[0], 20, dataset.skeleton);
  EXPECT_LT(frame.misfit, 0.01);
  EXPECT_FALSE(frame.is_in_world());
  EXPECT_FALSE(frame.is_rotated());
  RequireTruthInCameraFrame(dataset, "data.h5");
}

TEST(TruthFrame, TruthThatIsCentredOnTheRootFits) {
  Dataset dataset = PersonInRing();
  for (CameraView& view : dataset.sequences[0].cameras) {
    std::vector<float>& truth = view.truth.positions();
    const std::vector<float> before = truth;
    for (std::size_t i = 0; i < truth.size(); ++i) truth[i] -= before[i / 51 * 51 + i % 3];
  }
  RequireTruthInCameraFrame(dataset, "data.h5");
}

TEST(TruthFrame, TruthInTheWorldIsRefused) {
  Dataset dataset = PersonInRing();
  for (CameraView& view : dataset.sequences[0].cameras) {
    const Camera camera = view.calibration.front();
    ChangeTruth(view, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
      return camera.camera_from_world_rotation.transpose() * (x - camera.camera_from_world_translation);
    });
  }
  EXPECT_THAT(Refusal(dataset), AllOf(HasSubstr("data.h5: /sequences/walk/cameras/c0/truth"), HasSubstr("the world's"),
                                      HasSubstr("R x + t")));
  // The keypoints alone show that it is rotated.
  for (CameraView& view : dataset.sequences[0].cameras) view.calibration.clear();
  EXPECT_THAT(Refusal(dataset), HasSubstr("rotated by"));
}

TEST(TruthFrame, TruthWithYUpIsRefused) {
  Dataset dataset = PersonInRing();
  for (CameraView& view : dataset.sequences[0].cameras) {
    ChangeTruth(view, [](const Eigen::Vector3d& x) -> Eigen::Vector3d { return {x.x(), -x.y(), -x.z()}; });
  }
  EXPECT_THAT(Refusal(dataset), HasSubstr("rotated by 1"));
}

TEST(TruthFrame, PosesThatHaveNothingToDoWithTheKeypointsAreLeftAlone) {
  Dataset dataset = PersonInRing();
  Rng rng(2);
  for (float& value : dataset.sequences[0].cameras[0].truth.positions())
    value += static_cast<float>(1000.0 * rng.Normal());
  RequireTruthInCameraFrame(dataset, "data.h5");
}

}  // namespace
}  // namespace canonpose
