// Every format: what is read, and what is refused.
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/calibration.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Shared;
using testing::TemporaryFolder;
using testing::TestData;

constexpr int kFrames = 8;
constexpr int kEmptyFrame = 5;
constexpr int kFrameWithMissingJoint = 2;

std::vector<DetectedCamera> ReadAll(const std::string& format, const fs::path& path) {
  const DetectionFormat& table = FindDetectionFormat(format);
  std::vector<DetectedCamera> cameras;
  for (CameraInput input : table.find_cameras(path)) {
    input.image_size = {640, 480};
    cameras.push_back(table.read(input));
  }
  return cameras;
}

/// Puts `text` into a file of a new camera folder and reads that.
std::string OpenPoseError(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "frame_0001.json", text);
  return ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder.path()); });
}

std::string FileError(const std::string& format, const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "cam.json", text);
  return ErrorOf(ErrorKind::kBadInput, [&] { ReadAll(format, folder / "cam.json"); });
}

/// count values 1, 2, 3, ... with commas.
std::string Values(int count) {
  std::string text;
  for (int i = 1; i <= count; ++i) text += fmt::format("{}{}", i == 1 ? "" : ",", i);
  return text;
}

std::string OpenPoseFrame(const std::string& values) {
  return fmt::format(R"({{"version":1.3,"people":[{{"person_id":[-1],"pose_keypoints_2d":[{}]}}]}})", values);
}

void ExpectSame(const std::vector<DetectedCamera>& one, const std::vector<DetectedCamera>& other) {
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t c = 0; c < one.size(); ++c) {
    ASSERT_EQ(one[c].frames.size(), other[c].frames.size());
    for (std::size_t t = 0; t < one[c].frames.size(); ++t) {
      const DetectedFrame& a = one[c].frames[t];
      const DetectedFrame& b = other[c].frames[t];
      EXPECT_EQ(a.number, b.number);
      ASSERT_EQ(a.people.size(), b.people.size());
      for (std::size_t p = 0; p < a.people.size(); ++p) {
        EXPECT_THAT(a.people[p].keypoints,
                    ::testing::Pointwise(::testing::NanSensitiveFloatEq(), b.people[p].keypoints));
        EXPECT_EQ(a.people[p].confidence, b.people[p].confidence);
      }
    }
  }
}

struct Sample {
  const char* folder;
  const char* format;
  int keypoints;
  int left_wrist;
  int first_frame;
};

class Samples : public ::testing::TestWithParam<Sample> {};

TEST_P(Samples, ContainTheSameClip) {
  const Sample& sample = GetParam();
  const fs::path path = TestData("detections") / sample.folder;
  EXPECT_EQ(DetectFormat(path), sample.format);
  const std::vector<DetectedCamera> cameras = ReadAll(sample.format, path);
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_NE(cameras[0].name, cameras[1].name);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(cameras[c].keypoint_count, sample.keypoints);
    ASSERT_EQ(cameras[c].frames.size(), static_cast<std::size_t>(kFrames));
    for (int t = 0; t < kFrames; ++t) {
      const DetectedFrame& frame = cameras[c].frames[static_cast<std::size_t>(t)];
      EXPECT_EQ(frame.number, t + sample.first_frame);
      EXPECT_EQ(frame.people.size(), c == 1 && t == kEmptyFrame ? 0U : 2U);
    }
  }
  const DetectedPerson& person = cameras[0].frames[kFrameWithMissingJoint].people[0];
  const auto wrist = static_cast<std::size_t>(sample.left_wrist);
  EXPECT_TRUE(std::isnan(person.keypoints[2 * wrist]));
  EXPECT_TRUE(std::isnan(person.keypoints[2 * wrist + 1]));
  EXPECT_EQ(person.confidence[wrist], 0.0F);
  for (std::size_t k = 0; k < person.confidence.size(); ++k) {
    EXPECT_EQ(std::isnan(person.keypoints[2 * k]), person.confidence[k] == 0.0F);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Formats, Samples,
    ::testing::Values(Sample{"openpose", "openpose", 25, 7, 0}, Sample{"openpose_25b", "openpose", 25, 9, 0},
                      Sample{"alphapose", "alphapose", 26, 9, 0}, Sample{"alphapose_136", "alphapose", 26, 9, 0},
                      Sample{"alphapose_open", "alphapose", 18, 7, 0}, Sample{"alphapose_cmu", "alphapose", 18, 7, 0},
                      Sample{"alphapose_sep", "alphapose", 18, 7, 0}, Sample{"mmpose_video", "mmpose", 17, 9, 1},
                      Sample{"mmpose_demo", "mmpose", 17, 9, 1}, Sample{"mmpose_images", "mmpose", 17, 9, 1},
                      Sample{"coco", "coco", 17, 9, 1}, Sample{"mmpose_133", "mmpose", 23, 9, 1},
                      Sample{"deeplabcut", "deeplabcut", 17, 9, 0}, Sample{"deeplabcut_table", "deeplabcut", 17, 9, 0},
                      Sample{"deeplabcut_fixed", "deeplabcut", 17, 9, 0}, Sample{"sleap", "sleap", 17, 9, 0},
                      Sample{"sleap_standard", "sleap", 17, 9, 0}, Sample{"ultralytics_txt", "ultralytics", 17, 9, 1},
                      Sample{"ultralytics_json", "ultralytics", 17, 9, 0}),
    [](const auto& sample) { return std::string(sample.param.folder); });

