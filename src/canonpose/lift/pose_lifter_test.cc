#include "canonpose/lift/pose_lifter.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/geometry/viewing_ray.h"
#include "canonpose/model/tensors.h"
#include "canonpose/skeleton/anthropometry.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr int kFrames = 5;
constexpr int kJoints = 17;

CameraView RandomView(std::uint64_t seed) {
  Rng rng(seed);
  CameraView view;
  for (int i = 0; i < kFrames * kJoints; ++i) {
    view.keypoints.push_back(static_cast<float>(rng.Uniform(0, 1000)));
    view.keypoints.push_back(static_cast<float>(rng.Uniform(0, 1000)));
    view.confidence.push_back(static_cast<float>(rng.Uniform(0.5, 1)));
  }
  return view;
}

std::filesystem::path WriteModel(const TemporaryFolder& folder, const InputForm& input = {}) {
  ModelFile model;
  model.info.input = input;
  model.info.skeleton = *FindSkeleton("h36m-17");
  model.info.width = 24;
  Lifter lifter(kJoints, 24);
  lifter->Initialise(3);
  model.parameters = ParametersOf(*lifter);
  WriteModelFile(folder / "model.cpm", model);
  return folder / "model.cpm";
}

TEST(PoseLifter, PoseIsRotationTimesCanonicalAndRootIsTheOrigin) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder));
  const LiftedPoses lifted = lifter.Lift(RandomView(1), kFrames);
  for (std::size_t t = 0; t < kFrames; ++t) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double turned = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
          turned += static_cast<double>(lifted.rotation[t * 9 + axis * 3 + k]) *
                    lifted.canonical.positions()[(t * kJoints + j) * 3 + k];
        }
        EXPECT_NEAR(lifted.pose_in_camera.positions()[(t * kJoints + j) * 3 + axis], turned, 1e-5);
        if (j == 0) {
          EXPECT_EQ(lifted.pose_in_camera.positions()[t * kJoints * 3 + axis], 0.0F);
        }
      }
    }
  }
}

TEST(PoseLifter, DoesNotDependOnWhereAndHowLargeThePersonIs) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder));
  const CameraView view = RandomView(2);
  CameraView moved = view;
  for (std::size_t i = 0; i < moved.keypoints.size(); ++i)
    moved.keypoints[i] = 0.5F * moved.keypoints[i] + (i % 2 == 0 ? 300.0F : -20.0F);
  const LiftedPoses a = lifter.Lift(view, kFrames);
  const LiftedPoses b = lifter.Lift(moved, kFrames);
  for (std::size_t i = 0; i < a.pose_in_camera.positions().size(); ++i) {
    EXPECT_NEAR(a.pose_in_camera.positions()[i], b.pose_in_camera.positions()[i], 1e-4);
  }
}

