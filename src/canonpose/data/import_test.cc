// From files to datasets; and every bad input of which an import must say what is wrong.
#include "canonpose/data/import.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/log.h"
#include "canonpose/base/testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Shared;
using testing::TemporaryFolder;
using testing::TestData;

constexpr int kFrames = 8;
constexpr int kEmptyFrame = 5;
constexpr int kLeftWrist = 13;  // of h36m-17
constexpr int kFrameWithMissingJoint = 2;

ImportOptions Options(const std::string& format, const fs::path& path) {
  ImportOptions options;
  options.format = format;
  options.paths = {path};
  options.image_size = {640, 480};
  return options;
}

ImportOptions OpenPose() { return Options("openpose", TestData("detections/openpose")); }

std::string ImportError(const ImportOptions& options) {
  return ErrorOf(ErrorKind::kBadInput, [&] { ImportDetections(options); });
}

/// What an import writes to the log.
std::string ImportLog(const ImportOptions& options) {
  const TemporaryFolder folder;
  {
    const LogFile log(folder / "log");
    ImportDetections(options);
  }
  return ReadFile(folder / "log");
}

/// A copy of the OpenPose sample that tests may damage.
class Copy {
 public:
  explicit Copy(const std::string& sample = "openpose") {
    fs::copy(TestData("detections") / sample, folder_ / "in", fs::copy_options::recursive);
    options = Options("openpose", path());
  }
  [[nodiscard]] fs::path path() const { return folder_ / "in"; }
  [[nodiscard]] fs::path Frame(int camera, int frame) const {
    return path() / fmt::format("cam{}", camera) / fmt::format("cam{}_{:012d}_keypoints.json", camera, frame);
  }
  ImportOptions options;

 private:
  TemporaryFolder folder_;
};

TEST(ImportDetections, MissingStaysMissing) {
  const Dataset dataset = ImportDetections(OpenPose());
  EXPECT_EQ(dataset.skeleton.name, "h36m-17");
  EXPECT_EQ(dataset.source.format, "openpose");
  EXPECT_EQ(dataset.source.layout, "body_25");
  EXPECT_EQ(dataset.source.confidence_scale, 1.0);
  ASSERT_EQ(dataset.source.mapping.size(), 17U);
  ASSERT_EQ(dataset.sequences.size(), 1U);
  const Sequence& sequence = dataset.sequences[0];
  EXPECT_EQ(sequence.frame_count, kFrames);
  ASSERT_EQ(sequence.cameras.size(), 2U);
  for (int c = 0; c < 2; ++c) {
    const CameraView& view = sequence.cameras[static_cast<std::size_t>(c)];
    EXPECT_EQ(view.image_size, (std::array<int, 2>{640, 480}));
    for (int i = 0; i < kFrames * 17; ++i) {
      const bool is_missing = c == 0 ? i == kFrameWithMissingJoint * 17 + kLeftWrist : i / 17 == kEmptyFrame;
      const auto at = static_cast<std::size_t>(i);
      EXPECT_EQ(std::isnan(view.keypoints[2 * at]), is_missing) << c << " " << i;
      EXPECT_EQ(view.confidence[at] == 0.0F, is_missing);
      // The main person's confidences are above 0.6, the other's below.
      if (!is_missing) {
        EXPECT_GE(view.confidence[at], 0.6F);
      }
    }
  }
}