TEST(Formats, FormsOfOneDetectorAgree) {
  const fs::path all = TestData("detections");
  ExpectSame(ReadAll("alphapose", all / "alphapose_open"), ReadAll("alphapose", all / "alphapose_cmu"));
  ExpectSame(ReadAll("alphapose", all / "alphapose_open"), ReadAll("alphapose", all / "alphapose_sep"));
  ExpectSame(ReadAll("alphapose", all / "alphapose"), ReadAll("alphapose", all / "alphapose_136"));
  ExpectSame(ReadAll("mmpose", all / "mmpose_video"), ReadAll("mmpose", all / "mmpose_demo"));
  ExpectSame(ReadAll("mmpose", all / "mmpose_video"), ReadAll("mmpose", all / "mmpose_images"));
  ExpectSame(ReadAll("mmpose", all / "mmpose_video"), ReadAll("coco", all / "coco"));
  ExpectSame(ReadAll("deeplabcut", all / "deeplabcut"), ReadAll("deeplabcut", all / "deeplabcut_table"));
  ExpectSame(ReadAll("deeplabcut", all / "deeplabcut"), ReadAll("deeplabcut", all / "deeplabcut_fixed"));
  ExpectSame(ReadAll("deeplabcut", all / "deeplabcut"), ReadAll("sleap", all / "sleap"));
  ExpectSame(ReadAll("deeplabcut", all / "deeplabcut"), ReadAll("sleap", all / "sleap_standard"));
}

TEST(Formats, CamerasAreNamedByTheFileOrFolderThatDiffers) {
  const fs::path all = TestData("detections");
  const std::vector<CameraInput> files = FindDetectionFormat("alphapose").find_cameras(all / "alphapose");
  EXPECT_EQ(files[0].name, "left");
  const std::vector<CameraInput> results = FindDetectionFormat("AlphaPose").find_cameras(all / "alphapose_open");
  EXPECT_EQ(results[1].name, "right");
  EXPECT_EQ(CameraNameOf("a/left/alphapose-results.json"), "left");
  EXPECT_EQ(CameraNameOf("a/left/sep-json/"), "left");
  EXPECT_EQ(CameraNameOf("a/cam01/"), "cam01");
  EXPECT_EQ(CameraNameOf("a/cam.left"), "cam.left");
}

TEST(Formats, UnknownOnesAreUsageErrors) {
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [] { FindDetectionFormat("kinect"); }),
              HasSubstr("openpose, alphapose, mmpose, coco"));
}

TEST(Formats, ContentOfNoFormatIsRefused) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a.json", R"({"a": 1})");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { DetectFormat(folder / "a.json"); }),
              HasSubstr("found an object with a"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { DetectFormat(folder.path()); }), HasSubstr("none of these"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { DetectFormat(folder / "nothing"); }), HasSubstr("No such file"));
}

TEST(Formats, TheWrongFormatNamesTheRightOne) {
  const fs::path all = TestData("detections");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("mmpose", all / "coco"); }),
              HasSubstr("looks like the format coco"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("coco", all / "mmpose_video"); }),
              HasSubstr("looks like the format mmpose"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", all / "mmpose_images"); }),
              HasSubstr("looks like the format mmpose"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("alphapose", all / "mmpose_demo"); }),
              HasSubstr("looks like the format mmpose"));
  for (const char* const format : {"openpose", "alphapose", "sleap", "mediapipe"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll(format, all / "deeplabcut"); }),
                HasSubstr("looks like the format deeplabcut"));
  }
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("deeplabcut", all / "coco"); }),
              HasSubstr("looks like the format coco"));
}

