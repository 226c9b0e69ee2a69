// `view` from the user's side: what it writes, and what it refuses.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/dataset.h"
#include "canonpose/scene/scene.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using testing::Outcome;
using ::testing::StartsWith;
using testing::TemporaryFolder;

/// A scene file with somebody who stands still for ten frames.
std::string WriteStanding(const std::string& path) {
  Scene scene;
  scene.name = "standing";
  PoseSequence& person = scene.people.emplace_back(*FindSkeleton("h36m-17"), 10);
  person.fps = 25.0;
  for (std::size_t i = 0; i < person.positions().size(); ++i) {
    person.positions()[i] = static_cast<float>(i % 51 % 7) - 0.1F * static_cast<float>(i % 51);
  }
  person.TrustKnownJoints();
  WriteScene(path, scene);
  return path;
}

/// A solved dataset of the capture "hall", with the same person before one camera.
std::string WriteSolved(const std::string& path) {
  Dataset dataset;
  dataset.skeleton = *FindSkeleton("h36m-17");
  Sequence& sequence = dataset.sequences.emplace_back();
  sequence.name = "standing";
  sequence.subject = "her";
  sequence.capture = "hall";
  sequence.fps = 25.0;
  sequence.frame_count = 10;
  CameraView& view = sequence.cameras.emplace_back();
  view.name = "cam1";
  view.image_size = {640, 480};
  view.keypoints.assign(340, 100.0F);
  view.confidence.assign(170, 1.0F);
  std::vector<float> positions(510);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i % 51 % 7) + 3.0F;
  view.solved = PosesInCamera(dataset.skeleton, positions, LengthUnit::kBodyLengths, view.name);
  view.solved_calibration = {Camera{}};
  WriteDataset(path, dataset);
  return path;
}

TEST(View, WritesAPageAndSaysHowLargeItIs) {
  const TemporaryFolder folder;
  const std::string scene = WriteStanding(folder / "scene.h5");
  const Outcome outcome = Execute({"view", scene, "-o", folder / "page.html"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("page.html"), HasSubstr(" MiB"), HasSubstr("browser")));
  const std::string page = ReadFile(folder / "page.html");
  EXPECT_THAT(page, AllOf(StartsWith("<!doctype html>"), HasSubstr("scene.h5"), HasSubstr("\"name\":\"standing\"")));
}

TEST(View, IsTheSameEveryTime) {
  const TemporaryFolder folder;
  const std::string scene = WriteStanding(folder / "scene.h5");
  EXPECT_EQ(Execute({"view", scene, "-o", folder / "a.html"}).exit_code, 0);
  EXPECT_EQ(Execute({"view", scene, "-o", folder / "b.html"}).exit_code, 0);
  EXPECT_EQ(ReadFile(folder / "a.html"), ReadFile(folder / "b.html"));
}

TEST(View, WritesAStripOfSkeletons) {
  const TemporaryFolder folder;
  const std::string scene = WriteStanding(folder / "scene.h5");
  const Outcome outcome = Execute({"view", scene, scene, "--svg", "0,4", "-o", folder / "strip.svg"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(ReadFile(folder / "strip.svg"), AllOf(StartsWith("<svg "), HasSubstr(">0.16 s<")));
  const Outcome beyond = Execute({"view", scene, "--svg", "10", "-o", folder / "strip.svg"});
  EXPECT_EQ(beyond.exit_code, 2);
  EXPECT_THAT(beyond.message(), HasSubstr("frame 10: scene.h5 has frames 0 to 9"));
}

TEST(View, RefusesWhatItCannotShow) {
  const TemporaryFolder folder;
  const std::string scene = WriteStanding(folder / "scene.h5");
  WriteFileAtomically(folder / "report.json", R"({"n_mpjpe_mm": 12})");
  ExpectBadInput({"view", folder / "none.h5", "-o", folder / "page.html"}, HasSubstr("none.h5"));
  ExpectBadInput({"view", scene, "--report", folder / "report.json", "-o", folder / "page.html"},
                 HasSubstr("report.json: expected a report"));
  EXPECT_EQ(Execute({"view", scene, "-o", scene}).exit_code, 2);
  for (const std::string name : {"page", "page.svg", "page.png"}) {
    EXPECT_THAT(Execute({"view", scene, "-o", folder / name}).message(), HasSubstr(".html")) << name;
  }
  EXPECT_THAT(Execute({"view", scene, "--svg", "0", "-o", folder / "strip.png"}).message(), HasSubstr(".svg"));
  // A report of another recording says nothing about this one.
  const std::string solved = WriteSolved(folder / "solved.h5");
  WriteFileAtomically(folder / "other.json", R"({"captures": [{"name": "other"}]})");
  WriteFileAtomically(folder / "own.json", R"({"captures": [{"name": "hall"}]})");
  ExpectBadInput({"view", solved, "--report", folder / "other.json", "-o", folder / "page.html"},
                 AllOf(HasSubstr("hall"), HasSubstr("that of other")));
  EXPECT_EQ(Execute({"view", solved, "--report", folder / "own.json", "-o", folder / "solved.html"}).exit_code, 0);
  EXPECT_EQ(Execute({"view", scene, "--report", "a", "--report", "b", "-o", folder / "page.html"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "page.html"));
}

}  // namespace
}  // namespace canonpose