TEST(ImportDetections, EveryFormatGivesTheSamePose) {
  const Dataset reference = ImportDetections(OpenPose());
  const Skeleton& skeleton = reference.skeleton;
  for (const auto& [folder, format] : {std::pair("openpose_25b", "openpose"),
                                       std::pair("alphapose", "alphapose"),
                                       std::pair("alphapose_136", "alphapose"),
                                       std::pair("alphapose_open", "alphapose"),
                                       std::pair("alphapose_cmu", "alphapose"),
                                       std::pair("alphapose_sep", "alphapose"),
                                       std::pair("mmpose_video", "mmpose"),
                                       std::pair("mmpose_demo", "mmpose"),
                                       std::pair("mmpose_images", "mmpose"),
                                       std::pair("coco", "coco"),
                                       std::pair("mmpose_133", "mmpose"),
                                       std::pair("deeplabcut", "deeplabcut"),
                                       std::pair("deeplabcut_table", "deeplabcut"),
                                       std::pair("deeplabcut_fixed", "deeplabcut"),
                                       std::pair("sleap", "sleap"),
                                       std::pair("sleap_standard", "sleap"),
                                       std::pair("mediapipe_csv", "mediapipe"),
                                       std::pair("mediapipe_json", "mediapipe"),
                                       std::pair("ultralytics_txt", "ultralytics"),
                                       std::pair("ultralytics_json", "ultralytics"),
                                       std::pair("freemocap", "freemocap")}) {
    const Dataset dataset = ImportDetections(Options(format, TestData("detections") / folder));
    ASSERT_EQ(dataset.sequences[0].frame_count, kFrames) << folder;
    for (std::size_t c = 0; c < 2; ++c) {
      const std::vector<float>& one = reference.sequences[0].cameras[c].keypoints;
      const std::vector<float>& other = dataset.sequences[0].cameras[c].keypoints;
      ASSERT_EQ(one.size(), other.size());
      for (std::size_t i = 0; i < one.size(); ++i) {
        const std::string& joint = skeleton.joints[i / 2 % 17];
        // These are derived in some layouts and found in others.
        if (joint == "Head" || joint == "Hip" || joint == "Spine" || joint == "Thorax") continue;
        EXPECT_EQ(std::isnan(one[i]), std::isnan(other[i])) << folder << " " << joint;
        if (!std::isnan(one[i])) {
          // Ultralytics writes six digits of a fraction of the image.
          EXPECT_NEAR(one[i], other[i], std::string(folder) == "ultralytics_txt" ? 1e-3 : 2e-4)
              << folder << " " << joint;
        }
      }
    }
  }
}

TEST(ImportDetections, ConfidencesAboveOneAreScaled) {
  const ImportOptions options = Options("alphapose", TestData("detections/alphapose"));
  const Dataset dataset = ImportDetections(options);
  EXPECT_GT(dataset.source.confidence_scale, 3.0);
  EXPECT_LE(dataset.source.confidence_scale, 4.0);
  float largest = 0.0F;
  for (const CameraView& view : dataset.sequences[0].cameras) {
    for (const float c : view.confidence) largest = std::max(largest, c);
  }
  EXPECT_LE(largest, 1.0F);
  EXPECT_GT(largest, 0.9F);
  EXPECT_THAT(ImportLog(options), HasSubstr("all are divided by this value"));
}

TEST(ImportDetections, AnAbsurdConfidenceIsRefused) {
  const auto error_with = [](const std::string& confidence) {
    const Copy copy;
    std::string text = ReadFile(copy.Frame(2, 3));
    const std::size_t begin = text.find("pose_keypoints_2d");
    const std::size_t first = text.find(',', text.find(',', begin) + 1) + 1;  // the confidence of keypoint 0
    text.replace(first, text.find(',', first) - first, confidence);
    WriteFileAtomically(copy.Frame(2, 3), text);
    return ImportError(copy.options);
  };
  EXPECT_THAT(error_with("1e6"),
              AllOf(HasSubstr("in/cam2: frame 3 (cam2_000000000003_keypoints.json), person 0, keypoint 0"),
                    HasSubstr("never above 100, found 1e+06")));
  EXPECT_THAT(error_with("60.5"), AllOf(HasSubstr("99 % of which are at most"), HasSubstr("found 60.5")));
}

TEST(ImportDetections, LargeConfidencesOfAlphaPoseAreAccepted) {
  const TemporaryFolder folder;
  fs::copy(TestData("detections/alphapose"), folder / "in", fs::copy_options::recursive);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "in")) {
    if (entry.is_regular_file()) {
      // The largest documented value among the sample's 1 to 4.
      std::string text = ReadFile(entry.path());
      const std::size_t begin = text.find("\"keypoints\"");
      const std::size_t first = text.find(',', text.find(',', begin) + 1) + 1;
      text.replace(first, text.find(',', first) - first, "6.5");
      WriteFileAtomically(entry.path(), text);
    }
  }
  EXPECT_NEAR(ImportDetections(Options("alphapose", folder / "in")).source.confidence_scale, 6.5, 1e-6);
}

TEST(ImportDetections, OptionsReachTheSequence) {
  ImportOptions options = OpenPose();
  options.name = "walk";
  options.subject = "S1";
  options.fps = 25.0;
  options.moving_cameras = true;
  options.skeleton = "native";
  options.camera_image_size["cam2"] = {800, 600};
  const Dataset dataset = ImportDetections(options);
  EXPECT_EQ(dataset.skeleton.name, "body_25");
  const Sequence& sequence = dataset.sequences[0];
  EXPECT_EQ(sequence.name, "walk");
  EXPECT_EQ(sequence.subject, "S1");
  EXPECT_EQ(sequence.fps, 25.0);
  EXPECT_FALSE(sequence.static_cameras);
  EXPECT_THAT(sequence.capture, HasSubstr("walk-"));
  EXPECT_EQ(sequence.cameras[0].image_size[0], 640);
  EXPECT_EQ(sequence.cameras[1].image_size[0], 800);
  options.capture = "monday";
  EXPECT_EQ(ImportDetections(options).sequences[0].capture, "monday");
}

