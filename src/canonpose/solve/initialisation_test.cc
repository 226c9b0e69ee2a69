#include "canonpose/solve/initialisation.h"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/solve/exact_rig_testing.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/rotation_averaging.h"

namespace canonpose {
namespace {

using testing::ExactRig;
using testing::ExactRigOptions;
using testing::Hide;
using testing::MakeExactRig;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::vector<Eigen::Matrix3d> RotationsIn(const RigEstimate& estimate, int frame) {
  std::vector<Eigen::Matrix3d> rotations;
  for (int v = 0; v < estimate.view_count; ++v) rotations.push_back(estimate.CameraAt(frame, v).Rotation());
  return rotations;
}

/// The truth's joints about the root, (J, 3).
Points3d TruthAboutRoot(const ExactRig& rig, int frame) {
  Points3d joints(rig.capture.joint_count(), 3);
  for (int j = 0; j < rig.capture.joint_count(); ++j) {
    joints.row(j) = (rig.truth.Joint(frame, j) - rig.truth.Joint(frame, rig.capture.skeleton.root)).transpose();
  }
  return joints;
}

/// Cameras so far away that perspective is next to nothing.
ExactRig FarAway() {
  ExactRigOptions options;
  options.distance = 100.0;
  options.log_focal = std::log(100.0 / 1.2);
  return MakeExactRig(options);
}

TEST(MirrorRotation, ProjectsTheMirroredPoseLikeThePose) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  const Eigen::Matrix3d mirrored = MirrorRotation(rotation);
  EXPECT_NEAR(mirrored.determinant(), 1.0, 1e-12);
  EXPECT_TRUE((mirrored * mirrored.transpose()).isIdentity(1e-12));
  EXPECT_TRUE(MirrorRotation(mirrored).isApprox(rotation, 1e-12));
  const Eigen::Vector3d joint(0.1, 0.4, -0.3);
  const Eigen::Vector3d here = rotation * joint;
  const Eigen::Vector3d there = mirrored * Eigen::Vector3d(0.1, 0.4, 0.3);
  EXPECT_TRUE(there.isApprox(Eigen::Vector3d(here.x(), here.y(), -here.z()), 1e-12));
}

TEST(ShapeFromViews, IsTheTruthUnderOrthography) {
  const ExactRig rig = FarAway();
  const FrameShape shape = ShapeFromViews(rig.capture, 3, RotationsIn(rig.truth, 3), false);
  ASSERT_TRUE(shape.valid);
  EXPECT_LT((shape.joints - TruthAboutRoot(rig, 3)).rowwise().norm().maxCoeff(), 1e-3);
  for (int v = 0; v < rig.capture.view_count(); ++v) {
    EXPECT_NEAR(shape.scales[static_cast<std::size_t>(v)], rig.truth.ImageScale(3, v, rig.capture.skeleton.root), 0.005)
        << v;
  }
}

TEST(ShapeFromViews, FillsInWhatNobodySeesFromTheStart) {
  ExactRig rig = FarAway();
  for (int v = 0; v < rig.capture.view_count(); ++v) Hide(rig.capture, 3, v, 6);
  const FrameShape shape = ShapeFromViews(rig.capture, 3, RotationsIn(rig.truth, 3), false);
  ASSERT_TRUE(shape.valid);
  // The start has another size than the keypoints give the rest; its direction is right.
  const Eigen::Vector3d found = shape.joints.row(6).transpose();
  const Eigen::Vector3d truth = TruthAboutRoot(rig, 3).row(6).transpose();
  EXPECT_GT(found.normalized().dot(truth.normalized()), 0.999);
}

TEST(ShapeFromViews, OfTheMirroredStartIsTheMirror) {
  const ExactRig rig = FarAway();
  std::vector<Eigen::Matrix3d> mirrored = RotationsIn(rig.truth, 3);
  std::ranges::transform(mirrored, mirrored.begin(), MirrorRotation);
  const FrameShape shape = ShapeFromViews(rig.capture, 3, mirrored, true);
  ASSERT_TRUE(shape.valid);
  Points3d truth = TruthAboutRoot(rig, 3);
  truth.col(2) *= -1.0;
  EXPECT_LT((shape.joints - truth).rowwise().norm().maxCoeff(), 1e-3);
}

TEST(ShapeFromViews, NeedsTwoViewsThatDoNotContradictEachOther) {
  ExactRig rig = FarAway();
  std::vector<Eigen::Matrix3d> rotations = RotationsIn(rig.truth, 3);
  for (std::size_t v = 1; v < rotations.size(); ++v) rotations[v].setConstant(kNaN);
  EXPECT_FALSE(ShapeFromViews(rig.capture, 3, rotations, false).valid);
  // Half a turn of one view about its viewing axis: its joints would have to be on the other side of the root.
  rotations = RotationsIn(rig.truth, 3);
  rotations[1] = Eigen::Vector3d(-1, -1, 1).asDiagonal() * rotations[1];
  EXPECT_FALSE(ShapeFromViews(rig.capture, 3, rotations, false).valid);
}

TEST(InitialiseStatic, IsNearTheTruth) {
  const ExactRig rig = MakeExactRig();
  const std::vector<int> frames = {0, 7, 14, 21, 28};
  const RigEstimate estimate = InitialiseStatic(rig.capture, frames, RotationsIn(rig.truth, 0), false);
  // The world is that of the first camera but for its rotation. Perspective makes some per cent of error.
  const auto centre = [](const RigEstimate& of, int v) {
    return Eigen::Vector3d(-of.CameraAt(0, v).Rotation().transpose() * of.Translation(0, v));
  };
  for (int v = 0; v < rig.capture.view_count(); ++v) {
    ASSERT_TRUE(estimate.CameraAt(0, v).valid) << v;
    EXPECT_LT(RotationAngle(estimate.CameraAt(0, v).Rotation(), rig.truth.CameraAt(0, v).Rotation()), 1e-9) << v;
    const Eigen::Vector3d expected = centre(rig.truth, v) - centre(rig.truth, 0);
    EXPECT_LT((centre(estimate, v) - centre(estimate, 0) - expected).norm(), 0.15) << v;
  }
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    const bool is_chosen = std::ranges::count(frames, n) > 0;
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      ASSERT_EQ(estimate.Joint(n, j).allFinite(), is_chosen) << n;
      if (!is_chosen) continue;
      ASSERT_LT((estimate.Project(n, 0, j) - rig.truth.Project(n, 0, j)).norm(), 0.05) << n << ' ' << j;
    }
  }
  for (int j = 1; j < rig.capture.joint_count(); ++j) {
    EXPECT_NEAR(estimate.log_bone_lengths[0][static_cast<std::size_t>(j)],
                rig.truth.log_bone_lengths[0][static_cast<std::size_t>(j)], 0.2)
        << j;
  }
}

