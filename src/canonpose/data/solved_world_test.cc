#include "canonpose/data/solved_world.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/read_scenes.h"
#include "canonpose/data/solved_scene.h"
#include "canonpose/scene/world_testing.h"

namespace canonpose {
namespace {

using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

constexpr double kStatureMm = 1750.0;

/// What `solve` would make of a walk before four level cameras: body lengths, in a frame of its own. Calibrated
/// exactly.
Dataset Solved() {
  Scene truth;
  truth.people = {testing::MakePerson(testing::Walk(), kStatureMm)};
  truth.cameras = testing::MakeCameras();
  const Scene hidden = testing::Hide(truth);
  const PoseSequence& person = hidden.people[0];
  Dataset dataset;
  dataset.skeleton = person.skeleton();
  Sequence& sequence = dataset.sequences.emplace_back();
  sequence.name = "walk";
  sequence.subject = sequence.capture = person.name;
  sequence.fps = 30.0;
  sequence.frame_count = person.frame_count();
  for (std::size_t c = 0; c < hidden.cameras.size(); ++c) {
    CameraView& view = sequence.cameras.emplace_back();
    view.name = hidden.cameras[c].name;
    view.image_size = hidden.cameras[c].image_size_px;
    view.solved_calibration = hidden.cameras[c].calibration;
    view.calibration = truth.cameras[c].calibration;
    std::vector<float> solved;
    for (int t = 0; t < person.frame_count(); ++t) {
      for (int j = 0; j < person.joint_count(); ++j) {
        const Eigen::Vector3d in_camera =
            view.solved_calibration[0].InCamera(person.PoseAt(t).row(j).transpose().cast<double>());
        const Eigen::Vector2d pixel = view.solved_calibration[0].ProjectFromCamera(in_camera);
        for (const double coordinate : in_camera) solved.push_back(static_cast<float>(coordinate));
        for (const double coordinate : pixel) view.keypoints.push_back(static_cast<float>(coordinate));
        view.confidence.push_back(1.0F);
      }
    }
    view.solved = PosesInCamera(dataset.skeleton, std::move(solved), LengthUnit::kBodyLengths, view.name);
    view.solved.standard_deviation().assign(view.solved.standard_deviation().size(), 0.001F);
  }
  return dataset;
}

void PlaceAll(Dataset& dataset, const WorldMeasures& measures) {
  const std::vector<std::size_t> all = {0};
  PlaceSolvedInWorld(all, measures, dataset);
}

TEST(PlaceSolvedInWorld, MillimetresGoThroughTheFile) {
  const TemporaryFolder folder;
  Dataset dataset = Solved();
  PlaceAll(dataset, {{{"", kStatureMm}}, {}});
  WriteDataset(folder / "solved.h5", dataset);
  const Dataset read = ReadDataset(folder / "solved.h5");
  const Sequence& sequence = read.sequences[0];
  EXPECT_EQ(sequence.cameras[0].solved.unit, LengthUnit::kMillimetres);
  EXPECT_EQ(sequence.solved_world.up.source, dataset.sequences[0].solved_world.up.source);
  EXPECT_EQ(sequence.solved_world.floor.uncertainty, dataset.sequences[0].solved_world.floor.uncertainty);
  EXPECT_THAT(sequence.solved_world.scale.source, HasSubstr("the height given"));
  EXPECT_NEAR(sequence.cameras[0].solved.standard_deviation()[5], 0.001 * 4321.0, 0.01);
  // The cameras project the poses where they did.
  for (const CameraView& view : sequence.cameras) {
    for (int j = 0; j < read.skeleton.joint_count(); ++j) {
      const Eigen::Vector3d in_camera = view.solved.PoseAt(70).row(j).transpose().cast<double>();
      const Eigen::Vector2d pixel = view.SolvedCalibrationAt(70).ProjectFromCamera(in_camera);
      const std::size_t i = 70 * read.skeleton.joints.size() + static_cast<std::size_t>(j);
      EXPECT_NEAR(pixel.x(), view.keypoints[2 * i], 0.05);
      EXPECT_NEAR(pixel.y(), view.keypoints[2 * i + 1], 0.05);
    }
  }
  const std::vector<Scene> scenes = ReadScenes(folder / "solved.h5");
  ASSERT_EQ(scenes.size(), 1U);
  EXPECT_TRUE(scenes[0].up.is_known() && scenes[0].floor.is_known() && scenes[0].scale.is_known());
  const PoseSequence& person = scenes[0].people[0];
  EXPECT_EQ(person.unit, LengthUnit::kMillimetres);
  EXPECT_NEAR(person.PoseAt(0)(*person.skeleton().Find("Head"), 2), kStatureMm, 2.0);
}

TEST(PlaceSolvedInWorld, WithoutASizePosesStayAsTheyAre) {
  const TemporaryFolder folder;
  Dataset dataset = Solved();
  const std::vector<float> before = dataset.sequences[0].cameras[2].solved.positions();
  PlaceAll(dataset, {});
  EXPECT_EQ(dataset.sequences[0].cameras[2].solved.positions(), before);
  WriteDataset(folder / "solved.h5", dataset);
  h5::File file = h5::File::OpenForReading(folder / "solved.h5");
  EXPECT_FALSE(file.root().Open("sequences").Open("walk").HasAttribute("solved_unit"));
  const Sequence sequence = ReadDataset(folder / "solved.h5").sequences[0];
  EXPECT_EQ(sequence.cameras[0].solved.unit, LengthUnit::kBodyLengths);
  EXPECT_TRUE(sequence.solved_world.up.is_known());
  EXPECT_FALSE(sequence.solved_world.scale.is_known());
}

TEST(PlaceSolvedInWorld, FilesFromBeforeHaveBodyLengthsAndNoWorld) {
  const TemporaryFolder folder;
  WriteDataset(folder / "solved.h5", Solved());
  const Sequence sequence = ReadDataset(folder / "solved.h5").sequences[0];
  EXPECT_EQ(sequence.cameras[0].solved.unit, LengthUnit::kBodyLengths);
  EXPECT_FALSE(sequence.solved_world.up.is_known());
}

TEST(PlaceSolvedInWorld, ACalibrationTellsTheScale) {
  Dataset dataset = Solved();
  const WorldMeasures measures = DistancesOfCalibration(dataset.sequences[0]);
  EXPECT_EQ(measures.distances.size(), 6U);
  PlaceAll(dataset, measures);
  EXPECT_NEAR(dataset.sequences[0].cameras[0].solved.standard_deviation()[0], 0.001 * 4321.0, 0.001);
  EXPECT_THAT(dataset.sequences[0].solved_world.scale.source, HasSubstr("calibration"));
}

TEST(PlaceSolvedInWorld, LeavesWhatIsNotSolved) {
  Dataset dataset = Solved();
  for (CameraView& view : dataset.sequences[0].cameras) view.solved_calibration.clear();
  PlaceAll(dataset, {{{"", kStatureMm}}, {}});
  EXPECT_FALSE(dataset.sequences[0].solved_world.up.is_known());
  EXPECT_EQ(dataset.sequences[0].cameras[0].solved.unit, LengthUnit::kBodyLengths);
}

TEST(RequireMeasuresOf, PeopleAndCamerasMustBeThere) {
  Dataset dataset = Solved();
  RequireMeasuresOf(dataset, {{{"", 1750.0}}, {}});
  RequireMeasuresOf(dataset, {{{"Ann", 1750.0}}, {}});
  RequireMeasuresOf(dataset, {{}, {{"cam1", "cam2", 1000.0}}});
  const auto message = [&](const WorldMeasures& measures) {
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { RequireMeasuresOf(dataset, measures); });
  };
  EXPECT_THAT(message({{{"Bob", 1750.0}}, {}}), HasSubstr("Ann"));
  EXPECT_THAT(message({{{"Ann", 1750.0}, {"Ann", 1700.0}}, {}}), HasSubstr("two heights"));
  EXPECT_THAT(message({{}, {{"cam1", "cam9", 1000.0}}}), HasSubstr("cam1, cam2, cam3, cam4"));
  dataset.sequences.push_back(dataset.sequences[0]);
  dataset.sequences[1].subject = "Bob";
  EXPECT_THAT(message({{{"", 1750.0}}, {}}), HasSubstr("Bob=1.75"));
  dataset.sequences[1].static_cameras = false;
  EXPECT_THAT(message({{}, {{"cam1", "cam2", 1000.0}}}), HasSubstr("stand still"));
}

}  // namespace
}  // namespace canonpose