TEST(ImportDetections, AnotherPersonCanBeChosen) {
  ImportOptions options = OpenPose();
  options.camera_person["cam1"] = 2;
  const Dataset dataset = ImportDetections(options);
  EXPECT_LT(dataset.sequences[0].cameras[0].confidence[0], 0.6F);
  EXPECT_GE(dataset.sequences[0].cameras[1].confidence[0], 0.6F);
  options.person = 9;
  EXPECT_THAT(ImportError(options), HasSubstr("expected 9 people in camera cam2"));
  options.camera_person["cam7"] = 1;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { ImportDetections(options); }),
              HasSubstr("`person` names camera cam7"));
}

TEST(ImportDetections, CamerasCanBeNamed) {
  ImportOptions options = OpenPose();
  options.cameras = {{"left", TestData("detections/openpose/cam2")}};
  const Dataset renamed = ImportDetections(options);
  EXPECT_EQ(renamed.sequences[0].cameras[1].name, "left");
  options.paths.clear();
  options.cameras.push_back({"right", TestData("detections/openpose/cam1")});
  const Dataset named = ImportDetections(options);
  EXPECT_EQ(named.sequences[0].cameras[1].name, "right");
  options.cameras[0].path = TestData("detections/openpose");
  EXPECT_THAT(ImportError(options), HasSubstr("expected one camera for left, found 2 cameras"));
  options.cameras[0] = {"a/b", TestData("detections/openpose/cam2")};
  EXPECT_THAT(ImportError(options), HasSubstr("without '/'"));
}

TEST(ImportDetections, OneCameraIsRefused) {
  EXPECT_THAT(ImportError(Options("openpose", TestData("detections/openpose/cam1"))),
              AllOf(HasSubstr("openpose/cam1: expected at least two cameras, found one, cam1")));
  ImportOptions options = Options("openpose", TestData("detections/openpose/cam1"));
  options.paths.push_back(TestData("detections/openpose/cam1"));
  EXPECT_THAT(ImportError(options), HasSubstr("expected another name for each camera"));
}

TEST(ImportDetections, OneCameraUnderTwoNamesIsRefused) {
  ImportOptions options = OpenPose();
  options.paths.clear();
  options.cameras = {{"left", TestData("detections/openpose/cam1")}, {"right", TestData("detections/openpose/cam1")}};
  EXPECT_THAT(ImportError(options), HasSubstr("the same for cameras left and right"));
  const Copy linked;
  fs::create_directory_symlink(linked.path() / "cam1", linked.path() / "cam3");
  EXPECT_THAT(ImportError(linked.options), HasSubstr("the same for cameras cam1 and cam3"));
}

TEST(ImportDetections, CamerasWithTheSameKeypointsAreRefused) {
  const Copy copy;
  fs::copy(copy.path() / "cam1", copy.path() / "cam3", fs::copy_options::recursive);
  EXPECT_THAT(ImportError(copy.options), AllOf(HasSubstr("in/cam3: expected camera cam3 to have its own keypoints"),
                                               HasSubstr("those of camera cam1"), HasSubstr("in every frame")));
}

TEST(ImportDetections, EmptyFoldersAreRefused) {
  const TemporaryFolder folder;
  for (const char* format : {"openpose", "alphapose", "mmpose", "coco"}) {
    EXPECT_THAT(ImportError(Options(format, folder.path())),
                AllOf(HasSubstr(folder.path().string()), HasSubstr("empty folder")));
  }
}

TEST(ImportDetections, DamagedFilesAreNamed) {
  for (const auto& [text, found] :
       {std::pair("{\"version\":1.3,\"people\":[{\"pose_key", "found the end of the file"),
        std::pair("{\"people\":[{\"pose_keypoints_2d\":[1,2,Infinity]}]}", "expected a finite number, found Infinity"),
        std::pair("{\"people\":[{\"pose_keypoints_2d\":[1,2]}]}", "expected a multiple of three values"),
        std::pair("{\"people\":[{\"pose_keypoints_2d\":[1,2,0.3]}]}", "expected 25 keypoints")}) {
    const Copy copy;
    WriteFileAtomically(copy.Frame(2, 3), text);
    EXPECT_THAT(ImportError(copy.options), AllOf(HasSubstr(copy.Frame(2, 3).string()), HasSubstr(found)));
  }
}