TEST(InitialiseStatic, ComparesTheSizesOfSeveralPeople) {
  // The start's poses have no size: a child is taken for as large as an adult, and placed too far from every camera.
  ExactRigOptions options;
  options.clips = 2;
  ExactRig rig = MakeExactRig(options);
  rig.capture.subjects = {"child", "adult"};
  rig.capture.clips[1].subject = 1;
  for (int n = 0; n < options.frames; ++n) {
    const Eigen::Vector3d root = rig.truth.Joint(n, rig.capture.skeleton.root);
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      rig.truth.Joint(n, j) = root + 0.7 * (rig.truth.Joint(n, j) - root);
    }
  }
  testing::SeeJoints(rig.truth, 0.0, 0, rig.capture);
  const std::vector<int> frames = {0, 7, 14, 21, 28, 40, 47, 54, 61, 68};
  const RigEstimate estimate = InitialiseStatic(rig.capture, frames, RotationsIn(rig.truth, 0), false);
  for (std::size_t j = 1; j < estimate.log_bone_lengths[0].size(); ++j) {
    EXPECT_NEAR(estimate.log_bone_lengths[1][j] - estimate.log_bone_lengths[0][j], -std::log(0.7), 0.06) << j;
  }
}

TEST(InitialiseStatic, LeavesCamerasOutThatNothingTiesToTheOthers) {
  ExactRig rig = MakeExactRig();
  std::vector<Eigen::Matrix3d> rotations = RotationsIn(rig.truth, 0);
  rotations[1].setConstant(kNaN);
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    for (int j = 0; j < rig.capture.joint_count(); ++j) Hide(rig.capture, n, 3, j);
  }
  const RigEstimate estimate =
      InitialiseStatic(rig.capture, ConsecutiveFrames(0, rig.capture.frame_count), rotations, false);
  EXPECT_THAT(estimate.ValidViews(0), ::testing::ElementsAre(0, 2));
}

