// Layouts that come with the files or from the user, from one clip to a whole import.
#include "canonpose/data/own_layout.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/import.h"
#include "canonpose/data/readers/mediapipe_layout.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::TestData;

/// A mouse that turns on the floor, as two cameras see it.
KeypointClip Mouse(const std::string& camera,
                   std::vector<std::string> names = {"left ear", "right ear", "nose", "neck", "tail base"}) {
  const std::vector<std::pair<std::string, std::array<float, 2>>> body{{"left ear", {-8, 20}},  {"right ear", {8, 20}},
                                                                       {"nose", {0, 36}},       {"neck", {0, 6}},
                                                                       {"tail base", {0, -50}}, {"corner", {70, 70}}};
  KeypointClip clip;
  clip.name = clip.path = camera;
  clip.keypoint_count = static_cast<int>(names.size());
  for (int t = 0; t < 12; ++t) {
    clip.frame_numbers.push_back(t);
    const float angle = 0.3F * static_cast<float>(t);
    for (const std::string& name : names) {
      const auto part = std::find_if(body.begin(), body.end(), [&](const auto& entry) { return entry.first == name; });
      const auto [x, y] = part->second;
      clip.keypoints.push_back(200.0F + x * std::cos(angle) - y * std::sin(angle));
      clip.keypoints.push_back(200.0F + 0.8F * (x * std::sin(angle) + y * std::cos(angle)));
      clip.confidence.push_back(0.9F);
    }
  }
  clip.layout = DetectedLayout{"deeplabcut", std::move(names), {}};
  return clip;
}

std::string ParentOf(const Skeleton& skeleton, const char* joint) {
  const int parent = skeleton.parents[static_cast<std::size_t>(skeleton.Find(joint).value())];
  return parent < 0 ? "" : skeleton.joints[static_cast<std::size_t>(parent)];
}

TEST(LayoutOf, JointsThatAreNamedAreConnectedByTheShortestTree) {
  std::vector<KeypointClip> clips{Mouse("a"), Mouse("b")};
  const CollectedMessages messages;
  const Skeleton layout = LayoutOf(clips, "");
  EXPECT_EQ(layout.Problem(), "");
  EXPECT_EQ(layout.name, "deeplabcut");
  EXPECT_THAT(layout.mirror, ElementsAre(1, 0, 2, 3, 4));
  EXPECT_EQ(ParentOf(layout, "left ear"), "neck");
  EXPECT_EQ(ParentOf(layout, "right ear"), "neck");
  EXPECT_EQ(ParentOf(layout, "tail base"), "neck");
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("5 joints named in the files"), HasSubstr("neck-left ear")));
}

TEST(LayoutOf, CamerasMayHaveTheJointsInAnotherOrder) {
  std::vector<KeypointClip> clips{Mouse("a"), Mouse("b", {"nose", "tail base", "neck", "right ear", "left ear"})};
  LayoutOf(clips, "");
  EXPECT_EQ(clips[0].keypoints, clips[1].keypoints);
  EXPECT_EQ(clips[1].layout->joints, clips[0].layout->joints);
  std::vector<KeypointClip> others{Mouse("a"), Mouse("b", {"nose", "tail base", "neck", "right ear", "corner"})};
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { LayoutOf(others, ""); }),
      HasSubstr("b: expected joint left ear of camera a, found the joints nose, tail base, neck, right ear, corner"));
  std::vector<KeypointClip> fewer{Mouse("a"), Mouse("b", {"nose", "neck"})};
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { LayoutOf(fewer, ""); }),
              HasSubstr("expected 5 joints as in camera a, found 2"));
}

