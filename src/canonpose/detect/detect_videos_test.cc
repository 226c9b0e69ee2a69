#include "canonpose/detect/detect_videos.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/readers/openpose.h"
#include "canonpose/data/readers/video_facts.h"
#include "canonpose/detect/detect_testing.h"
#include "canonpose/video/video_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::SizeIs;

/// A detector that reads the frame's number from its brightness and sees one walker; counts its questions.
class NumberNetwork final : public PoseNetwork {
 public:
  explicit NumberNetwork(std::atomic<int>& questions) : questions_(questions) {}

  std::vector<DetectedPose> FindPeople(const cv::Mat& image) override { return {Walker(image)}; }
  DetectedPose PoseInCrop(const cv::Mat& image, const Crop&) override { return Walker(image); }
  Appearance AppearanceOf(const cv::Mat&, const DetectedPose&) override { return {}; }

 private:
  DetectedPose Walker(const cv::Mat& image) {
    ++questions_;
    return testing::StandingPerson(100.0F + static_cast<float>(testing::NumberOf(image)), 120.0F, 40.0F);
  }

  std::atomic<int>& questions_;
};

class DetectVideosTest : public ::testing::Test {
 protected:
  DetectVideosTest() {
    testing::WriteNumberedVideo(folder_ / "a.avi", 20, 25.0, {320, 240});
    testing::WriteNumberedImages(folder_ / "b", 12, {320, 240});
    options_.videos = {(folder_ / "a.avi").string(), (folder_ / "b").string()};
    options_.output = folder_ / "out";
    options_.image_fps = 50.0;
    options_.threads = 2;
    detector_ = {[this] { return std::make_unique<NumberNetwork>(questions_); }, "a test's", 1};
  }

  /// Every file of a folder with its contents.
  static std::map<std::string, std::string> Contents(const fs::path& folder) {
    std::map<std::string, std::string> contents;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      contents[entry.path().filename().string()] = ReadFile(entry.path());
    }
    return contents;
  }

  testing::TemporaryFolder folder_;
  DetectOptions options_;
  Detector detector_;
  std::atomic<int> questions_ = 0;
};

TEST_F(DetectVideosTest, WritesAFolderPerVideo) {
  const DetectReport report = DetectVideos(options_, detector_);
  EXPECT_FALSE(report.stopped);
  ASSERT_THAT(report.videos, SizeIs(2));
  EXPECT_EQ(report.videos[0].name, "a");
  EXPECT_EQ(report.videos[0].frames, 20);
  EXPECT_EQ(report.videos[0].people, 1);
  EXPECT_EQ(report.videos[1].name, "b");
  EXPECT_DOUBLE_EQ(report.videos[1].fps, 50.0);
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(options_.output))
    names.insert(entry.path().filename());
  EXPECT_THAT(names, ElementsAre("a", "b")) << "no journal is left";
  const DetectedCamera camera = ReadOpenPose({"a", options_.output / "a"});
  ASSERT_THAT(camera.frames, SizeIs(20));
  for (int t = 0; t < 20; ++t) {
    ASSERT_THAT(camera.frames[static_cast<std::size_t>(t)].people, SizeIs(1));
    EXPECT_NEAR(camera.frames[static_cast<std::size_t>(t)].people[0].keypoints[0], 100 + t, 0.01);
  }
  EXPECT_THAT(ReadVideoFacts(options_.output / "a")->times_seconds, SizeIs(20));
}

TEST_F(DetectVideosTest, GoesOnWhereItWasStoppedWithTheSameResult) {
  options_.threads = 1;
  DetectVideos(options_, detector_);
  const auto whole = Contents(options_.output / "a");
  const int all_questions = questions_;

  options_.output = folder_ / "again";
  questions_ = 0;
  {
    Callbacks callbacks;
    callbacks.stop = [&] { return questions_ >= all_questions / 3; };
    const CallbackScope scope(callbacks);
    EXPECT_TRUE(DetectVideos(options_, detector_).stopped);
  }
  EXPECT_FALSE(fs::exists(options_.output / "a")) << "nothing unfinished can be taken for a result";
  // As where the power fails while a line is written.
  std::ofstream(options_.output / ".a.journal", std::ios::app) << "[[1,[3.0";
  const int before = questions_;
  testing::CollectedMessages messages;
  EXPECT_FALSE(DetectVideos(options_, detector_).stopped);
  EXPECT_THAT(messages.text(), HasSubstr("a: goes on after frame"));
  EXPECT_EQ(Contents(options_.output / "a"), whole);
  EXPECT_LT(questions_ - before, all_questions);
  EXPECT_EQ(questions_, all_questions) << "no question was asked twice";
}

TEST_F(DetectVideosTest, KeepsTheWorkOfARunWithOtherOptions) {
  options_.threads = 1;
  {
    Callbacks callbacks;
    callbacks.stop = [&] { return questions_ >= 10; };
    const CallbackScope scope(callbacks);
    EXPECT_TRUE(DetectVideos(options_, detector_).stopped);
  }
  const std::string journal = ReadFile(options_.output / ".a.journal");
  const int questions = questions_;
  DetectOptions other = options_;
  other.tracker.search_interval = 5;
  EXPECT_THAT(
      testing::ErrorOf(ErrorKind::kBadInput, [&] { (void)DetectVideos(other, detector_); }),
      AllOf(HasSubstr(".a.journal"), HasSubstr("search every 5"), HasSubstr("search every 15"), HasSubstr("remove ")));
  EXPECT_EQ(questions_, questions);
  EXPECT_EQ(ReadFile(options_.output / ".a.journal"), journal);
  EXPECT_FALSE(DetectVideos(options_, detector_).stopped);
}