TEST(OpenPose, FramesAreSortedByNumberAndNotByName) {
  const TemporaryFolder folder;
  for (const int number : {10, 9, 2}) {
    WriteFileAtomically(folder / fmt::format("frame_{}.json", number),
                        OpenPoseFrame(fmt::format("{},{},0.5", number, number)));
  }
  const std::vector<DetectedCamera> cameras = ReadAll("openpose", folder.path());
  std::vector<float> x;
  for (const DetectedFrame& frame : cameras[0].frames) x.push_back(frame.people[0].keypoints[0]);
  // A missing file is a lost frame, not one without people: gaps are not filled.
  EXPECT_THAT(x, ElementsAre(2.0F, 9.0F, 10.0F));
}

TEST(OpenPose, FramesOfTwoCamerasInOneFolderAreRefused) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "cam1_0001.json", OpenPoseFrame("1,2,0.5"));
  WriteFileAtomically(folder / "cam2_0001.json", OpenPoseFrame("1,2,0.5"));
  EXPECT_THAT(
      ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder.path()); }),
      AllOf(HasSubstr("cam1_0001.json and cam2_0001.json, both frame 1"), HasSubstr("one folder or file per camera")));
}

TEST(OpenPose, BadContentNamesFileAndPlace) {
  EXPECT_THAT(OpenPoseError(OpenPoseFrame(Values(74))),
              AllOf(HasSubstr("frame_0001.json: people[0].pose_keypoints_2d: expected a multiple of three values"),
                    HasSubstr("found 74 values")));
  EXPECT_THAT(
      OpenPoseError(R"({"people": [{"pose_keypoints_2d": [1,2,0.5]}, {"pose_keypoints_2d": [1,2,0.5,3,4,0.5]}]})"),
      AllOf(HasSubstr("people[1].pose_keypoints_2d: expected 1 keypoints"), HasSubstr("found 2")));
  EXPECT_THAT(OpenPoseError(OpenPoseFrame("1,Infinity,0.5")),
              HasSubstr("(people[0].pose_keypoints_2d[1]): expected a finite number"));
  EXPECT_THAT(OpenPoseError(OpenPoseFrame("1,\"x\",0.5")),
              HasSubstr("people[0].pose_keypoints_2d[1]: expected a number"));
  EXPECT_THAT(OpenPoseError(OpenPoseFrame("1,2,0.5").substr(0, 60)), HasSubstr("the file was cut off"));
  EXPECT_THAT(OpenPoseError("[]"), HasSubstr("expected an object with people, found an array"));
  EXPECT_THAT(OpenPoseError(R"({"fps": 60, "a": []})"),
              AllOf(HasSubstr("expected an object with people, found an object with a, fps"),
                    HasSubstr("the files that a 2D keypoint detector writes (openpose, alphapose, mmpose, coco, ")));
  EXPECT_THAT(OpenPoseError(R"({"people": {}})"), HasSubstr("people: expected an array, found an object"));
  EXPECT_THAT(OpenPoseError(R"({"people": [{"face_keypoints_2d": []}]})"),
              HasSubstr("people[0]: expected an object with pose_keypoints_2d"));
  EXPECT_THAT(OpenPoseError(R"({"people": [3]})"), HasSubstr("people[0]: expected an object"));
}

TEST(OpenPose, NobodyInAnyFrameIsRefused) {
  EXPECT_THAT(OpenPoseError(R"({"people": []})"),
              HasSubstr("expected detections of a person, found nobody in any of 1 frames"));
  EXPECT_THAT(OpenPoseError(OpenPoseFrame("0,0,0")), HasSubstr("nobody"));
  EXPECT_THAT(OpenPoseError(OpenPoseFrame("")), HasSubstr("nobody"));
  for (const char* people : {"[{}]", "[null]", "null", R"([{"person_id": [3]}])", R"([{"pose_keypoints_2d": null}])"}) {
    EXPECT_THAT(OpenPoseError(fmt::format(R"({{"people": {}}})", people)), HasSubstr("nobody in any of 1 frames"));
  }
  EXPECT_THAT(OpenPoseError(OpenPoseFrame("NaN,NaN,NaN")), HasSubstr("nobody"));
}

