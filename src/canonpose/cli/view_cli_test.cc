// `view` from the user's side: what it writes, and what it refuses.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
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
  EXPECT_EQ(Execute({"view", scene, "--report", "a", "--report", "b", "-o", folder / "page.html"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "page.html"));
}

}  // namespace
}  // namespace canonpose