TEST(ImportDetections, LostFramesAreMissing) {
  Copy copy;
  fs::remove(copy.Frame(2, 3));
  fs::remove(copy.Frame(2, 7));
  const Dataset dataset = ImportDetections(copy.options);
  const Dataset whole = ImportDetections(OpenPose());
  ASSERT_EQ(dataset.sequences[0].frame_count, kFrames);
  const CameraView& view = dataset.sequences[0].cameras[1];
  for (std::size_t t = 0; t < kFrames; ++t) {
    const bool is_missing = t == 3 || t == 7 || t == kEmptyFrame;
    EXPECT_EQ(std::isnan(view.keypoints[t * 34]), is_missing) << t;
    if (!is_missing) {
      EXPECT_EQ(view.keypoints[t * 34], whole.sequences[0].cameras[1].keypoints[t * 34]);
    }
  }
  EXPECT_THAT(ImportLog(copy.options),
              HasSubstr("matched by the numbers in their names, 0 to 7; missing of 8: cam2 2"));
  EXPECT_THAT(ImportLog(OpenPose()), Not(HasSubstr("matched")));
  copy.options.alignment = FrameAlignment::kOrder;
  EXPECT_THAT(ImportError(copy.options), AllOf(HasSubstr("cam1 has 8 frames (0 to 7), cam2 has 6 frames (0 to 6)"),
                                               HasSubstr("`align` frame-number")));
}

TEST(ImportDetections, NamesThatAreTimesGiveTheFrameRate) {
  Copy copy;
  for (int camera = 1; camera <= 2; ++camera) {
    for (int t = 0; t < kFrames; ++t) {
      const double time = 1714564803.9 + 0.02 * t + 0.001 * camera;
      fs::rename(copy.Frame(camera, t), copy.path() / fmt::format("cam{}/{:.6f}.json", camera, time));
    }
  }
  const Dataset dataset = ImportDetections(copy.options);
  EXPECT_NEAR(dataset.sequences[0].fps, 50.0, 1e-3);
  EXPECT_EQ(dataset.Fingerprint(), ImportDetections(OpenPose()).Fingerprint());
  EXPECT_THAT(ImportLog(copy.options), HasSubstr("matched by the times in their names, 50 frames per second"));
  copy.options.fps = 25.0;
  EXPECT_EQ(ImportDetections(copy.options).sequences[0].fps, 25.0);
  EXPECT_THAT(ImportLog(copy.options), HasSubstr("warning"));
  EXPECT_THAT(ImportLog(copy.options), HasSubstr("`fps` is 25, but the times of the frames say 50"));
  SingleCameraOptions single;
  const SingleCamera camera = ReadSingleCamera(copy.path() / "cam1", single);
  EXPECT_NEAR(camera.fps, 50.0, 1e-3);
  EXPECT_EQ(camera.frame_numbers.back(), kFrames - 1);
}

/// Writes what `detect` says of a camera's video, with a time for each of the sample's frames.
void WriteVideoFacts(const Copy& copy, int camera, double fps, const std::array<int, 2>& size = {640, 480}) {
  nlohmann::json facts{{"format", "canonpose-video"}, {"version", 1}, {"image_size", size}, {"fps", fps}};
  for (int t = 0; t < kFrames; ++t) facts["time_stamps"].push_back(t / fps);
  WriteFileAtomically(copy.path() / fmt::format("cam{}/video.json", camera), facts.dump());
}

TEST(ImportDetections, SizesAndRatesComeFromVideoJson) {
  Copy copy;
  copy.options.image_size = {0, 0};
  const int cameras = static_cast<int>(ImportDetections(OpenPose()).sequences[0].cameras.size());
  for (int c = 1; c <= cameras; ++c) WriteVideoFacts(copy, c, 29.97);
  EXPECT_THAT(ImportLog(copy.options), Not(HasSubstr("no keypoints"))) << "video.json is no lost frame";
  const Sequence sequence = ImportDetections(copy.options).sequences[0];
  EXPECT_EQ(sequence.fps, 29.97);
  EXPECT_EQ(sequence.frame_count, kFrames);
  for (const CameraView& view : sequence.cameras) EXPECT_EQ(view.image_size, (std::array<int, 2>{640, 480}));
}