TEST(Formats, NaNAndNullAreMissingJoints) {
  const auto expect_second_missing = [](const std::string& format, const std::string& text) {
    const TemporaryFolder folder;
    MakeDirectory(folder / "cam");
    WriteFileAtomically(folder / "cam/frame_1.json", text);
    const bool is_folder = format == "openpose";
    const DetectedCamera camera = ReadAll(format, is_folder ? folder / "cam" : folder / "cam/frame_1.json").front();
    ASSERT_EQ(camera.keypoint_count, 3) << text;
    const DetectedPerson& person = camera.frames.front().people.front();
    EXPECT_EQ(person.confidence[0], 0.5F) << text;
    EXPECT_EQ(person.confidence[1], 0.0F) << text;
    EXPECT_TRUE(std::isnan(person.keypoints[2]) && std::isnan(person.keypoints[3])) << text;
    EXPECT_EQ(person.confidence[2], 0.5F) << text;
  };
  for (const char* joint : {"NaN,2,0.5", "2,NaN,0.5", "2,2,NaN", "null,null,null", "\"NaN\",2,0.5", "nan,nan,0"}) {
    const std::string values = fmt::format("1,2,0.5,{},5,6,0.5", joint);
    expect_second_missing("openpose", OpenPoseFrame(values));
    expect_second_missing("alphapose", fmt::format(R"([{{"image_id":"1.jpg","keypoints":[{}]}}])", values));
    expect_second_missing("alphapose",
                          fmt::format(R"({{"1.jpg":{{"people":[{{"pose_keypoints_2d":[{}]}}]}}}})", values));
    expect_second_missing(
        "coco", fmt::format(R"([{{"image_id":1,"keypoints":[{}]}},{{"image_id":2,"keypoints":null}}])", values));
    expect_second_missing("mmpose", fmt::format(R"([{{"keypoints":[[1,2,0.5],[{}],[5,6,0.5]]}}])", joint));
  }
  expect_second_missing("mmpose", R"([{"keypoints":[[1,2],null,[5,6]],"keypoint_scores":[0.5,0.5,0.5]}])");
  expect_second_missing("mmpose", R"([{"keypoints":[[1,2],[3,4],[5,6]],"keypoint_scores":[0.5,NaN,0.5]}])");
}

/// The messages of reading all cameras at a path.
std::string ReadLog(const std::string& format, const fs::path& path) {
  const CollectedMessages messages;
  ReadAll(format, path);
  return messages.text();
}

TEST(Formats, FilesWithoutKeypointsAreLeftOut) {
  const TemporaryFolder folder;
  MakeDirectory(folder / "cam");
  for (int t = 0; t < 3; ++t)
    WriteFileAtomically(folder / fmt::format("cam/frame_{}.json", t), OpenPoseFrame("1,2,0.5"));
  EXPECT_THAT(ReadLog("openpose", folder.path()), Not(HasSubstr("left out")));
  WriteFileAtomically(folder / "cam/.DS_Store", "x");
  WriteFileAtomically(folder / "cam/Thumbs.db", "x");
  WriteFileAtomically(folder / "cam/config.json", R"({"fps": 60})");
  WriteFileAtomically(folder / "cam/notes.json", "not JSON");
  EXPECT_THAT(
      ReadLog("openpose", folder.path()),
      AllOf(HasSubstr("cam: 4 files in "), HasSubstr(" have no keypoints and are left out: config.json and 3 more"),
            Not(HasSubstr("warning"))));
  EXPECT_EQ(ReadAll("openpose", folder.path()).front().frames.size(), 3U);
  // What may be a frame is worth a warning, and what certainly is one is refused if it is damaged.
  WriteFileAtomically(folder / "cam/frame_7.json", R"({"error": 1})");
  EXPECT_THAT(ReadLog("openpose", folder.path()), HasSubstr("warning: cam: 5 files"));
  WriteFileAtomically(folder / "cam/frame_8.json", R"({"peop)");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder.path()); }), HasSubstr("cut off"));
}

TEST(Formats, FilesOfOtherThingsAreNotCameras) {
  const TemporaryFolder folder;
  fs::copy(TestData("detections/alphapose"), folder.path(), fs::copy_options::recursive);
  WriteFileAtomically(folder / "reference3d.json", R"({"units": "mm", "pose3d": [[[1, 2, 3]]]})");
  WriteFileAtomically(folder / "calibration.json", R"({"cameras": {}})");
  EXPECT_EQ(ReadAll("alphapose", folder.path()).size(), 2U);
  EXPECT_THAT(ReadLog("alphapose", folder.path()),
              AllOf(HasSubstr("a file in "), HasSubstr(" has no keypoints and is left out: reference3d.json")));
  for (const char* name : {"left.json", "right.json"}) fs::remove(folder / name);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("alphapose", folder.path()); }),
              AllOf(HasSubstr("reference3d.json: expected detections of people, found an object with pose3d, units")));
}

