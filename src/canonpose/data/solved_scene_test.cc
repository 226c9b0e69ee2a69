#include "canonpose/data/solved_scene.h"

#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;

/// Two joints at known places of the world, in two frames, as two solved cameras have them and a third does not.
Dataset Solved(const Eigen::Matrix<float, 4, 3>& in_world) {
  Dataset dataset;
  dataset.skeleton = {"", {"root", "tip"}, {-1, 0}, 0, {0, 1}};
  Sequence& sequence = dataset.sequences.emplace_back();
  sequence.name = "clip";
  sequence.subject = "her";
  sequence.fps = 25.0;
  sequence.frame_count = 2;
  for (int c = 0; c < 3; ++c) {
    CameraView& view = sequence.cameras.emplace_back();
    view.name = "cam" + std::to_string(c);
    view.image_size = {640, 480};
    view.keypoints.assign(8, 1.0F);
    view.confidence.assign(4, 0.25F * static_cast<float>(c));
    if (c == 2) continue;
    Camera camera;
    camera.camera_from_world_rotation = Eigen::AngleAxisd(0.5 + c, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
    camera.camera_from_world_translation = Eigen::Vector3d(0.1, 0.2, 3.0 + c);
    view.solved_calibration = {camera};
    std::vector<float> solved;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d in_camera = camera.InCamera(in_world.row(i).transpose().cast<double>());
      for (int axis = 0; axis < 3; ++axis) solved.push_back(static_cast<float>(in_camera[axis]));
    }
    view.solved = PosesInCamera(dataset.skeleton, solved, LengthUnit::kBodyLengths, view.name);
    view.solved.standard_deviation().assign(4, 0.01F);
  }
  // The first camera lost a joint that the second has.
  for (std::size_t i = 3; i < 6; ++i) sequence.cameras[0].solved.positions()[i] = std::nanf("");
  return dataset;
}

TEST(SceneOfSolved, PutsThePersonIntoTheWorldOfTheCameras) {
  Eigen::Matrix<float, 4, 3> in_world;
  in_world << 0, 0, 0, 0.1F, 0.2F, 0.3F, 1, 0, 0, 1.1F, 0.2F, 0.3F;
  const Dataset dataset = Solved(in_world);
  const Scene scene = SceneOfSolved(dataset, dataset.sequences[0], "solved.h5");
  EXPECT_NO_THROW(scene.Validate());
  ASSERT_EQ(scene.people.size(), 1U);
  const PoseSequence& person = scene.people[0];
  EXPECT_EQ(person.name, "her");
  EXPECT_EQ(person.unit, LengthUnit::kBodyLengths);
  for (int t = 0; t < 2; ++t) {
    EXPECT_LT((person.PoseAt(t) - in_world.middleRows(2 * t, 2)).cwiseAbs().maxCoeff(), 1e-6F) << t;
  }
  EXPECT_EQ(person.confidence()[0], 0.5F);
  EXPECT_EQ(person.standard_deviation()[1], 0.01F);
  ASSERT_EQ(scene.cameras.size(), 3U);
  EXPECT_TRUE(scene.cameras[0].used);
  EXPECT_FALSE(scene.cameras[2].used);
  EXPECT_FALSE(scene.up.is_known());
}

TEST(SceneOfSolved, TakesPosesAtTheTimeOfTheOtherCameras) {
  Eigen::Matrix<float, 4, 3> in_world;
  in_world << 0, 0, 0, 0.1F, 0.2F, 0.3F, 1, 0, 0, 1.1F, 0.2F, 0.3F;
  const auto first_pose_is_late = [&](Dataset dataset) {
    const Scene scene = SceneOfSolved(dataset, dataset.sequences[0], "solved.h5");
    // Only the first camera's frames are used, and what it shows first is the second pose.
    EXPECT_LT((scene.people[0].PoseAt(1).row(0) - in_world.row(0)).cwiseAbs().maxCoeff(), 1e-6F);
    return scene.people[0].IsKnown(0, 0);
  };
  Dataset dataset = Solved(in_world);
  dataset.sequences[0].cameras[1].solved = {};
  dataset.sequences[0].fps = 50.0;
  dataset.sequences[0].cameras[0].time_offset_seconds = 1.0 / 50.0;
  EXPECT_FALSE(first_pose_is_late(dataset));
  dataset.sequences[0].cameras[0].time_offset_seconds = 0.0;
  dataset.sequences[0].cameras[0].solved_frames = {1.0, std::nan("")};
  EXPECT_FALSE(first_pose_is_late(dataset));
  dataset.sequences[0].cameras[0].solved_frames = {1.1, 0.0};  // backwards
  EXPECT_TRUE(first_pose_is_late(dataset));
}

TEST(SceneOfSolved, AsksForASolution) {
  Dataset dataset = Solved(Eigen::Matrix<float, 4, 3>::Zero());
  for (CameraView& view : dataset.sequences[0].cameras) view.solved = {};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { SceneOfSolved(dataset, dataset.sequences[0], "data.h5"); }),
              HasSubstr("canonpose solve"));
}

}  // namespace
}  // namespace canonpose
