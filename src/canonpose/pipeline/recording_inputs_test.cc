#include "canonpose/pipeline/recording_inputs.h"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/dataset.h"
#include "canonpose/pipeline/pipeline_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::NamesOf;
using testing::TemporaryFolder;
using testing::WriteFrame;

TEST(RecordingInputs, KeypointsAreRecognised) {
  const TemporaryFolder folder;
  WriteFrame(folder / "rec/cam1");
  WriteFrame(folder / "rec/cam2");
  const RecordingInputs together = FindRecording({(folder / "rec").string()}, "");
  EXPECT_FALSE(together.are_videos);
  EXPECT_EQ(together.format, "openpose");
  EXPECT_THAT(NamesOf(together), ::testing::ElementsAre("cam1", "cam2"));
  const RecordingInputs one_by_one =
      FindRecording({(folder / "rec/cam2").string(), (folder / "rec/cam1").string()}, "");
  EXPECT_THAT(NamesOf(one_by_one), ::testing::ElementsAre("cam2", "cam1"));
}

TEST(RecordingInputs, WhatCannotBeARecordingIsRefused) {
  const TemporaryFolder folder;
  WriteFrame(folder / "one/cam1");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindRecording({(folder / "one").string()}, ""); }),
              AllOf(HasSubstr("at least two cameras"), HasSubstr("one camera's keypoints")));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { FindRecording({(folder / "one").string()}, "opnpose"); }),
              HasSubstr("opnpose"));
  ErrorOf(ErrorKind::kInvalidArgument, [&] { FindRecording({}, ""); });
  WriteDataset(folder / "data.h5", testing::SmallCapture("ring"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindRecording({(folder / "data.h5").string()}, ""); }),
              AllOf(HasSubstr("a dataset"), HasSubstr("canonpose solve")));
}

}  // namespace
}  // namespace canonpose