TEST(OpenPose, FoldersWithoutFramesAreLeftOut) {
  const TemporaryFolder folder;
  for (const char* name : {"cam1", "cam2", "calib"}) MakeDirectory(folder / name);
  for (const char* name : {"cam1/f_1.json", "cam2/f_1.json"})
    WriteFileAtomically(folder / name, OpenPoseFrame("1,2,0.5"));
  WriteFileAtomically(folder / "calib/cam_1.json", R"({"K": []})");
  EXPECT_EQ(ReadAll("openpose", folder.path()).size(), 2U);
  EXPECT_THAT(ReadLog("openpose", folder.path()),
              HasSubstr("warning: a folder has no keypoints and is left out: calib"));
  // A camera in another format must not get lost.
  WriteFileAtomically(folder / "calib/cam_1.json", R"([{"keypoints": [[1, 2]], "keypoint_scores": [0.5]}])");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder.path()); }),
              HasSubstr("looks like the format mmpose"));
}

TEST(Formats, AnotherStructureIsDescribed) {
  EXPECT_THAT(FileError("coco", R"({"images": [1, 2, 3], "annotations": [1], "categories": [{"id": 1}]})"),
              AllOf(HasSubstr("found a COCO dataset with 3 images, 1 annotation and 1 category"),
                    HasSubstr("its third value is a visibility, not a confidence; give the results")));
  EXPECT_THAT(
      FileError("alphapose", R"([{"bbox": [], "id": 1}, {}])"),
      HasSubstr("found an array of 2 objects with bbox, id; give the files that a 2D keypoint detector writes"));
  EXPECT_THAT(FileError("mmpose", R"({"cameras": {"a": {}, "b": {}}})"),
              HasSubstr("found a calibration of cameras a, b; give it as `calibration`"));
}

TEST(Formats, VideosNeedADetector) {
  const TemporaryFolder folder;
  const std::string video(
      "\0\0\0\x20"
      "ftypisom\0\0\2\0",
      16);
  WriteFileAtomically(folder / "cam1.mp4", video);
  WriteFileAtomically(folder / "cam2.mp4", video);
  for (const char* format : {"openpose", "alphapose", "mmpose", "coco"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll(format, folder / "cam1.mp4"); }),
                AllOf(HasSubstr("found a video; run a 2D keypoint detector on it first"),
                      HasSubstr("openpose, alphapose, mmpose, coco, ...")))
        << format;
    EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll(format, folder.path()); }),
                HasSubstr("found 2 videos (cam1.mp4 and 1 more); run a 2D keypoint detector"))
        << format;
  }
  WriteFileAtomically(folder / "calibration.json", R"({"cameras": {}})");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder.path()); }), HasSubstr("found 2 videos"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { DetectFormat(folder / "cam1.mp4"); }), HasSubstr("found a video"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { DetectFormat(folder.path()); }), HasSubstr("found 2 videos"));
}

TEST(Formats, HandsAndFaceAreNoticed) {
  const TemporaryFolder folder;
  MakeDirectory(folder / "cam");
  WriteFileAtomically(folder / "cam/1.json", R"({"people": [{"pose_keypoints_2d": [1, 2, 0.5], "face_keypoints_2d": [],
      "hand_left_keypoints_2d": [1, 2, 0.5], "hand_right_keypoints_2d": []}]})");
  EXPECT_THAT(ReadAll("openpose", folder.path()).front().unused_parts, ElementsAre("hands"));
  EXPECT_THAT(ReadAll("alphapose", TestData("detections/alphapose_136")).front().unused_parts,
              ElementsAre("face", "hands"));
  EXPECT_THAT(ReadAll("alphapose", TestData("detections/alphapose")).front().unused_parts, IsEmpty());
}

TEST(FlatList, OfSeveralCategoriesPeopleAreRead) {
  const TemporaryFolder folder;
  const auto entry = [](int image, int category, int x) {
    return fmt::format(R"({{"image_id":{},"category_id":{},"keypoints":[{},2,0.5]}})", image, category, x);
  };
  const auto write = [&](const std::string& entries) { WriteFileAtomically(folder / "cam.json", "[" + entries + "]"); };
  write(entry(1, 18, 50) + "," + entry(1, 1, 7) + "," + entry(2, 18, 60));
  const DetectedCamera camera = ReadAll("coco", folder / "cam.json").front();
  ASSERT_EQ(camera.frames.size(), 2U);
  ASSERT_EQ(camera.frames[0].people.size(), 1U);
  EXPECT_EQ(camera.frames[0].people[0].keypoints[0], 7.0F);
  EXPECT_TRUE(camera.frames[1].people.empty());
  EXPECT_THAT(ReadLog("coco", folder / "cam.json"),
              HasSubstr("warning: cam: 2 detections of category 18 are left out; only people (category 1) are read"));
  write(entry(1, 18, 50) + "," + entry(1, 2, 7));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("coco", folder / "cam.json"); }),
              HasSubstr("expected detections of people, category 1, found categories 2, 18"));
  write(entry(1, 3, 50) + "," + entry(2, 3, 7));
  EXPECT_EQ(ReadAll("coco", folder / "cam.json").front().frames.size(), 2U);
}

