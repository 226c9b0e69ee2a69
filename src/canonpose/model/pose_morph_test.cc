#include "canonpose/model/pose_morph.h"

#include <cmath>
#include <limits>
#include <span>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/model/morph.h"
#include "canonpose/model/tensors.h"

namespace canonpose {
namespace {

using canonpose::testing::ErrorOf;
using canonpose::testing::TemporaryFolder;
using ::testing::HasSubstr;

Skeleton ThreeJoints() {
  Skeleton skeleton;
  skeleton.joints = {"Hip", "Left", "Right"};
  skeleton.parents = {-1, 0, 0};
  skeleton.mirror = {0, 2, 1};
  skeleton.root = 0;
  return skeleton;
}

/// A network that moves joint "Left" by `right` to the right and by `down` downwards, in units of the pose's norm.
ModelFile MovesOneJoint(float right, float down) {
  Morph network(3, 4);
  network->Initialise(1);
  ModelFile model;
  model.info.skeleton = ThreeJoints();
  model.info.network = NetworkKind::kMorph;
  model.info.width = 4;
  model.parameters = ParametersOf(*network);
  model.parameters.at("offset.bias").values = {0, right, 0, 0, down, 0};
  return model;
}

/// The root at (100, 200), the others 30 px to its left and 40 px below it.
CameraView OneView(int frames) {
  CameraView view;
  for (int t = 0; t < frames; ++t) {
    for (const float value : {100.0F, 200.0F, 70.0F, 200.0F, 100.0F, 240.0F}) view.keypoints.push_back(value);
    view.confidence.insert(view.confidence.end(), 3, 0.5F);
  }
  return view;
}

TEST(PoseMorph, MovesJointsInProportionToThePose) {
  const PoseMorph morph = PoseMorph::Of(std::make_shared<const ModelFile>(MovesOneJoint(0.1F, -0.2F)), "model");
  CameraView view = OneView(2);
  for (float& value : std::span(view.keypoints).subspan(6)) value *= 2.0F;
  morph.Apply(view, 2);
  EXPECT_NEAR(view.keypoints[2], 70.0 + 0.1 * 50.0, 1e-4);
  EXPECT_NEAR(view.keypoints[3], 200.0 - 0.2 * 50.0, 1e-4);
  EXPECT_NEAR(view.keypoints[8], 2.0 * (70.0 + 0.1 * 50.0), 1e-4);
  for (const int untouched : {0, 1, 4, 5}) EXPECT_EQ(view.keypoints[untouched], OneView(1).keypoints[untouched]);
  EXPECT_EQ(view.confidence, OneView(2).confidence);
}

TEST(PoseMorph, ADatasetRecordsWhatMovedItsKeypoints) {
  const PoseMorph morph = PoseMorph::Of(std::make_shared<const ModelFile>(MovesOneJoint(0.1F, 0.0F)), "model");
  Dataset dataset;
  dataset.skeleton = ThreeJoints();
  dataset.sequences.emplace_back();
  dataset.sequences.front().frame_count = 2;
  dataset.sequences.front().cameras = {OneView(2)};
  morph.Apply(dataset, "data.h5");
  EXPECT_EQ(dataset.source.morph, morph.Describe());
  EXPECT_THAT(morph.Describe(), HasSubstr("of width 4"));
  const PoseMorph other = PoseMorph::Of(std::make_shared<const ModelFile>(MovesOneJoint(0.2F, 0.0F)), "model");
  EXPECT_NE(other.Describe(), morph.Describe());
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { other.Apply(dataset, "data.h5"); }),
              HasSubstr("expected keypoints as the detector wrote them"));
}

TEST(PoseMorph, LeavesWhatIsMissingMissing) {
  const PoseMorph morph = PoseMorph::Of(std::make_shared<const ModelFile>(MovesOneJoint(0.1F, 0.0F)), "model");
  CameraView view = OneView(3);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  // Of the second frame the joint that is moved, of the third the root.
  view.keypoints[6 + 2] = view.keypoints[6 + 3] = view.keypoints[12] = view.keypoints[13] = nan;
  view.confidence[3 + 1] = view.confidence[6] = 0.0F;
  morph.Apply(view, 3);
  EXPECT_TRUE(std::isnan(view.keypoints[6 + 2]));
  EXPECT_EQ(view.keypoints[6 + 4], 100.0F);
  EXPECT_EQ(view.keypoints[12 + 2], 70.0F) << "a frame without its root stays as it is";
  EXPECT_NE(view.keypoints[2], 70.0F);
}

TEST(PoseMorph, AnUntrainedNetworkMovesNothing) {
  CameraView view = OneView(1);
  Morph network(3, 8);
  network->Initialise(3);
  ModelFile model = MovesOneJoint(0.0F, 0.0F);
  model.info.width = 8;
  model.parameters = ParametersOf(*network);
  PoseMorph::Of(std::make_shared<const ModelFile>(model), "model").Apply(view, 1);
  EXPECT_EQ(view.keypoints, OneView(1).keypoints);
}

TEST(PoseMorph, IsKeptInTheFileOfALifter) {
  const TemporaryFolder folder;
  Lifter lifter(3, 4);
  lifter->Initialise(1);
  ModelFile model;
  model.info.skeleton = ThreeJoints();
  model.info.width = 4;
  model.info.morph = std::make_shared<const ModelFile>(MovesOneJoint(0.25F, 0.5F));
  model.parameters = ParametersOf(*lifter);
  WriteModelFile(folder / "model.cpm", model);
  const ModelFile read = ReadModelFile(folder / "model.cpm");
  ASSERT_NE(read.info.morph, nullptr);
  CameraView one = OneView(1);
  CameraView other = OneView(1);
  PoseMorph::Of(read.info.morph, "model").Apply(one, 1);
  PoseMorph::Of(model.info.morph, "model").Apply(other, 1);
  EXPECT_EQ(one.keypoints, other.keypoints);
}

TEST(PoseMorph, RefusesLiftersAndOtherJoints) {
  const TemporaryFolder folder;
  ModelFile lifter = MovesOneJoint(0.0F, 0.0F);
  lifter.info.network = NetworkKind::kCanonical;
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { PoseMorph::Of(std::make_shared<const ModelFile>(lifter), "lifter.cpm"); }),
      HasSubstr("train-morph"));
  WriteModelFile(folder / "morph.cpm", MovesOneJoint(0.0F, 0.0F));
  const PoseMorph morph = PoseMorph::Open(folder / "morph.cpm");
  Dataset dataset;
  dataset.skeleton = ThreeJoints();
  dataset.skeleton.joints[1] = "Other";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { morph.Apply(dataset, "data.h5"); }), HasSubstr("Other"));
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { MakeLifter(ReadModelFile(folder / "morph.cpm"), "morph.cpm", torch::kCPU); }),
      HasSubstr("`morph`"));
}

}  // namespace
}  // namespace canonpose