TEST(ImportDetections, VideosOfDifferentRatesAreMatchedByTime) {
  Copy copy;
  copy.options.image_size = {0, 0};
  const int cameras = static_cast<int>(ImportDetections(OpenPose()).sequences[0].cameras.size());
  for (int c = 1; c <= cameras; ++c) WriteVideoFacts(copy, c, c == 2 ? 25.0 : 50.0);
  const Sequence sequence = ImportDetections(copy.options).sequences[0];
  EXPECT_NEAR(sequence.fps, 50.0, 1e-6);
  EXPECT_EQ(sequence.frame_count, 2 * kFrames - 1) << "as long as the slowest";
}

TEST(ImportDetections, ACalibrationOfAnotherImageSizeIsReported) {
  Copy copy;
  copy.options.image_size = {0, 0};
  const int cameras = static_cast<int>(ImportDetections(OpenPose()).sequences[0].cameras.size());
  nlohmann::json calibration{{"image_size", {648, 480}}, {"cameras", nlohmann::json::object()}};
  for (int c = 1; c <= cameras; ++c) {
    WriteVideoFacts(copy, c, 50.0);
    calibration["cameras"][fmt::format("cam{}", c)] = {{"K", {{600, 0, 320}, {0, 600, 240}, {0, 0, 1}}},
                                                       {"R", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                                                       {"t", {33.0 * c, 0, 1000}},
                                                       {"distortion", {0, 0, 0, 0}}};
  }
  WriteFileAtomically(copy.path() / "calibration.json", calibration.dump());
  copy.options.calibration = copy.path() / "calibration.json";
  EXPECT_THAT(ImportLog(copy.options),
              AllOf(HasSubstr("camera cam1 is calibrated for images of 648x480 pixels"), HasSubstr("640x480")));
}

TEST(ImportDetections, ADetectionFoundTwiceChangesNothing) {
  const Copy copy;
  for (int t = 0; t < kFrames; t += 2) {
    std::string text = ReadFile(copy.Frame(1, t));
    const std::size_t begin = text.find('{', text.find("people"));
    int depth = 0;
    std::size_t end = begin;
    do {
      depth += text[end] == '{' ? 1 : text[end] == '}' ? -1 : 0;
      ++end;
    } while (depth > 0);
    WriteFileAtomically(copy.Frame(1, t), text.insert(begin, text.substr(begin, end - begin) + ","));
  }
  EXPECT_EQ(ImportDetections(copy.options).Fingerprint(), ImportDetections(OpenPose()).Fingerprint());
  EXPECT_THAT(ImportLog(copy.options), HasSubstr("cam1: in 4 frames one person was found twice"));
}

TEST(ImportDetections, HandsAndFaceGetOneWord) {
  const std::string log = ImportLog(Options("alphapose", TestData("detections/alphapose_136")));
  const std::string line = "the keypoints of face, hands are left out; only those of the body are read";
  EXPECT_THAT(log, HasSubstr(line));
  EXPECT_EQ(log.find(line), log.rfind(line));
  EXPECT_THAT(ImportLog(OpenPose()), Not(HasSubstr("left out")));
}

TEST(ImportDetections, NoCommonFrameNumberIsRefused) {
  Copy copy;
  for (int t = 0; t < kFrames; ++t) fs::rename(copy.Frame(2, t), copy.Frame(2, t + 100));
  copy.options.alignment = FrameAlignment::kFrameNumber;
  EXPECT_THAT(ImportError(copy.options), HasSubstr("expected frame numbers that another camera also has"));
}

TEST(ImportDetections, ACameraWithoutDetectionsIsRefused) {
  const Copy copy;
  for (int t = 0; t < kFrames; ++t) WriteFileAtomically(copy.Frame(2, t), R"({"version":1.3,"people":[]})");
  EXPECT_THAT(ImportError(copy.options),
              AllOf(HasSubstr("in/cam2: expected detections of a person, found nobody in any of 8 frames"),
                    HasSubstr("camera cam2")));
}

TEST(ImportDetections, TheWrongLayoutIsRefused) {
  ImportOptions options = OpenPose();
  options.layout = "body_25b";
  EXPECT_THAT(ImportError(options), HasSubstr("use `layout` body_25,"));
  options.paths = {TestData("detections/openpose_25b")};
  options.layout = "body-25";
  EXPECT_THAT(ImportError(options), HasSubstr("use `layout` body_25b,"));
  options.layout = "coco-17";
  EXPECT_THAT(ImportError(options), HasSubstr("expected 17 keypoints for layout coco-17, found 25"));
  options.layout = "body_135";
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { ImportDetections(options); }),
              HasSubstr("there is no layout"));
}