TEST(Mmpose, ResultsDumpedFromMemoryAreFramesInOrder) {
  const TemporaryFolder folder;
  const char* const kPerson = R"({"keypoints": [[1, 2], [3, 4]], "keypoint_scores": [0.5, 0.6], "bbox_score": 0.9})";
  for (const std::string& text :
       {fmt::format(R"([{{"visualization": [], "predictions": [[]]}}, {{"predictions": [[{}]]}}])", kPerson),
        fmt::format("[[], [{}]]", kPerson),
        std::string(R"([[], [{"bbox": [0, 0, 1, 1, 0.9], "keypoints": [[1, 2, 0.5], [3, 4, 0.6]]}]])")}) {
    WriteFileAtomically(folder / "cam.json", text);
    EXPECT_EQ(DetectFormat(folder / "cam.json"), "mmpose") << text;
    const DetectedCamera camera = ReadAll("mmpose", folder / "cam.json").front();
    ASSERT_EQ(camera.frames.size(), 2U) << text;
    EXPECT_TRUE(camera.frames[0].people.empty());
    ASSERT_EQ(camera.frames[1].people.size(), 1U);
    EXPECT_EQ(camera.frames[1].people[0].keypoints[3], 4.0F);
    EXPECT_EQ(camera.frames[1].people[0].confidence[1], 0.6F);
  }
  MakeDirectory(folder / "images");
  for (int t = 0; t < 2; ++t) {
    WriteFileAtomically(folder / fmt::format("images/{}.json", t),
                        fmt::format(R"({{"predictions": [[{}]]}})", kPerson));
  }
  EXPECT_EQ(ReadAll("mmpose", folder / "images").front().frames.size(), 2U);
}

TEST(OpenPose, NamesMayBeTimes) {
  const TemporaryFolder folder;
  int x = 0;
  for (const char* name : {"9.960", "10.000", "10.040", "10.200"})
    WriteFileAtomically(folder / fmt::format("{}_keypoints.json", name), OpenPoseFrame(fmt::format("{},2,0.5", ++x)));
  const DetectedCamera camera = ReadAll("openpose", folder.path()).front();
  EXPECT_EQ(camera.seconds_per_number, 1e-3);
  ASSERT_EQ(camera.frames.size(), 4U);
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(camera.frames[t].people[0].keypoints[0], static_cast<float>(t + 1));
}

TEST(OpenPose, FoldersAreChecked) {
  const TemporaryFolder folder;
  const auto error = [&] {
    return ErrorOf(ErrorKind::kBadInput, [&] { FindDetectionFormat("openpose").find_cameras(folder.path()); });
  };
  EXPECT_THAT(error(), HasSubstr("found an empty folder"));
  WriteFileAtomically(folder / "readme.txt", "");
  EXPECT_THAT(error(), HasSubstr("found no JSON file"));
  MakeDirectory(folder / "cam1");
  MakeDirectory(folder / "cam2");
  WriteFileAtomically(folder / "calibration.json", "{}");
  WriteFileAtomically(folder.path() / "cam1" / "1.json", OpenPoseFrame("1,2,0.5"));
  EXPECT_THAT(error(), AllOf(HasSubstr("cam2"), HasSubstr("found an empty folder")));
  WriteFileAtomically(folder.path() / "cam2" / "notes.txt", "");
  EXPECT_EQ(FindDetectionFormat("openpose").find_cameras(folder.path()).size(), 1U);
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder / "calibration.json"); }),
              HasSubstr("expected a folder with one JSON file per frame, found a file"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadAll("openpose", folder / "none"); }), HasSubstr("No such file"));
}

TEST(OpenPose, FramesBesideFoldersOfFramesAreRefused) {
  const TemporaryFolder folder;
  MakeDirectory(folder / "cam1");
  WriteFileAtomically(folder.path() / "cam1" / "1.json", OpenPoseFrame("1,2,0.5"));
  WriteFileAtomically(folder / "frame_1.json", OpenPoseFrame("1,2,0.5"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindDetectionFormat("openpose").find_cameras(folder.path()); }),
              AllOf(HasSubstr("found both: frames, and sub-folder cam1"), HasSubstr("`camera` NAME=PATH")));
  fs::rename(folder / "frame_1.json", folder / "calibration_1.json");
  WriteFileAtomically(folder / "calibration_1.json", "{\"cameras\": {}}");
  EXPECT_EQ(FindDetectionFormat("openpose").find_cameras(folder.path()).size(), 1U);
}