TEST(InitialiseMoving, IsNearTheTruthWhereTwoViewsWereLifted) {
  ExactRigOptions options;
  options.static_cameras = false;
  ExactRig rig = MakeExactRig(options);
  for (int v = 1; v < rig.capture.view_count(); ++v) Hide(rig.capture, 9, v, rig.capture.skeleton.root);
  std::vector<std::vector<Eigen::Matrix3d>> rotations;
  for (int n = 0; n < rig.capture.frame_count; ++n) rotations.push_back(RotationsIn(rig.truth, n));
  const RigEstimate estimate =
      InitialiseMoving(rig.capture, ConsecutiveFrames(0, rig.capture.frame_count), rotations, false);
  const int root = rig.capture.skeleton.root;
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    for (int v = 0; v < rig.capture.view_count(); ++v) {
      ASSERT_EQ(estimate.CameraAt(n, v).valid, n != 9) << n << ' ' << v;
      if (n == 9) continue;
      EXPECT_LT((estimate.Project(n, v, root) - rig.truth.Project(n, v, root)).norm(), 1e-6) << n << ' ' << v;
      EXPECT_NEAR(estimate.CameraAt(n, v).placement[2], rig.truth.CameraAt(n, v).placement[2], 0.15) << n << ' ' << v;
      for (int j = 0; j < rig.capture.joint_count(); ++j) {
        ASSERT_LT((estimate.Project(n, v, j) - rig.truth.Project(n, v, j)).norm(), 0.05) << n << ' ' << v << ' ' << j;
      }
    }
    ASSERT_EQ(estimate.Joint(n, root).allFinite(), n != 9) << n;
  }
}

TEST(TriangulateJoint, IsExactOfExactKeypoints) {
  const ExactRig rig = MakeExactRig();
  for (int j = 0; j < rig.capture.joint_count(); ++j) {
    const RobustPoint found = TriangulateJoint(rig.capture, 8, j, {}, rig.truth);
    EXPECT_LT((found.point - rig.truth.Joint(8, j)).norm(), 1e-6) << j;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(found.information).eigenvalues()[0], 0.0) << j;
  }
}

TEST(TriangulateJoint, NeedsTwoViews) {
  ExactRig rig = MakeExactRig();
  for (int v = 1; v < rig.capture.view_count(); ++v) Hide(rig.capture, 8, v, 4);
  EXPECT_FALSE(TriangulateJoint(rig.capture, 8, 4, {}, rig.truth).point.allFinite());
}

TEST(TriangulateJoint, ABadViewCountsLittleAndOneLeftOutNothing) {
  ExactRig rig = MakeExactRig();
  rig.capture.xy[2 * rig.capture.Index(8, 2, 4)] += 0.3F;
  EXPECT_LT((TriangulateJoint(rig.capture, 8, 4, {}, rig.truth).point - rig.truth.Joint(8, 4)).norm(), 0.02);
  EXPECT_LT((TriangulateJoint(rig.capture, 8, 4, {}, rig.truth, 2).point - rig.truth.Joint(8, 4)).norm(), 1e-6);
}

TEST(TriangulateFrame, PutsWhatOneViewSeesBesideItsParent) {
  ExactRig rig = MakeExactRig();
  const int joint = *rig.capture.skeleton.Find("lwrist");
  const int nobody = *rig.capture.skeleton.Find("rwrist");
  for (int v = 0; v < rig.capture.view_count(); ++v) {
    if (v != 1) Hide(rig.capture, 8, v, joint);
    Hide(rig.capture, 8, v, nobody);
  }
  RigEstimate estimate = rig.truth;
  for (int j = 0; j < rig.capture.joint_count(); ++j) estimate.Joint(8, j).setConstant(9.0);
  TriangulateFrame(rig.capture, 8, {}, false, estimate);
  for (int j = 0; j < rig.capture.joint_count(); ++j) {
    if (j == nobody) {
      EXPECT_FALSE(estimate.Joint(8, j).allFinite());
    } else {
      EXPECT_LT((estimate.Joint(8, j) - rig.truth.Joint(8, j)).norm(), 1e-5) << rig.capture.skeleton.joints[j];
    }
  }
}

