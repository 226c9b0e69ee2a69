#include "canonpose/data/readers/deeplabcut.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/hdf5.h"
#include "canonpose/data/readers/readers_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::PointOf;
using testing::ReadCameras;
using testing::ReadText;
using testing::ReadTextError;
using testing::TemporaryFolder;
using testing::TestData;

const std::string kHeader =
    "scorer,net,net,net,net,net,net\n"
    "bodyparts,left ear,left ear,left ear,tail base,tail base,tail base\n"
    "coords,x,y,likelihood,x,y,likelihood\n";

TEST(DeepLabCut, OneAnimalWithGapsAndNamesWithSpaces) {
  const DetectedCamera camera = ReadText("deeplabcut", "cam1DLC_resnet50_x.csv",
                                         kHeader + "0,1,2,0.5,3,4,0.25\n2,,,,nan,NaN,0.9\n3,5,6,0.1,,8,0.7\n");
  EXPECT_EQ(camera.name, "cam1");
  ASSERT_TRUE(camera.layout.has_value());
  EXPECT_EQ(camera.layout->name, "deeplabcut");
  EXPECT_THAT(camera.layout->joints, ElementsAre("left ear", "tail base"));
  EXPECT_TRUE(camera.layout->bones.empty());
  ASSERT_EQ(camera.frames.size(), 3U);
  EXPECT_EQ(camera.frames[1].number, 2) << "frame 1 is missing and is not invented";
  EXPECT_TRUE(camera.frames[1].people.empty());
  const DetectedPerson& first = camera.frames[0].people.at(0);
  EXPECT_THAT(first.keypoints, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(first.confidence, ElementsAre(0.5F, 0.25F));
  EXPECT_FALSE(first.track_id.has_value()) << "one animal needs no track";
  EXPECT_FALSE(camera.has_tracks);
  const DetectedPerson& last = camera.frames[2].people.at(0);
  EXPECT_TRUE(std::isnan(PointOf(last, 1)[0]));
  EXPECT_TRUE(std::isnan(PointOf(last, 1)[1]));
  EXPECT_EQ(last.confidence[1], 0.0F);
}

TEST(DeepLabCut, SeveralAnimalsAreTracksAndOtherPartsAreReported) {
  const std::string text =
      "scorer,net,net,net,net,net,net\n"
      "individuals,mouse1,mouse1,mouse2,mouse2,single,single\n"
      "bodyparts,nose,nose,nose,nose,corner,corner\n"
      "coords,x,y,x,y,x,y\n"
      "0,1,2,3,4,50,50\n"
      "1,,,5,6,50,50\n";
  const CollectedMessages messages;
  const DetectedCamera camera = ReadText("deeplabcut", "top.csv", text);
  EXPECT_THAT(camera.layout->joints, ElementsAre("nose"));
  ASSERT_EQ(camera.frames[0].people.size(), 2U);
  EXPECT_EQ(camera.frames[0].people[0].confidence[0], 1.0F) << "without a likelihood";
  EXPECT_EQ(camera.frames[0].people[1].track_id, 1);
  ASSERT_EQ(camera.frames[1].people.size(), 1U);
  EXPECT_EQ(camera.frames[1].people[0].track_id, 1);
  EXPECT_TRUE(camera.has_tracks);
  EXPECT_THAT(messages.text(), HasSubstr("individuals with other body parts are left out: single (corner)"));
}

TEST(DeepLabCut, LabelledImagesHaveTheirNumbers) {
  const std::string text =
      "scorer,,,me,me\nbodyparts,,,nose,nose\ncoords,,,x,y\n"
      "labeled-data,cam1,img0012.png,1,2\nlabeled-data,cam1,img0030.png,3,4\n";
  const DetectedCamera camera = ReadText("deeplabcut", "CollectedData_me.csv", text);
  ASSERT_EQ(camera.frames.size(), 2U);
  EXPECT_EQ(camera.frames[0].number, 12);
  EXPECT_EQ(camera.frames[1].number, 30);
}

TEST(DeepLabCut, CamerasAreFilesOrFolders) {
  const TemporaryFolder folder;
  const std::string row = kHeader + "0,1,2,0.5,3,4,0.25\n";
  fs::create_directories(folder / "files");
  WriteFileAtomically(folder / "files/leftDLC_resnet50_a.csv", row);
  WriteFileAtomically(folder / "files/rightDLC_resnet50_a.csv", row);
  WriteFileAtomically(folder / "files/notes.csv", "a,b\n");
  for (const char* const camera : {"A", "B"}) {
    fs::create_directories(folder / "folders" / camera);
    WriteFileAtomically(folder / "folders" / camera / "videoDLC_resnet50_a.csv", row);
  }
  const auto names = [&](const char* below) {
    std::vector<std::string> result;
    for (const CameraInput& camera : FindDeepLabCutCameras(folder / below)) result.push_back(camera.name);
    return result;
  };
  const CollectedMessages messages;
  EXPECT_THAT(names("files"), ElementsAre("left", "right"));
  EXPECT_THAT(messages.text(), HasSubstr("a file in"));
  EXPECT_THAT(messages.text(), HasSubstr("notes.csv"));
  EXPECT_THAT(names("folders"), ElementsAre("A", "B"));
  // Of the same detections as csv and as h5, the h5 is read.
  fs::copy(TestData("detections/deeplabcut_table"), folder / "both");
  fs::copy(TestData("detections/deeplabcut"), folder / "both", fs::copy_options::recursive);
  const std::vector<CameraInput> both = FindDeepLabCutCameras(folder / "both");
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].path.extension(), ".h5");
}