TEST(OpenPose, ACameraWithItsFramesInASubfolderIsNotLeftOut) {
  const TemporaryFolder folder;
  MakeDirectory(folder / "cam1");
  WriteFileAtomically(folder.path() / "cam1" / "1.json", OpenPoseFrame("1,2,0.5"));
  MakeDirectory(folder / "cam2/run/json");
  const auto find = [&] { return FindDetectionFormat("openpose").find_cameras(folder.path()); };
  EXPECT_EQ(find().size(), 1U);
  WriteFileAtomically(folder / "cam2/run/json/1.json", OpenPoseFrame("1,2,0.5"));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, find),
              AllOf(HasSubstr("cam2: expected one JSON file per frame"), HasSubstr("frames only below it"),
                    HasSubstr("`camera` cam2=")));
}

TEST(OpenPose, ReadsTheRealRecording) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing");
  const std::vector<DetectedCamera> cameras = ReadAll("openpose", Shared("data/balancing"));
  ASSERT_EQ(cameras.size(), 4U);
  EXPECT_EQ(cameras[3].name, "cam04");
  for (const DetectedCamera& camera : cameras) {
    EXPECT_EQ(camera.keypoint_count, 25);
    EXPECT_EQ(camera.frames.size(), 100U);
  }
  EXPECT_EQ(cameras[0].frames[0].people.size(), 2U);
  EXPECT_FLOAT_EQ(cameras[0].frames[0].people[0].keypoints[0], 505.232F);
  EXPECT_EQ(DetectFormat(Shared("data/balancing")), "openpose");
}

TEST(FlatList, GapsAreFramesWithoutPeople) {
  const TemporaryFolder folder;
  const auto entry = [](int id) {
    return fmt::format(R"({{"image_id":{},"category_id":1,"keypoints":[1,2,0.5]}})", id);
  };
  WriteFileAtomically(folder / "a.json", fmt::format("[{},{},{}]", entry(30), entry(10), entry(15)));
  const DetectedCamera camera = ReadAll("coco", folder / "a.json").front();
  std::vector<std::int64_t> numbers;
  for (const DetectedFrame& frame : camera.frames) numbers.push_back(frame.number);
  EXPECT_THAT(numbers, ElementsAre(10, 15, 20, 25, 30));
  // Ids that are names do not count frames.
  WriteFileAtomically(folder / "b.json", fmt::format("[{},{},{}]", entry(139), entry(1000000), entry(581781)));
  EXPECT_EQ(ReadAll("coco", folder / "b.json").front().frames.size(), 3U);
}

TEST(FlatList, BadContentNamesFileAndPlace) {
  EXPECT_THAT(
      FileError("alphapose", R"([{"image_id":"1.jpg","keypoints":[1,2]}])"),
      AllOf(HasSubstr("cam.json: [0].keypoints: expected a multiple of three values"), HasSubstr("found 2 values")));
  EXPECT_THAT(FileError("alphapose", R"([{"image_id":"left.jpg","keypoints":[1,2,0.5]}])"),
              HasSubstr("[0].image_id: expected a frame number in the name, found \"left.jpg\""));
  EXPECT_THAT(FileError("alphapose", R"([{"keypoints":[1,2,0.5]}])"),
              HasSubstr("found an array of 1 object with keypoints"));
  EXPECT_THAT(FileError("alphapose", "[]"), HasSubstr("expected detections of a person, found no frames"));
  EXPECT_THAT(FileError("alphapose", "{}"), HasSubstr("found no frames"));
  EXPECT_THAT(FileError("alphapose", "3"), HasSubstr("expected AlphaPose's list or object of detections, found 3"));
  EXPECT_THAT(FileError("alphapose", R"({"1.jpg": {"boxes": []}})"),
              HasSubstr("expected AlphaPose's list or object of detections, found an object with 1.jpg"));
  EXPECT_THAT(FileError("coco", R"({"annotations": []})"), HasSubstr("annotation file"));
  EXPECT_THAT(FileError("coco", R"([{"image_id":1.5,"keypoints":[1,2,0.5]}])"), HasSubstr("a whole number"));
  EXPECT_THAT(FileError("coco", R"([{"image_id":9223372036854775807,"keypoints":[1,2,0.5]}])"),
              HasSubstr("a frame number"));
}

TEST(AlphaPose, TrackIdsAreKept) {
  const DetectedCamera camera = ReadAll("alphapose", TestData("detections/alphapose")).front();
  EXPECT_EQ(camera.frames[0].people[0].track_id, 1);
  EXPECT_EQ(camera.frames[1].people[0].track_id, 2);
  EXPECT_DOUBLE_EQ(camera.frames[1].people[0].score, 1.5);
}