TEST(TriangulateFrame, TakesTheDirectionBetweenOppositeViewsFromTheStart) {
  ExactRigOptions options;
  options.views = 2;
  ExactRig rig = MakeExactRig(options);
  // The second camera is opposite the first but for 4 degrees.
  rig.truth.cameras[1] = rig.truth.cameras[0];
  const Eigen::Vector3d axis = rig.truth.cameras[0].Rotation().row(1).transpose();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(176.0 * M_PI / 180.0, axis).toRotationMatrix();
  rig.truth.cameras[1].SetRotation(rig.truth.cameras[0].Rotation() * turn.transpose());
  constexpr double kNoise = 0.004;
  testing::SeeJoints(rig.truth, kNoise, 9, rig.capture);
  AdjustmentScales scales;
  scales.observation = NoiseModel(kNoise);
  double alone = 0.0;
  double steadied = 0.0;
  RigEstimate estimate = rig.truth;
  const int root = rig.capture.skeleton.root;
  for (int n = 0; n < rig.capture.frame_count; ++n) {
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      const Eigen::Vector3d seen = rig.truth.InCamera(n, 1, j) - rig.truth.InCamera(n, 1, root);
      Eigen::Vector3f::Map(&rig.capture.start[3 * rig.capture.Index(n, 1, j)]) = seen.cast<float>();
    }
    TriangulateFrame(rig.capture, n, scales, false, estimate);
    const Eigen::Vector3d root_alone = TriangulateJoint(rig.capture, n, root, scales, rig.truth).point;
    for (int j = 0; j < rig.capture.joint_count(); ++j) {
      const Eigen::Vector3d truth = rig.truth.Joint(n, j) - rig.truth.Joint(n, root);
      const Eigen::Vector3d joint_alone = TriangulateJoint(rig.capture, n, j, scales, rig.truth).point;
      alone += (joint_alone - root_alone - truth).norm();
      steadied += (estimate.Joint(n, j) - estimate.Joint(n, root) - truth).norm();
    }
  }
  EXPECT_LT(steadied, 0.5 * alone);
}

TEST(MeasureBones, TakesEachSubjectsMedians) {
  ExactRigOptions options;
  options.clips = 2;
  options.frames = 5;
  ExactRig rig = MakeExactRig(options);
  rig.capture.subjects = {"child", "adult"};
  rig.capture.clips[1].subject = 1;
  RigEstimate estimate = rig.truth;
  estimate.log_bone_lengths.assign(2, std::vector<double>(static_cast<std::size_t>(estimate.joint_count), kNaN));
  for (int n = 5; n < 10; ++n) {
    for (int j = 0; j < estimate.joint_count; ++j) estimate.Joint(n, j) *= 2.0;
  }
  estimate.Joint(2, 3).setConstant(50.0);  // an outlier
  for (int n = 5; n < 10; ++n) estimate.Joint(n, 6).setConstant(kNaN);
  MeasureBones(rig.capture, ConsecutiveFrames(0, 10), estimate);
  for (std::size_t j = 1; j < estimate.log_bone_lengths[0].size(); ++j) {
    const double truth = rig.truth.log_bone_lengths[0][j];
    EXPECT_NEAR(estimate.log_bone_lengths[0][j], truth, 1e-6) << j;
    const bool ends_unknown = j == 6 || rig.capture.skeleton.parents[j] == 6;
    if (ends_unknown) {
      EXPECT_TRUE(std::isnan(estimate.log_bone_lengths[1][j])) << j;
    } else {
      EXPECT_NEAR(estimate.log_bone_lengths[1][j], truth + std::log(2.0), 1e-6) << j;
    }
  }
  EXPECT_TRUE(std::isnan(estimate.log_bone_lengths[0][static_cast<std::size_t>(rig.capture.skeleton.root)]));
}

}  // namespace
}  // namespace canonpose