TEST(ImportDetections, CamerasOfDifferentLayoutsAreRefused) {
  const Copy copy;
  fs::remove_all(copy.path() / "cam2");
  fs::copy(TestData("detections/openpose_25b/cam2"), copy.path() / "cam2", fs::copy_options::recursive);
  EXPECT_THAT(ImportError(copy.options), HasSubstr("camera cam2 has another"));
}

TEST(ImportDetections, FractionsOfTheImageAreRefused) {
  const Copy copy("openpose");
  for (int camera = 1; camera <= 2; ++camera) {
    for (int t = 0; t < kFrames; ++t) {
      std::string values;
      for (int k = 0; k < 25; ++k)
        values += fmt::format("{}{:.3f},{:.3f},0.5", k == 0 ? "" : ",", 0.3 + 0.01 * k, 0.9 - 0.02 * k);
      WriteFileAtomically(copy.Frame(camera, t), fmt::format(R"({{"people":[{{"pose_keypoints_2d":[{}]}}]}})", values));
    }
  }
  EXPECT_THAT(ImportError(copy.options),
              AllOf(HasSubstr("expected coordinates in pixels"), HasSubstr("keypoint_scale")));
}

TEST(ImportDetections, TheImageSizeIsNeeded) {
  ImportOptions options = OpenPose();
  options.image_size = {0, 0};
  EXPECT_THAT(ImportError(options),
              AllOf(HasSubstr("expected the image size of camera cam1"), HasSubstr("`image_size`")));
  options.camera_image_size["cam1"] = {640, 480};
  EXPECT_THAT(ImportError(options), HasSubstr("expected the image size of camera cam2"));
}

TEST(ImportDetections, KeypointsOutsideTheImageAreAWarning) {
  ImportOptions options = OpenPose();
  EXPECT_THAT(ImportLog(options), Not(HasSubstr("far outside")));
  options.image_size = {320, 240};
  EXPECT_THAT(ImportLog(options),
              AllOf(HasSubstr("lie far outside an image of 320x240"), HasSubstr("width comes first")));
}

TEST(ImportDetections, ACalibrationMustContainEveryCamera) {
  const TemporaryFolder folder;
  ImportOptions options = OpenPose();
  options.image_size = {0, 0};
  options.calibration = folder / "calibration.json";
  const std::string camera = R"({"K":[[600,0,320],[0,600,240],[0,0,1]],"R":[[1,0,0],[0,1,0],[0,0,1]],"t":[1,2,3]})";
  WriteFileAtomically(options.calibration,
                      fmt::format(R"({{"image_size":[640,480],"cameras":{{"cam1":{}}}}})", camera));
  EXPECT_THAT(ImportError(options), HasSubstr("cameras: expected camera cam2, found cam1"));
  WriteFileAtomically(options.calibration, fmt::format(R"({{"cameras":{{"cam1":{0},"cam2":{0}}}}})", camera));
  EXPECT_THAT(ImportError(options), HasSubstr("image_size: expected width and height, found nothing"));
  WriteFileAtomically(options.calibration,
                      fmt::format(R"({{"image_size":[640,480],"cameras":{{"cam1":{0},"cam2":{0}}}}})", camera));
  const Dataset dataset = ImportDetections(options);
  EXPECT_TRUE(dataset.HasCalibration());
  EXPECT_EQ(dataset.sequences[0].cameras[1].image_size[1], 480);
}

TEST(ImportDetections, OptionsAreChecked) {
  const auto usage = [](auto change) {
    ImportOptions options = OpenPose();
    change(options);
    return ErrorOf(ErrorKind::kInvalidArgument, [&] { ImportDetections(options); });
  };
  EXPECT_THAT(usage([](ImportOptions& o) { o.format = "kinect"; }), HasSubstr("the formats are openpose"));
  EXPECT_THAT(usage([](ImportOptions& o) { o.paths.clear(); }), HasSubstr("give the paths"));
  EXPECT_THAT(usage([](ImportOptions& o) { o.person = 0; }), HasSubstr("`person` counts from 1"));
  EXPECT_THAT(usage([](ImportOptions& o) { o.skeleton = "x"; }), HasSubstr("there is no skeleton"));
  EXPECT_THAT(usage([](ImportOptions& o) { o.fps = -1.0; }), HasSubstr("`fps`"));
  EXPECT_THAT(usage([](ImportOptions& o) { o.name = "a/b"; }), HasSubstr("not a valid name for a sequence"));
  EXPECT_THAT(usage([](ImportOptions& o) {
                o.camera_image_size["x"] = {1, 1};
              }),
              HasSubstr("`image_size` names camera x"));
}

