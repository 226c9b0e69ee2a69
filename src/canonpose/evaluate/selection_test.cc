#include "canonpose/evaluate/selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace canonpose {
namespace {

using ::testing::ElementsAre;

/// One joint; truth's x is the frame's number, and so is the focal length of a moving camera.
Sequence Recorded(const std::string& subject, int first, int frames) {
  Sequence sequence{subject + "_walk", subject, 50.0, false, subject, frames, {CameraView()}};
  CameraView& view = sequence.cameras.front();
  std::vector<float> truth;
  for (int t = first; t < first + frames; ++t) {
    const auto number = static_cast<float>(t);
    view.keypoints.insert(view.keypoints.end(), {number, 0.0F});
    view.confidence.push_back(1.0F);
    truth.insert(truth.end(), {number, 0.0F, 0.0F});
    Camera camera;
    camera.K(0, 0) = number + 1.0;
    view.calibration.push_back(camera);
  }
  view.truth = TruthPoses({"", {"Hip"}, {-1}, 0, {0}}, truth, view.name);
  return sequence;
}

Protocol EveryFifthFrom(int first) {
  Protocol protocol;
  protocol.subjects = {"S9", "S11"};
  protocol.first_frame = first;
  protocol.frame_step = 5;
  return protocol;
}

TEST(SelectionTest, SubjectsAndFrames) {
  Dataset dataset;
  for (const char* subject : {"S1", "S9", "S5", "S1"}) dataset.sequences.push_back(Recorded(subject, 0, 11));
  const Selection selection = SelectPoses(dataset, EveryFifthFrom(0), 0);
  EXPECT_EQ(selection.left_out_sequences, 3);
  EXPECT_THAT(selection.left_out_subjects, ElementsAre("S1", "S5"));
  ASSERT_EQ(dataset.sequences.size(), 1U);
  const Sequence& sequence = dataset.sequences.front();
  EXPECT_EQ(sequence.frame_count, 3);
  const CameraView& view = sequence.cameras.front();
  EXPECT_THAT(view.truth.positions(), ElementsAre(0, 0, 0, 5, 0, 0, 10, 0, 0));
  EXPECT_THAT(view.keypoints, ElementsAre(0, 0, 5, 0, 10, 0));
  EXPECT_EQ(view.confidence.size(), 3U);
  EXPECT_TRUE(view.solved.empty());
  EXPECT_EQ(view.CalibrationAt(1).K(0, 0), 6.0);
  EXPECT_EQ(selection.FrameNumber(2), 10);
}

TEST(SelectionTest, FramesAreCountedFromTheFilesFirstFrame) {
  Dataset dataset;
  dataset.sequences.push_back(Recorded("S9", 7, 10));  // as after KeepFrames() with 7-16
  dataset.sequences.push_back(Recorded("S11", 7, 4));  // 7 to 10
  const Selection selection = SelectPoses(dataset, EveryFifthFrom(2), 7);
  ASSERT_EQ(dataset.sequences.size(), 2U);
  EXPECT_THAT(dataset.sequences[0].cameras[0].truth.positions(), ElementsAre(7, 0, 0, 12, 0, 0));
  EXPECT_EQ(selection.FrameNumber(1), 12);

  dataset.sequences = {Recorded("S11", 8, 4)};
  EXPECT_EQ(SelectPoses(dataset, EveryFifthFrom(2), 8).sequences_too_short, 1);
  EXPECT_TRUE(dataset.sequences.empty()) << "there is no frame 12";
}

TEST(SelectionTest, ActionsStayWithTheirFrames) {
  Dataset dataset;
  dataset.sequences.push_back(Recorded("S9", 0, 11));
  Sequence& sequence = dataset.sequences.front();
  EXPECT_EQ(ActionIn(sequence, 5), "");
  sequence.actions = {"sit", "eat"};
  EXPECT_EQ(ActionIn(sequence, 5), "sit") << "the first action, if frames have none";
  sequence.action = {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
  SelectPoses(dataset, EveryFifthFrom(0), 0);
  EXPECT_EQ(ActionIn(sequence, 0), "sit");
  EXPECT_EQ(ActionIn(sequence, 1), "eat");
}

TEST(SelectionTest, TheDefaultKeepsAllData) {
  Dataset dataset;
  dataset.sequences.push_back(Recorded("S1", 3, 4));
  const Selection selection = SelectPoses(dataset, FindProtocol(kAllFrames), 3);
  EXPECT_EQ(dataset.sequences.front().frame_count, 4);
  EXPECT_EQ(selection.FrameNumber(1), 4);
  EXPECT_EQ(selection.left_out_sequences, 0);
}

}  // namespace
}  // namespace canonpose
