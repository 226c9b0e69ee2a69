// Damaged files: cut anywhere, with bytes and values exchanged, a reader either reads them or says what is wrong.
#include <array>
#include <fstream>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/random.h"
#include "canonpose/base/testing.h"
#include "canonpose/data/own_layout.h"
#include "canonpose/data/person_tracking.h"
#include "canonpose/data/readers/formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using testing::TemporaryFolder;
using testing::TestData;

/// A sample file and the reader it is for; OpenPose's and Ultralytics' text are put into their own folder.
struct Victim {
  const char* format;
  const char* file;
  const char* name = "frame_1.json";
  /// A table of text may be cut between two rows.
  [[nodiscard]] bool is_json() const { return std::string_view(name).ends_with(".json"); }
};

constexpr std::array<Victim, 13> kVictims{
    {{"openpose", "openpose/cam1/cam1_000000000000_keypoints.json"},
     {"alphapose", "alphapose/left.json"},
     {"alphapose", "alphapose_open/left/alphapose-results.json"},
     {"alphapose", "alphapose_cmu/left/alphapose-results.json"},
     {"mmpose", "mmpose_video/a.json"},
     {"mmpose", "mmpose_demo/a.json"},
     {"mmpose", "mmpose_images/a/img_0001.json"},
     {"coco", "coco/a.json"},
     {"mediapipe", "mediapipe_json/left.json"},
     {"ultralytics", "ultralytics_json/cam1.json"},
     {"mediapipe", "mediapipe_csv/left.csv", "frame_1.csv"},
     {"deeplabcut", "deeplabcut/cam1DLC_resnet50_walkJan1shuffle1_100000.csv", "cam.csv"},
     {"ultralytics", "ultralytics_txt/cam1/labels/cam1_1.txt", "frame_1.txt"}}};

/// Reads, follows and checks; whether that went well. Anything but an Error of bad input ends the test.
bool Reads(const Victim& victim, const std::string& text) {
  const TemporaryFolder folder;
  // Some two thousand times: nothing here needs to reach the disk.
  std::ofstream(folder / victim.name, std::ios::binary) << text;
  const DetectionFormat& format = FindDetectionFormat(victim.format);
  const bool is_folder =
      std::string_view(victim.format) == "openpose" || std::string_view(victim.name).ends_with(".txt");
  try {
    for (CameraInput input : format.find_cameras(is_folder ? folder.path() : folder / victim.name)) {
      input.image_size = {640, 480};
      std::vector<KeypointClip> clips{FollowPerson(format.read(input), 1)};
      LayoutOf(clips, "");
    }
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kBadInput) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
  return true;
}

TEST(DamagedFiles, CutAnywhere) {
  for (const Victim& victim : kVictims) {
    const std::string text = ReadFile(TestData("detections") / victim.file);
    ASSERT_TRUE(Reads(victim, text)) << victim.file;
    const std::size_t end = text.find_last_not_of(" \n");
    for (int i = 0; i < 60; ++i) {
      const std::size_t length = end * static_cast<std::size_t>(i) / 60;
      const bool is_read = Reads(victim, text.substr(0, length));
      EXPECT_FALSE(is_read && victim.is_json()) << victim.file << " cut at " << length;
    }
  }
}

TEST(DamagedFiles, ValuesReplaced) {
  static constexpr std::array<const char*, 14> kReplacements{"null",
                                                             "NaN",
                                                             "-Infinity",
                                                             "1e999",
                                                             "1e308",
                                                             "-1e38",
                                                             "\"x\"",
                                                             "[]",
                                                             "{}",
                                                             "true",
                                                             "[[[1]]]",
                                                             "-0",
                                                             "12345678901234567890123",
                                                             "1e-400"};
  Rng rng(21);
  for (const Victim& victim : kVictims) {
    const std::string text = ReadFile(TestData("detections") / victim.file);
    for (int i = 0; i < 60; ++i) {
      // A whole number or word: from one separator to the next.
      const std::size_t at = rng.Index(text.size() - 2) + 1;
      const std::size_t begin = text.find_last_of("[,:", at) + 1;
      const std::size_t end = text.find_first_of("],:}", begin);
      if (end == std::string::npos) continue;
      Reads(victim, text.substr(0, begin) + kReplacements[rng.Index(kReplacements.size())] + text.substr(end));
    }
  }
}

TEST(DamagedFiles, BytesReplaced) {
  Rng rng(22);
  for (const Victim& victim : kVictims) {
    const std::string original = ReadFile(TestData("detections") / victim.file);
    for (int i = 0; i < 100; ++i) {
      std::string text = original;
      for (std::size_t n = 0; n <= rng.Index(4); ++n) text[rng.Index(text.size())] = static_cast<char>(rng.Index(256));
      Reads(victim, text);
    }
  }
}

TEST(DamagedFiles, NestedWithoutEnd) {
  for (const Victim& victim : kVictims) {
    if (!victim.is_json()) continue;
    EXPECT_FALSE(Reads(victim, std::string(200000, '[')));
    EXPECT_FALSE(Reads(victim, std::string(100000, '[') + std::string(100000, ']')));
    for (const char* const key : {"frames", "results", "data", "people", "landmarks"}) {
      std::string text;
      for (int i = 0; i < 50000; ++i) text += fmt::format("{{\"{}\":", key);
      EXPECT_FALSE(Reads(victim, text + "[]" + std::string(50000, '}'))) << victim.file << ": " << key;
    }
  }
}

}  // namespace
}  // namespace canonpose