TEST(ParseImageSize, TakesWidthAndHeight) {
  EXPECT_EQ(ParseImageSize("1920x1080"), (std::array<int, 2>{1920, 1080}));
  for (const char* text : {"", "1920", "x", "1920x", "0x5", "-1x5", "1920x1080p", "1920 1080", "99999999999x5"}) {
    EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { ParseImageSize(text); }), HasSubstr("not an image size"));
  }
}

TEST(ImportDetections, SurvivesTheDatasetFile) {
  const TemporaryFolder folder;
  const Dataset dataset = ImportDetections(OpenPose());
  WriteDataset(folder / "data.h5", dataset);
  const Dataset read = ReadDataset(folder / "data.h5");
  EXPECT_EQ(read.Fingerprint(), dataset.Fingerprint());
  EXPECT_EQ(read.source.layout, "body_25");
  EXPECT_EQ(read.source.mapping, dataset.source.mapping);
  EXPECT_EQ(read.sequences[0].capture, dataset.sequences[0].capture);
}

TEST(ImportDetections, ACalibrationThatCannotBeTrueIsNamed) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing");
  const TemporaryFolder folder;
  ImportOptions options;
  options.format = "openpose";
  options.paths = {Shared("data/balancing")};
  options.image_size = {1088, 1920};
  options.calibration = folder / "calibration.json";
  const auto calibration = nlohmann::json::parse(ReadFile(Shared("data/balancing/calibration.json")));
  const auto write = [&](const nlohmann::json& changed) { WriteFileAtomically(options.calibration, changed.dump()); };

  auto interchanged = calibration;
  std::swap(interchanged["cameras"]["cam02"], interchanged["cameras"]["cam04"]);
  write(interchanged);
  EXPECT_THAT(ImportError(options), AllOf(HasSubstr("calibration.json: calibration: "),
                                          HasSubstr("cam02 and cam04 interchanged"), HasSubstr("px off")));

  const auto scaled = [&](double factor) {
    auto changed = calibration;
    for (auto& camera : changed["cameras"]) {
      for (auto& value : camera["t"]) value = factor * value.get<double>();
    }
    return changed;
  };
  for (const auto& [factor, unit] : {std::pair(0.001, "metres"), {0.1, "centimetres"}}) {
    write(scaled(factor));
    EXPECT_THAT(ImportLog(options), HasSubstr(std::string("calibration.json: the calibration's t is in ") + unit));
  }
  write(scaled(10.0));
  EXPECT_THAT(ImportError(options), HasSubstr("one of 16."));
}

TEST(ImportDetections, ReadsTheRealRecording) {
  CANONPOSE_SKIP_WITHOUT_SHARED("data/balancing");
  ImportOptions options;
  options.format = "openpose";
  options.paths = {Shared("data/balancing")};
  options.calibration = Shared("data/balancing/calibration.json");
  const Dataset dataset = ImportDetections(options);
  EXPECT_EQ(dataset.source.layout, "body_25b");
  EXPECT_EQ(dataset.sequences[0].frame_count, 100);
  EXPECT_TRUE(dataset.HasCalibration());
  for (const CameraView& view : dataset.sequences[0].cameras) {
    EXPECT_EQ(view.image_size, (std::array<int, 2>{1088, 1920}));
    int seen = 0;
    for (const float c : view.confidence) seen += c > 0.0F ? 1 : 0;
    EXPECT_GT(seen, 1600) << view.name;
  }
}

TEST(ImportDetections, KeypointsOfASmallerVideoAreAWarning) {
  const fs::path recording = fs::path(CANONPOSE_SHARED) / "data" / "balancing";
  if (!fs::exists(recording)) GTEST_SKIP() << "no " << recording;
  ImportOptions options = Options("openpose", recording);
  options.image_size = {1088, 1920};
  EXPECT_THAT(ImportLog(options), Not(HasSubstr("as in images of")));
  options.image_size = {2176, 3840};
  EXPECT_THAT(ImportLog(options), HasSubstr("as in images of 1088x1920 pixels, not 2176x3840: check `image_size`"));
}