TEST(PoseLifter, WithTheRayOnTheAxisThePoseIsThatOfACameraLookingStraightTurnedBack) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder, {RayForm::kRoot, FocalSource::kKnown}));
  CameraView view = RandomView(4);
  Camera camera;
  camera.K << 900, 0, 500, 0, 900, 500, 0, 0, 1;
  view.calibration = {camera};
  const LiftedPoses a = lifter.Lift(view, kFrames);
  // The same rays seen by a camera that looks straight at the person: the network sees the same there and here.
  for (std::size_t t = 0; t < kFrames; ++t) {
    const std::size_t root = t * kJoints + static_cast<std::size_t>(lifter.skeleton().root);
    const Eigen::Vector3d ray((view.keypoints[2 * root] - 500) / 900, (view.keypoints[2 * root + 1] - 500) / 900, 1.0);
    const Eigen::Matrix3d onto_axis = RotationOntoAxis(ray);
    CameraView straight = view;
    for (std::size_t i = 0; i < view.confidence.size(); ++i) {
      const Eigen::Vector3d seen = onto_axis * Eigen::Vector3d((view.keypoints[2 * i] - 500) / 900,
                                                               (view.keypoints[2 * i + 1] - 500) / 900, 1.0);
      straight.keypoints[2 * i] = static_cast<float>(500 + 900 * seen.x() / seen.z());
      straight.keypoints[2 * i + 1] = static_cast<float>(500 + 900 * seen.y() / seen.z());
    }
    const LiftedPoses on_axis = lifter.Lift(straight, kFrames);
    const auto matrix = [&](const LiftedPoses& poses) {
      return Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(&poses.rotation[9 * t]).cast<double>();
    };
    EXPECT_NEAR((matrix(a) - onto_axis.transpose() * matrix(on_axis)).norm(), 0.0, 1e-4);
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto joint = [&](const PoseSequence& poses) -> Eigen::Vector3d {
        return poses.PoseAt(static_cast<int>(t)).row(static_cast<Eigen::Index>(j)).transpose().cast<double>();
      };
      EXPECT_NEAR((joint(a.pose_in_camera) - onto_axis.transpose() * joint(on_axis.pose_in_camera)).norm(), 0.0, 1e-4);
      EXPECT_NEAR((joint(a.pose_in_camera) - matrix(a) * joint(a.canonical)).norm(), 0.0, 1e-5);
    }
  }
}

TEST(PoseLifter, FramesWithoutAPersonStayMissing) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder));
  CameraView view = RandomView(3);
  for (int j = 0; j < kJoints; ++j) view.confidence[2 * kJoints + j] = 0.0F;
  const LiftedPoses lifted = lifter.Lift(view, kFrames);
  EXPECT_TRUE(std::isnan(lifted.pose_in_camera.positions()[2 * kJoints * 3]));
  EXPECT_TRUE(std::isnan(lifted.rotation[2 * 9]));
  EXPECT_FALSE(std::isnan(lifted.pose_in_camera.positions()[3 * kJoints * 3]));
  EXPECT_EQ(lifted.pose_in_camera.confidence()[2 * kJoints], 0.0F);
  EXPECT_EQ(lifted.canonical.confidence()[3 * kJoints], view.confidence[3 * kJoints]);
}

TEST(PoseLifter, AJointThatTheViewDoesNotShowIsAGuessUntilItIsHidden) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder));
  CameraView view = RandomView(6);
  constexpr std::size_t kHidden = 1 * kJoints + 13;
  view.confidence[kHidden] = 0.0F;
  view.keypoints[2 * kHidden] = view.keypoints[2 * kHidden + 1] = NAN;
  LiftedPoses lifted = lifter.Lift(view, kFrames);
  EXPECT_TRUE(lifted.pose_in_camera.IsKnown(1, 13));
  EXPECT_EQ(lifted.pose_in_camera.confidence()[kHidden], 0.0F);
  EXPECT_EQ(lifted.pose_in_camera.confidence()[kHidden - 1], view.confidence[kHidden - 1]);
  lifted.HideUnseenJoints();
  EXPECT_FALSE(lifted.pose_in_camera.IsKnown(1, 13));
  EXPECT_FALSE(lifted.canonical.IsKnown(1, 13));
  EXPECT_TRUE(lifted.pose_in_camera.IsKnown(1, 12));
  EXPECT_TRUE(lifted.pose_in_camera.IsKnown(2, 13));
}

TEST(PoseLifter, AModelThatNeedsTheImageSizeAsksForIt) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder, {RayForm::kRoot, FocalSource::kGuess}));
  CameraView view = RandomView(7);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { lifter.RequireImageSize(view, "keypoints"); }),
              AllOf(HasSubstr("keypoints: expected the image size"), HasSubstr("`image_size`")));
  view.image_size = {1000, 1000};
  lifter.RequireImageSize(view, "keypoints");
}