TEST_F(DetectVideosTest, LeavesFinishedVideosAloneAndRefusesOthers) {
  DetectVideos(options_, detector_);
  const int questions = questions_;
  const DetectReport again = DetectVideos(options_, detector_);
  EXPECT_TRUE(again.videos[0].was_there);
  EXPECT_EQ(questions_, questions);

  detector_.fingerprint = 2;
  const auto message = [&] {
    return testing::ErrorOf(ErrorKind::kBadInput, [&] { (void)DetectVideos(options_, detector_); });
  };
  EXPECT_THAT(message(), HasSubstr("another video, network or options"));
  fs::remove(options_.output / "a/video.json");
  EXPECT_THAT(message(), HasSubstr("other files"));
}

TEST_F(DetectVideosTest, ReportsProgressInFramesOfAllVideos) {
  std::atomic<long> total = 0;
  Callbacks callbacks;
  callbacks.progress = [&](const ProgressState& state) { total = state.total; };
  // Slow enough for at least one report.
  detector_.make_network = [this] {
    struct Slow final : PoseNetwork {
      explicit Slow(std::atomic<int>& questions) : network(questions) {}
      std::vector<DetectedPose> FindPeople(const cv::Mat& image) override { return network.FindPeople(image); }
      DetectedPose PoseInCrop(const cv::Mat& image, const Crop& crop) override {
        std::this_thread::sleep_for(std::chrono::milliseconds(25));
        return network.PoseInCrop(image, crop);
      }
      Appearance AppearanceOf(const cv::Mat&, const DetectedPose&) override { return {}; }
      NumberNetwork network;
    };
    return std::make_unique<Slow>(questions_);
  };
  const CallbackScope scope(callbacks);
  DetectVideos(options_, detector_);
  EXPECT_EQ(total, 32);
}

TEST_F(DetectVideosTest, WarnsOfMissingFramesAndRefusesVideosWithoutAny) {
  fs::resize_file(folder_ / "a.avi", fs::file_size(folder_ / "a.avi") * 3 / 5);
  {
    testing::CollectedMessages messages;
    const DetectReport report = DetectVideos(options_, detector_);
    EXPECT_GT(report.videos[0].frames_skipped, 0);
    EXPECT_THAT(messages.text(), AllOf(HasSubstr("warning: "), HasSubstr("of 20 frames are damaged or missing")));
  }
  std::ofstream(folder_ / "a.avi") << "no video";
  options_.output = folder_ / "other";
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { (void)DetectVideos(options_, detector_); }),
              HasSubstr("a video that can be read"));
}

TEST_F(DetectVideosTest, NamesEachVideoThatFailsWhenItDoes) {
  detector_.make_network = []() -> std::unique_ptr<PoseNetwork> { throw Error(ErrorKind::kBadInput, "no network"); };
  testing::CollectedMessages messages;
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { (void)DetectVideos(options_, detector_); }),
              HasSubstr("no network"));
  EXPECT_THAT(messages.text(), AllOf(HasSubstr("a: failed: no network"), HasSubstr("b: failed: no network")));
}

TEST_F(DetectVideosTest, LeavesOpenCvsThreadsAsTheyWere) {
  const int before = cv::getNumThreads();
  cv::setNumThreads(2);
  DetectVideos(options_, detector_);
  EXPECT_EQ(cv::getNumThreads(), 2);
  cv::setNumThreads(before);
}

TEST_F(DetectVideosTest, WarnsOfTimeStampsThatAreNotBelieved) {
  // In Matroska each frame has its own: the sixth one's is set to 30 seconds.
  testing::WriteNumberedVideo(folder_ / "c.mkv", 12, 25.0, {320, 240});
  std::string bytes = ReadFile(folder_ / "c.mkv");
  const std::string stamp_200{"\x81\x00\xC8", 3};  // track 1, 200 ms
  const std::size_t place = bytes.find(stamp_200);
  ASSERT_NE(place, std::string::npos);
  bytes.replace(place, 3, std::string("\x81\x75\x30", 3));
  WriteFileAtomically(folder_ / "c.mkv", bytes);
  options_.videos = {(folder_ / "c.mkv").string()};
  testing::CollectedMessages messages;
  DetectVideos(options_, detector_);
  EXPECT_THAT(messages.text(), HasSubstr("the time stamps of 1 of 12 frames are missing or wrong"));
  EXPECT_THAT(ReadVideoFacts(options_.output / "c")->times_seconds,
              Pointwise(DoubleNear(1e-3), {0.0, 0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28, 0.32, 0.36, 0.4, 0.44}));
}

TEST_F(DetectVideosTest, RefusesSenselessOptions) {
  const auto message = [&](auto change) {
    DetectOptions options = options_;
    change(options);
    return testing::ErrorOf(ErrorKind::kInvalidArgument, [&] { (void)DetectVideos(options, detector_); });
  };
  EXPECT_THAT(message([](DetectOptions& o) { o.videos.clear(); }), HasSubstr("at least one video"));
  EXPECT_THAT(message([](DetectOptions& o) { o.output.clear(); }), HasSubstr("the folder"));
  EXPECT_THAT(message([](DetectOptions& o) { o.threads = -1; }), HasSubstr("`threads`"));
  EXPECT_THAT(message([](DetectOptions& o) { o.image_fps = -1; }), HasSubstr("`image_fps` must be 0 or more"));
}

}  // namespace
}  // namespace canonpose