TEST(LayoutOf, AUsersSkeletonChoosesJointsByName) {
  const TemporaryFolder folder;
  const fs::path file = folder / "mouse.json";
  WriteFileAtomically(file, R"({"joints":["tail base","neck","nose"],"parents":[-1,0,1]})");
  std::vector<KeypointClip> clips{Mouse("a"), Mouse("b")};
  const std::array<float, 2> tail{clips[0].keypoints[8], clips[0].keypoints[9]};
  const CollectedMessages messages;
  const Skeleton layout = LayoutOf(clips, file.string());
  EXPECT_THAT(layout.parents, ElementsAre(-1, 0, 1));
  EXPECT_EQ(clips[0].keypoint_count, 3);
  EXPECT_EQ(clips[0].keypoints.size(), 12U * 3 * 2);
  EXPECT_EQ(clips[0].keypoints[0], tail[0]);
  EXPECT_THAT(messages.text(), HasSubstr("are left out: left ear, right ear"));
  WriteFileAtomically(file, R"({"joints":["tail base","wing"],"parents":[-1,0]})");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { LayoutOf(clips, file.string()); }),
              HasSubstr("expected joint wing of"));
  // Files that name nothing are taken in the skeleton's order.
  for (KeypointClip& clip : clips) clip.layout.reset();
  WriteFileAtomically(file, R"({"joints":["a","b","c"],"parents":[-1,0,1]})");
  EXPECT_THAT(LayoutOf(clips, file.string()).joints, ElementsAre("a", "b", "c"));
  WriteFileAtomically(file, R"({"joints":["a","b"],"parents":[-1,0]})");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { LayoutOf(clips, file.string()); }),
              HasSubstr("expected 2 keypoints for the skeleton"));
}

TEST(LayoutOf, NamesOfLayouts) {
  EXPECT_NO_THROW(RequireLayoutName(""));
  EXPECT_NO_THROW(RequireLayoutName("coco-23"));
  EXPECT_NO_THROW(RequireLayoutName("MediaPipe-33"));
  EXPECT_NO_THROW(RequireLayoutName("a/b.json"));
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { RequireLayoutName("dog"); }),
              AllOf(HasSubstr("there is no layout \"dog\""), HasSubstr("a JSON file with joints and parents")));
  EXPECT_EQ(KeypointCountOf(""), 0);
  EXPECT_EQ(KeypointCountOf("halpe-26"), 26);
}

TEST(LayoutOf, ASkeletonOfAnEarlierImportIsUsedInItsOrder) {
  std::vector<KeypointClip> clips{Mouse("a")};
  clips[0].layout.reset();
  const Skeleton known{"", {"a", "b", "c", "d", "e"}, {-1, 0, 0, 0, 0}, 0, {0, 1, 2, 3, 4}};
  EXPECT_THAT(LayoutOf(clips, "mouse", &known).joints, ElementsAre("a", "b", "c", "d", "e"));
}

// ------------------------------------------------------------------------------------------------------ whole imports

ImportOptions Options(const std::string& format, const fs::path& path) {
  ImportOptions options;
  options.format = format;
  options.paths = {path};
  options.image_size = {640, 480};
  return options;
}

/// Two files of a mouse for DeepLabCut's reader.
void WriteMice(const fs::path& folder) {
  fs::create_directories(folder);
  for (const char* const camera : {"a", "b"}) {
    const KeypointClip clip = Mouse(camera);
    const float side = *camera == 'a' ? 0.0F : 40.0F;
    std::string parts = "bodyparts";
    std::string scorer = "scorer";
    std::string coords = "coords";
    for (const std::string& joint : clip.layout->joints) {
      parts += fmt::format(",{0},{0},{0}", joint);
      scorer += ",net,net,net";
      coords += ",x,y,likelihood";
    }
    std::string text = fmt::format("{}\n{}\n{}\n", scorer, parts, coords);
    for (int t = 0; t < clip.frame_count(); ++t) {
      text += fmt::format("{}", t);
      for (int k = 0; k < clip.keypoint_count; ++k) {
        const auto at = static_cast<std::size_t>(t * clip.keypoint_count + k);
        text += fmt::format(",{},{},0.9", clip.keypoints[2 * at] + side, clip.keypoints[2 * at + 1]);
      }
      text += "\n";
    }
    WriteFileAtomically(folder / fmt::format("{}DLC_resnet50_x.csv", camera), text);
  }
}