TEST(ScaleToHeight, TakesAStatureInMetres) {
  RequireHeight(1.75);
  for (const auto& [height, advice] :
       {std::pair(175.0, "centimetres, give 1.75"), {1750.0, "millimetres, give 1.75"}}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { RequireHeight(height); }),
                AllOf(HasSubstr("`height`: expected the person's height in metres"), HasSubstr(advice)));
  }
  ErrorOf(ErrorKind::kInvalidArgument, [] { RequireHeight(-1.0); });
  ErrorOf(ErrorKind::kInvalidArgument, [] { RequireHeight(NAN); });
}

TEST(PoseLifter, SaysWhatItsCoordinatesMean) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder));
  CameraView view = RandomView(5);
  view.name = "front";
  const LiftedPoses lifted = lifter.Lift(view, kFrames);
  EXPECT_EQ(lifted.pose_in_camera.unit, LengthUnit::kEachItsOwn);
  EXPECT_EQ(lifted.pose_in_camera.coordinate_frame, (CoordinateFrame{CoordinateFrame::Kind::kRoot, "front"}));
  EXPECT_EQ(lifted.canonical.coordinate_frame.kind, CoordinateFrame::Kind::kBody);
  EXPECT_EQ(lifted.frames, (std::vector<std::int64_t>{0, 1, 2, 3, 4}));
  EXPECT_TRUE(lifted.skeleton().SameJoints(lifter.skeleton()));
}

TEST(PoseLifter, RefusesAnotherSkeleton) {
  const TemporaryFolder folder;
  const PoseLifter lifter = PoseLifter::Open(WriteModel(folder));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { lifter.RequireSkeleton(*FindSkeleton("coco-17"), "data.h5"); }),
              AllOf(HasSubstr("data.h5"), HasSubstr("Hip"), HasSubstr("LEye")));
}

TEST(ScaleToHeight, AStandingFigureGetsItsStature) {
  const Skeleton& skeleton = *FindSkeleton("h36m-17");
  // A stick figure: ankles 39 mm, head top 1000 mm above ground, in arbitrary units; every path straight up.
  LiftedPoses poses(skeleton, 1, "front");
  std::vector<float>& pose = poses.pose_in_camera.positions();
  pose.assign(kJoints * 3, 0.0F);
  const auto put = [&](const char* name, float x, float up) {
    const int j = *skeleton.Find(name);
    pose[3 * static_cast<std::size_t>(j)] = x;
    pose[3 * static_cast<std::size_t>(j) + 1] = -up;
  };
  for (const auto& [name, up] : std::initializer_list<std::pair<const char*, float>>{{"Hip", 530},
                                                                                     {"Spine", 650},
                                                                                     {"Thorax", 800},
                                                                                     {"Nose", 900},
                                                                                     {"Head", 1000},
                                                                                     {"LHip", 530},
                                                                                     {"RHip", 530},
                                                                                     {"LKnee", 285},
                                                                                     {"RKnee", 285},
                                                                                     {"LFoot", 39},
                                                                                     {"RFoot", 39},
                                                                                     {"LShoulder", 800},
                                                                                     {"RShoulder", 800},
                                                                                     {"LElbow", 600},
                                                                                     {"RElbow", 600},
                                                                                     {"LWrist", 400},
                                                                                     {"RWrist", 400}}) {
    put(name, 0.0F, up);
  }
  poses.canonical = poses.pose_in_camera;
  for (float& value : pose) value *= 0.01F;
  ScaleToHeight(poses, 1800.0);
  const auto up = [&](const char* name) { return -poses.pose_in_camera.PoseAt(0)(*skeleton.Find(name), 1); };
  EXPECT_NEAR(up("Head") - up("LFoot"), 1800.0 * 0.961, 1.0);
  EXPECT_EQ(poses.pose_in_camera.unit, LengthUnit::kMillimetres);
  EXPECT_EQ(poses.canonical.unit, LengthUnit::kMillimetres);
}

}  // namespace
}  // namespace canonpose
