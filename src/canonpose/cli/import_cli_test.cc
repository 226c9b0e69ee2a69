// `import` of files that bring their own layouts, as users see it.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/cli/program_testing.h"
#include "canonpose/data/dataset.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::ElementsAre;
using testing::Execute;
using testing::ExpectBadInput;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::TemporaryFolder;
using testing::TestData;

TEST(ImportProgram, HelpAndMessagesNameTheFormats) {
  const Outcome help = Execute({"help", "import"});
  const Outcome mistake = Execute({"import", "kinect", "a", "-o", "b.h5"});
  for (const char* const format : {"deeplabcut", "sleap", "mediapipe", "ultralytics", "freemocap"}) {
    EXPECT_THAT(help.output, HasSubstr(format));
    EXPECT_THAT(mistake.message(), HasSubstr(format));
  }
}

TEST(ImportProgram, EveryFormatMakesADataset) {
  const TemporaryFolder folder;
  for (const auto& [format, sample] :
       {std::pair("deeplabcut", "deeplabcut_table"), std::pair("sleap", "sleap"),
        std::pair("mediapipe", "mediapipe_csv"), std::pair("ultralytics", "ultralytics_txt"),
        std::pair("freemocap", "freemocap")}) {
    const fs::path data = folder / (std::string(format) + ".h5");
    const Outcome outcome =
        Execute({"import", format, TestData("detections") / sample, "-o", data, "--image-size", "640x480"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_EQ(ReadDataset(data).skeleton.name, "h36m-17") << format;
  }
}

TEST(ImportProgram, ASkeletonOfOnesOwn) {
  const TemporaryFolder folder;
  const fs::path skeleton = folder / "arms.json";
  const fs::path data = folder / "data.h5";
  WriteFileAtomically(skeleton, R"({"joints":["nose","left shoulder","right shoulder","left elbow","right elbow"],
                                    "parents":[-1,0,0,1,2]})");
  const fs::path sample = TestData("detections/deeplabcut");
  const Outcome outcome =
      Execute({"import", "deeplabcut", sample, "-o", data, "--image-size", "640x480", "--layout", skeleton});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("arms.json lacks are left out: left eye"));
  const Dataset dataset = ReadDataset(data);
  EXPECT_THAT(dataset.skeleton.joints,
              ElementsAre("nose", "left shoulder", "right shoulder", "left elbow", "right elbow"));
  EXPECT_THAT(dataset.skeleton.mirror, ElementsAre(0, 2, 1, 4, 3));
  EXPECT_EQ(dataset.source.layout, "arms");
  WriteFileAtomically(skeleton, "{}");
  ExpectBadInput({"import", "deeplabcut", sample, "-o", data, "--image-size", "640x480", "--layout", skeleton},
                 AllOf(HasSubstr("arms.json"), HasSubstr("expected a skeleton with joints and parents")));
  EXPECT_EQ(
      Execute({"import", "deeplabcut", sample, "-o", data, "--image-size", "640x480", "--layout", "arms"}).exit_code,
      2);
}

}  // namespace
}  // namespace canonpose