TEST(ImportOfOwnLayouts, AnAnimalKeepsItsJoints) {
  const TemporaryFolder folder;
  WriteMice(folder / "mice");
  const CollectedMessages messages;
  const Dataset dataset = ImportDetections(Options("deeplabcut", folder / "mice"));
  EXPECT_THAT(dataset.skeleton.joints, ElementsAre("left ear", "right ear", "nose", "neck", "tail base"));
  EXPECT_EQ(dataset.sequences[0].frame_count, 12);
  EXPECT_EQ(dataset.sequences[0].cameras[1].name, "b");
  EXPECT_EQ(dataset.source.layout, "deeplabcut");
  EXPECT_THAT(messages.text(), HasSubstr("are not a person's"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput,
                      [&] {
                        ImportOptions options = Options("deeplabcut", folder / "mice");
                        options.skeleton = "h36m-17";
                        ImportDetections(options);
                      }),
              HasSubstr("joints for h36m-17"));
  // What is read alone, for a model that was trained on this data.
  SingleCameraOptions single;
  single.layout = dataset.source.layout;
  single.skeleton = dataset.skeleton;
  const SingleCamera one = ReadSingleCamera(folder / "mice/aDLC_resnet50_x.csv", single);
  EXPECT_EQ(one.view.keypoints, dataset.sequences[0].cameras[0].keypoints);
}

TEST(ImportOfOwnLayouts, PeoplesJointsAreMappedAndTheRestIsSaid) {
  const CollectedMessages messages;
  const Dataset landmarks = ImportDetections(Options("mediapipe", TestData("detections/mediapipe_csv")));
  EXPECT_EQ(landmarks.skeleton.name, "h36m-17");
  EXPECT_THAT(messages.text(),
              AllOf(HasSubstr("18 of 33 keypoints have no place in h36m-17 and are left out (LEyeInner"),
                    HasSubstr("LPinky"), HasSubstr("`skeleton` native keeps them")));
  ImportOptions options = Options("mediapipe", TestData("detections/mediapipe_csv"));
  options.skeleton = "native";
  EXPECT_EQ(ImportDetections(options).skeleton.joints, MediapipeLayout().joints);
  EXPECT_EQ(ImportDetections(Options("sleap", TestData("detections/sleap"))).skeleton.name, "h36m-17");
}

TEST(ImportOfOwnLayouts, FeetOfWholeBodiesAreKept) {
  const CollectedMessages messages;
  ImportOptions options = Options("mmpose", TestData("detections/mmpose_133"));
  options.skeleton = "native";
  const Dataset dataset = ImportDetections(options);
  EXPECT_EQ(dataset.skeleton.name, "coco-23");
  EXPECT_TRUE(dataset.skeleton.Find("LHeel").has_value());
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("the keypoints of face, hands are left out"), Not(HasSubstr("feet"))));
}

TEST(ImportOfOwnLayouts, CocosFeetStandBesideTheBody) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "in");
  for (const char* const camera : {"a", "b"}) {
    std::string text = ReadFile(TestData("detections/coco") / (std::string(camera) + ".json"));
    const std::string feet =
        R"("foot_kpts":[300,400,0.5,301,400,0.5,302,400,0.5,303,400,0.5,304,400,0.5,305,400,0.5],"keypoints")";
    for (std::size_t at = text.find("\"keypoints\""); at != std::string::npos;
         at = text.find("\"keypoints\"", at + feet.size()))
      text.replace(at, 11, feet);
    WriteFileAtomically(folder / "in" / (std::string(camera) + ".json"), text);
  }
  ImportOptions options = Options("coco", folder / "in");
  options.skeleton = "native";
  options.layout = "coco-23";
  const Dataset dataset = ImportDetections(options);
  const auto heel = static_cast<std::size_t>(dataset.skeleton.Find("RHeel").value());
  EXPECT_EQ(dataset.sequences[0].cameras[0].keypoints[2 * heel], 305.0F);
}

TEST(ImportOfOwnLayouts, CamerasOfOneFileAreApart) {
  const Dataset dataset = ImportDetections(Options("freemocap", TestData("detections/freemocap")));
  ASSERT_EQ(dataset.sequences[0].cameras.size(), 2U);
  EXPECT_EQ(dataset.sequences[0].cameras[0].name, "camera0");
  SingleCameraOptions single;
  single.camera = "camera1";
  const SingleCamera one = ReadSingleCamera(TestData("detections/freemocap/output_data/raw_data"), single);
  EXPECT_EQ(one.frame_numbers.size(), 8U);
}

}  // namespace
}  // namespace canonpose
