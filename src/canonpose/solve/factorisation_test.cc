#include "canonpose/solve/factorisation.h"

#include <array>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/error.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/rotation_averaging.h"
#include "canonpose/solve/solve_testing.h"
#include "canonpose/solve/solver.h"

namespace canonpose {
namespace {

using ::testing::HasSubstr;

StartPoses NoPoses(const Dataset& dataset) {
  StartPoses none;
  for (const Sequence& sequence : dataset.sequences) none.sequences.emplace_back(sequence.cameras.size());
  return none;
}

Dataset Filmed(const std::string& rig, int cameras, const std::string& spread, double noise) {
  SimulationOptions options = testing::SmallSimulation();
  options.rig.kind = rig;
  options.rig.cameras = cameras;
  options.rig.spread = spread;
  options.detector.noise = noise;
  return testing::Simulate(options).dataset;
}

/// The largest error of a relative rotation, in degrees, of the cameras or of their mirror, whichever is nearer.
double RotationErrorDeg(const Dataset& dataset, const std::vector<Eigen::Matrix3d>& found) {
  std::array<double, 2> largest = {0.0, 0.0};
  for (std::size_t a = 0; a < found.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const auto truth = [&](std::size_t v) {
        return dataset.sequences[0].cameras[v].calibration[0].camera_from_world_rotation;
      };
      const Eigen::Matrix3d expected = truth(a) * truth(b).transpose();
      const Eigen::Matrix3d right = found[a] * found[b].transpose();
      largest[0] = std::max(largest[0], RotationAngle(right, expected));
      largest[1] = std::max(largest[1], RotationAngle(MirrorRotation(right), expected));
    }
  }
  return DegFromRad(std::min(largest[0], largest[1]));
}

struct Rig {
  const char* kind;
  int cameras;
  const char* spread;
  double noise;
  double most_error_deg;  ///< not 0 without noise: perspective is neglected
};

class FactorisedRigs : public ::testing::TestWithParam<Rig> {};

TEST_P(FactorisedRigs, HaveTheRightRotationsUpToTheMirror) {
  const Rig& rig = GetParam();
  const Dataset dataset = Filmed(rig.kind, rig.cameras, rig.spread, rig.noise);
  const auto captures = CollectCaptures(dataset, NoPoses(dataset));
  const Factorisation found = Factorise(captures[0]);
  const double error = RotationErrorDeg(dataset, found.camera_from_world);
  RecordProperty("error_deg", std::to_string(error));
  EXPECT_LT(error, rig.most_error_deg);
}

INSTANTIATE_TEST_SUITE_P(All, FactorisedRigs,
                         ::testing::Values(Rig{"studio", 4, "even", 0.0, 15.0}, Rig{"studio", 4, "even", 1.0, 15.0},
                                           Rig{"studio", 4, "quarter", 1.0, 15.0}, Rig{"ring", 6, "even", 1.0, 15.0},
                                           Rig{"studio", 2, "quarter", 1.0, 20.0}));

TEST(Factorisation, LeadsTheSolverToTheTruth) {
  CANONPOSE_SKIP_UNDER_SANITIZERS();
  for (const char* spread : {"even", "quarter"}) {
    Dataset dataset = Filmed("studio", 4, spread, 1.0);
    const SolveReport report = Solve(dataset, FactorisedStart(dataset, "walk.h5"), {});
    EXPECT_EQ(report.captures[0].failure, "");
    EXPECT_THAT(report.captures[0].mirror, ::testing::AnyOf("kept", "flipped"));
    std::vector<Eigen::Matrix3d> found;
    for (const CameraView& view : dataset.sequences[0].cameras) {
      ASSERT_FALSE(view.solved_calibration.empty());
      found.push_back(view.solved_calibration[0].camera_from_world_rotation);
    }
    const auto truth = [&](std::size_t v) {
      return dataset.sequences[0].cameras[v].calibration[0].camera_from_world_rotation;
    };
    // Not the mirror: perspective decides.
    for (std::size_t v = 1; v < 4; ++v) {
      EXPECT_LT(RotationAngle(found[v] * found[0].transpose(), truth(v) * truth(0).transpose()), 0.07) << spread << v;
    }
  }
}

TEST(Factorisation, RefusesMovingCameras) {
  const Dataset dataset = Filmed("ptz", 4, "even", 1.0);
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { FactorisedStart(dataset, "ski.h5"); }),
              HasSubstr("static cameras"));
}

/// Seen from far away, a pose's x and y are the keypoints about the root, but for one factor.
TEST(Factorisation, GivesPosesOfTheDatasetsJointsWhereAJointIsNeverSeen) {
  Dataset dataset = Filmed("studio", 4, "even", 0.0);
  const auto joints = static_cast<std::size_t>(dataset.skeleton.joint_count());
  const auto unseen = static_cast<std::size_t>(joints / 2);
  ASSERT_NE(static_cast<int>(unseen), dataset.skeleton.root);
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      for (std::size_t i = unseen; i < view.confidence.size(); i += joints) view.confidence[i] = 0.0F;
    }
  }
  const StartPoses start = FactorisedStart(dataset, "walk.h5");
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    const CameraView& view = dataset.sequences[s].cameras[0];
    const std::vector<float>& poses = start.sequences[s][0].positions();
    ASSERT_EQ(poses.size(), 3 * view.confidence.size());
    int known = 0;
    for (std::size_t first = 0; first < view.confidence.size(); first += joints) {
      double together = 0.0;
      double of_keypoints = 0.0;
      double of_poses = 0.0;
      const std::size_t root = first + static_cast<std::size_t>(dataset.skeleton.root);
      EXPECT_FALSE(std::isfinite(poses[3 * (first + unseen)]));
      for (std::size_t i = first; i < first + joints; ++i) {
        if (!(view.confidence[i] > 0.0F) || !(view.confidence[root] > 0.0F) || !std::isfinite(poses[3 * i])) continue;
        for (std::size_t axis = 0; axis < 2; ++axis) {
          const double keypoint = view.keypoints[2 * i + axis] - view.keypoints[2 * root + axis];
          const double pose = poses[3 * i + axis];
          together += keypoint * pose;
          of_keypoints += keypoint * keypoint;
          of_poses += pose * pose;
        }
      }
      if (!(of_poses > 0.0)) continue;
      ++known;
      EXPECT_GT(together, 0.9 * std::sqrt(of_keypoints * of_poses)) << first / joints;
    }
    EXPECT_GT(known, 100);
  }
}

TEST(Factorisation, OfTooLittleIsUnknown) {
  Dataset dataset = Filmed("studio", 2, "even", 1.0);
  for (Sequence& sequence : dataset.sequences) {
    for (float& confidence : sequence.cameras[0].confidence) confidence = 0.0F;
  }
  const auto captures = CollectCaptures(dataset, NoPoses(dataset));
  for (const Eigen::Vector3d& joint : Factorise(captures[0]).joints) ASSERT_FALSE(joint.allFinite());
}

}  // namespace
}  // namespace canonpose