TEST(ReadSingleCamera, ReadsAsTheImportDid) {
  for (const auto& [folder, format] : {std::pair("openpose", "openpose"), std::pair("alphapose", "alphapose"),
                                       std::pair("mmpose_video", "mmpose"), std::pair("coco", "coco")}) {
    const fs::path path = TestData("detections") / folder;
    const Dataset dataset = ImportDetections(Options(format, path));
    for (const bool is_given : {true, false}) {
      SingleCameraOptions options;
      options.camera = dataset.sequences[0].cameras[1].name;
      options.skeleton = dataset.skeleton;
      options.confidence_scale = dataset.source.confidence_scale;
      if (is_given) options.format = dataset.source.format;
      if (is_given) options.layout = dataset.source.layout;
      const SingleCamera single = ReadSingleCamera(path, options);
      const CameraView& view = dataset.sequences[0].cameras[1];
      EXPECT_EQ(single.view.name, view.name);
      EXPECT_THAT(single.view.keypoints, ::testing::Pointwise(::testing::NanSensitiveFloatEq(), view.keypoints));
      EXPECT_EQ(single.view.confidence, view.confidence);
      EXPECT_EQ(single.frame_numbers.size(), static_cast<std::size_t>(kFrames));
      EXPECT_EQ(single.source.layout, dataset.source.layout);
    }
  }
}

TEST(ReadSingleCamera, WithSeveralCamerasOneMustBeChosen) {
  SingleCameraOptions options;
  const fs::path path = TestData("detections/openpose");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadSingleCamera(path, options); }),
              AllOf(HasSubstr("the cameras cam1, cam2"), HasSubstr("`camera` NAME")));
  options.camera = "cam9";
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadSingleCamera(path, options); }),
              HasSubstr("expected camera cam9"));
  options.camera.clear();
  const SingleCamera single = ReadSingleCamera(path / "cam1", options);
  EXPECT_EQ(single.skeleton.name, "body_25");
}

TEST(ReadSingleCamera, TheImageSizeIsCheckedAsInAnImport) {
  const fs::path path = TestData("detections/openpose/cam1");
  const auto said = [&](std::array<int, 2> size) {
    const testing::CollectedMessages messages;
    SingleCameraOptions options;
    options.image_size = size;
    EXPECT_EQ(ReadSingleCamera(path, options).view.image_size, size);
    return messages.text();
  };
  EXPECT_THAT(said({640, 480}), Not(HasSubstr("warning")));
  EXPECT_THAT(said({100, 200}), AllOf(HasSubstr("lie far outside an image of 100x200"), HasSubstr("`image_size`")));
  EXPECT_THAT(said({0, 0}), Not(HasSubstr("warning")));
}

TEST(ReadSingleCamera, ANamedCameraMustExist) {
  SingleCameraOptions options;
  options.camera = "cam9";
  const fs::path path = TestData("detections/openpose/cam1");
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { ReadSingleCamera(path, options); }),
              AllOf(HasSubstr("expected camera cam9, found the camera cam1"), HasSubstr("leave out `camera`")));
  options.camera = "cam1";
  EXPECT_EQ(ReadSingleCamera(path, options).view.name, "cam1");
}

TEST(ImportDetections, KeepsEverybody) {
  ImportOptions options = OpenPose();
  const Dataset one = ImportDetections(options);
  options.everybody = true;
  const Dataset all = ImportDetections(options);
  ASSERT_TRUE(all.sequences.front().HasTracks());
  EXPECT_EQ(all.skeleton.joints, one.skeleton.joints);
  EXPECT_EQ(all.source.layout, one.source.layout);
  EXPECT_NE(all.Fingerprint(), one.Fingerprint());
  for (std::size_t c = 0; c < one.sequences.front().cameras.size(); ++c) {
    const CameraView& view = all.sequences.front().cameras[c];
    const CameraView& followed = one.sequences.front().cameras[c];
    EXPECT_EQ(view.image_size, followed.image_size);
    ASSERT_FALSE(view.tracks.empty());
    EXPECT_EQ(view.tracks.front().confidence, followed.confidence) << "the most prominent person comes first";
    for (const float confidence : view.confidence) EXPECT_EQ(confidence, 0.0F);
  }
}

TEST(ImportDetections, EverybodyAndOnePersonContradict) {
  ImportOptions options = OpenPose();
  options.everybody = true;
  options.camera_person["cam1"] = 2;
  EXPECT_THAT(ErrorOf(ErrorKind::kInvalidArgument, [&] { ImportDetections(options); }), HasSubstr("`person`"));
}

}  // namespace
}  // namespace canonpose
