#include "canonpose/export/keypoint_files.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/data/import.h"
#include "canonpose/simulate/simulator.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

/// A clip with a detector's errors, so that joints and frames are missing.
SimulatedClip Simulate(const std::string& layout) {
  SimulationOptions options;
  options.activities = {Activity::kGait};
  options.subjects = 1;
  options.seconds = 6.0;
  options.fps = 25.0;
  options.layout = layout;
  options.detector.missed_joints = 2.0;
  options.detector.missed_frames = 3.0;
  return Simulator(options).Make(0);
}

CameraView Detected(const SimulatedClip& clip, std::size_t camera) {
  CameraView view;
  view.name = clip.cameras[camera].name;
  view.keypoints = clip.detections[camera].keypoints;
  view.confidence = clip.detections[camera].confidence;
  return view;
}

void ExpectSameKeypoints(const CameraView& simulated, const CameraView& imported) {
  ASSERT_EQ(simulated.confidence.size(), imported.confidence.size());
  for (std::size_t i = 0; i < simulated.confidence.size(); ++i) {
    ASSERT_EQ(simulated.confidence[i], imported.confidence[i]) << simulated.name << " " << i;
    if (simulated.confidence[i] == 0.0F) continue;
    ASSERT_EQ(simulated.keypoints[2 * i], imported.keypoints[2 * i]) << simulated.name << " " << i;
    ASSERT_EQ(simulated.keypoints[2 * i + 1], imported.keypoints[2 * i + 1]) << simulated.name << " " << i;
  }
}

struct RoundTrip {
  const char* format;
  const char* layout;
};

class KeypointFiles : public ::testing::TestWithParam<RoundTrip> {};

TEST_P(KeypointFiles, AreImportedAsInTheDataset) {
  const auto& [format, layout] = GetParam();
  const TemporaryFolder folder;
  const SimulatedClip clip = Simulate(layout);
  const int joints = FindSkeleton(layout)->joint_count();
  for (std::size_t c = 0; c < clip.cameras.size(); ++c) {
    const CameraView view = Detected(clip, c);
    if (std::string(format) == "openpose") {
      fs::create_directories(folder / "capture");
      WriteOpenPose(folder / "capture" / view.name, view, joints);
    } else {
      WriteAlphaPose(folder / "capture" / (view.name + ".json"), view, joints);
    }
  }
  ImportOptions options;
  options.format = format;
  options.paths = {folder / "capture"};
  options.layout = layout;
  options.image_size = clip.cameras[0].image_size;
  const Dataset imported = ImportDetections(options);
  ASSERT_EQ(imported.sequences.size(), 1U);
  ASSERT_EQ(imported.sequences[0].cameras.size(), clip.sequence.cameras.size());
  for (std::size_t c = 0; c < clip.cameras.size(); ++c) {
    ASSERT_EQ(imported.sequences[0].cameras[c].name, clip.sequence.cameras[c].name);
    ExpectSameKeypoints(clip.sequence.cameras[c], imported.sequences[0].cameras[c]);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, KeypointFiles,
                         ::testing::Values(RoundTrip{"openpose", "body_25b"}, RoundTrip{"openpose", "body_25"},
                                           RoundTrip{"openpose", "coco-18"}, RoundTrip{"alphapose", "halpe-26"},
                                           RoundTrip{"alphapose", "coco-17"}));

TEST(KeypointFiles, AnExistingFolderIsKept) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "cam");
  std::ofstream(folder / "cam" / "mine.json") << "{}";
  const CameraView view = Detected(Simulate("body_25b"), 0);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { WriteOpenPose(folder / "cam", view, 25); }), HasSubstr("remove it"));
  EXPECT_TRUE(fs::exists(folder / "cam" / "mine.json"));
}

}  // namespace
}  // namespace canonpose