TEST(Mmpose, BadContentNamesFileAndPlace) {
  EXPECT_THAT(
      FileError("mmpose", R"([{"frame_id":1,"instances":[{"keypoints":[[1,2],[3,4]],"keypoint_scores":[0.5]}]}])"),
      AllOf(HasSubstr("[0].instances[0].keypoint_scores: expected 2 values"), HasSubstr("found 1 values")));
  EXPECT_THAT(FileError("mmpose", R"([{"frame_id":1,"instances":[{"keypoints":[[1,2,3]],"keypoint_scores":[0.5]}]}])"),
              HasSubstr("[0].instances[0].keypoints[0]: expected two values (x, y)"));
  EXPECT_THAT(
      FileError("mmpose", R"([{"frame_id":1,"instances":[{"keypoints":[[1,2]],"keypoint_scores":[Infinity]}]}])"),
      HasSubstr("expected a finite number, found Infinity"));
  EXPECT_THAT(FileError("mmpose", R"([{"frame_id":1,"instances":[]},{"frame_id":1,"instances":[]}])"),
              HasSubstr("both frame 1"));
  EXPECT_THAT(FileError("mmpose", R"({"meta_info": {}})"),
              AllOf(HasSubstr("an object with instance_info"), HasSubstr("found an object with meta_info")));
  EXPECT_THAT(FileError("mmpose", R"({"instance_info": [{"frame_id": 1, "instances": []}]})"),
              HasSubstr("nobody in any of 1 frames"));
}

constexpr const char* kCamera =
    R"({"K":[[1000,0,320],[0,1000,240],[0,0,1]],"R":[[1,0,0],[0,1,0],[0,0,1]],"t":[1,2,3]})";

std::string CalibrationError(const std::string& text) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "calibration.json", text);
  return ErrorOf(ErrorKind::kBadInput, [&] { ReadCalibration(folder / "calibration.json"); });
}

TEST(Calibration, IsReadInMillimetres) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "c.json",
                      fmt::format(R"({{"units":"m","image_size":[640,480],"cameras":{{"a":{}}}}})", kCamera));
  const std::map<std::string, CalibratedCamera> cameras = ReadCalibration(folder / "c.json");
  const CalibratedCamera& camera = FindCalibration(cameras, "a", "c.json");
  EXPECT_EQ(camera.camera.camera_from_world_translation, Eigen::Vector3d(1000, 2000, 3000));
  EXPECT_EQ(camera.camera.K(0, 2), 320.0);
  EXPECT_EQ(camera.image_size, (std::array<int, 2>{640, 480}));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindCalibration(cameras, "b", "c.json"); }),
              HasSubstr("c.json: cameras: expected camera b, found a"));
}

TEST(Calibration, BadContentNamesThePlace) {
  EXPECT_THAT(CalibrationError(R"({"cameras":{}})"), HasSubstr("cameras: expected at least one camera"));
  EXPECT_THAT(CalibrationError(fmt::format(R"({{"units":"inch","cameras":{{"a":{}}}}})", kCamera)),
              HasSubstr("\"mm\" or \"m\""));
  EXPECT_THAT(CalibrationError(R"({"cameras":{"a":{"K":[[1000,0,320],[0,1000,240]]}}})"),
              HasSubstr("cameras.a.K: expected 3 rows"));
  EXPECT_THAT(CalibrationError(
                  R"({"cameras":{"a":{"K":[[1,0,0],[0,1,0],[0,0,1]],"R":[[1,0,0],[0,1,0],[0,0,-1]],"t":[0,0,0]}}})"),
              AllOf(HasSubstr("cameras.a.R: expected a rotation matrix"), HasSubstr("determinant -1")));
  EXPECT_THAT(CalibrationError(R"({"cameras":{"a":{"K":[[0,0,0],[0,1,0],[0,0,1]]}}})"),
              HasSubstr("cameras.a.K: expected [[fx"));
  EXPECT_THAT(CalibrationError(R"({"cameras":[]})"), HasSubstr("cameras: expected an object"));
}

TEST(Calibration, ReadsTheRealOne) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing/calibration.json");
  const std::map<std::string, CalibratedCamera> cameras = ReadCalibration(Shared("data/balancing/calibration.json"));
  ASSERT_EQ(cameras.size(), 4U);
  EXPECT_NEAR(cameras.at("cam03").camera.camera_from_world_translation.z(), 4353.51, 0.01);
  EXPECT_EQ(cameras.at("cam01").image_size, (std::array<int, 2>{1088, 1920}));
}

}  // namespace
}  // namespace canonpose