TEST(DeepLabCut, WrongTablesAreRefused) {
  const auto error = [](const std::string& text) { return ReadTextError("deeplabcut", "a.csv", text); };
  EXPECT_THAT(error("frame,x,y\n0,1,2\n"),
              AllOf(HasSubstr("a.csv: line 1: expected DeepLabCut's header"), HasSubstr("found \"frame,x,y\"")));
  EXPECT_THAT(error(""), HasSubstr("found an empty file"));
  EXPECT_THAT(error(kHeader), HasSubstr("expected detections of a person, found no frames"));
  EXPECT_THAT(error(kHeader + "0,,,,,,\n"), HasSubstr("nobody in any of 1 frames"));
  EXPECT_THAT(error(kHeader + "0,1,2\n"), HasSubstr("line 4: expected 7 cells as in the header, found 3"));
  EXPECT_THAT(error(kHeader + "0,1,2,0.5,x,4,0.25\n"), HasSubstr("line 4, column 5: expected a number, found \"x\""));
  EXPECT_THAT(error(kHeader + "0,1,2,0.5,3,4,0.25\n0,1,2,0.5,3,4,0.25\n"),
              HasSubstr("line 4 and line 5, both frame 0"));
  EXPECT_THAT(error("scorer,n,n,n\nbodyparts,a,a,a\ncoords,x,y,z\n0,1,2,3\n"), HasSubstr("found \"z\""));
  EXPECT_THAT(error("scorer,n,n,n\nbodyparts,a,a,a\ncoords,x,y,x\n0,1,2,3\n"), HasSubstr("x twice"));
  EXPECT_THAT(error("scorer,n,n,n\nbodyparts,a,a,b\ncoords,x,y,x\n0,1,2,3\n"), HasSubstr("x and y of b"));
  EXPECT_THAT(error("scorer,n,n,n,n\nbodyparts,a,a,A,A\ncoords,x,y,x,y\n0,1,2,3,4\n"), HasSubstr("\"A\" twice"));
}

TEST(DeepLabCut, OtherHdf5FilesAreRefused) {
  const TemporaryFolder folder;
  const auto error = [&](const char* name) {
    return ErrorOf(ErrorKind::kBadInput, [&] { ReadCameras("deeplabcut", folder / name); });
  };
  h5::File empty = h5::File::CreateAt(folder / "empty.h5");
  empty.Commit();
  EXPECT_THAT(error("empty.h5"), HasSubstr("expected DeepLabCut's table, as pandas writes it, found an empty file"));
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [] { ReadCameras("deeplabcut", TestData("detections/sleap/cam1.analysis.h5")); }),
      HasSubstr("expected DeepLabCut's table, as pandas writes it, found edge_inds and "));
  WriteFileAtomically(folder / "text.h5", kHeader);
  EXPECT_THAT(error("text.h5"), HasSubstr("expected a readable HDF5 file, found another format"));
  h5::File other = h5::File::CreateAt(folder / "other.h5");
  h5::Group table = other.root().Create("df");
  table.SetString("pandas_type", "frame");
  table.SetInt("axis0_nlevels", 3);
  table.SetInt("nblocks", 2);
  other.Commit();
  EXPECT_THAT(error("other.h5"), HasSubstr("expected one block of values, found several"));
}

// Every byte in turn would take minutes; each of these is a place in one of the file's structures or in its values.
TEST(DeepLabCut, DamagedHdf5FilesAreReadOrRefused) {
  const TemporaryFolder folder;
  for (const char* const form : {"deeplabcut_table", "deeplabcut_fixed"}) {
    const std::string name = "cam1DLC_resnet50_walkJan1shuffle1_100000.h5";
    const std::string whole = ReadFile(TestData("detections") / form / name);
    for (std::size_t i = 0; i < 24; ++i) {
      std::string damaged = whole;
      damaged[i * (whole.size() / 24) + i % 7] ^= static_cast<char>(0x55);
      if (i % 4 == 0) damaged.resize(whole.size() * i / 24);
      WriteFileAtomically(folder / name, damaged);
      try {
        ReadCameras("deeplabcut", folder / name);
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace canonpose
