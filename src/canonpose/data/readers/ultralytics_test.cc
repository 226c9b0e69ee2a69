#include "canonpose/data/readers/ultralytics.h"

#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
using testing::ReadOptions;
using testing::ReadText;
using testing::ReadTextError;
using testing::TemporaryFolder;

/// A line of class 0 with keypoint k at (0.1 + k / 100, 0.5); `width` 3 adds a confidence of 0.75.
std::string Line(int keypoints = 17, int width = 3, const std::string& extras = "", int number = 0) {
  std::string line = fmt::format("{} 0.5 0.5 0.2 0.4", number);
  for (int k = 0; k < keypoints; ++k) line += fmt::format(" {:.6g} 0.5{}", 0.1 + 0.01 * k, width == 3 ? " 0.75" : "");
  return line + extras + "\n";
}

/// A folder of frames, by their names.
class Labels {
 public:
  void Add(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    WriteFileAtomically(folder_ / name, text);
  }
  [[nodiscard]] fs::path path() const { return folder_.path(); }
  [[nodiscard]] std::vector<DetectedCamera> Read(const ReadOptions& options = {}) const {
    return ReadCameras("ultralytics", path(), options);
  }
  [[nodiscard]] std::string Error(const ReadOptions& options = {}) const {
    return ErrorOf(ErrorKind::kBadInput, [&] { (void)Read(options); });
  }

 private:
  TemporaryFolder folder_;
};

TEST(Ultralytics, FramesWithoutPeopleHaveNoFileOrAnEmptyOne) {
  const Labels labels;
  labels.Add("v_1.txt", Line());
  labels.Add("v_2.txt", "");
  labels.Add("v_4.txt", Line() + Line());
  labels.Add("classes.txt", "person\n");
  const DetectedCamera camera = labels.Read().at(0);
  ASSERT_EQ(camera.frames.size(), 4U);
  EXPECT_EQ(camera.frames[0].number, 1);
  EXPECT_TRUE(camera.frames[1].people.empty());
  EXPECT_TRUE(camera.frames[2].people.empty());
  EXPECT_EQ(camera.frames[3].people.size(), 2U);
  const DetectedPerson& person = camera.frames[0].people.at(0);
  EXPECT_NEAR(PointOf(person, 16)[0], 26.0, 1e-4);
  EXPECT_NEAR(PointOf(person, 16)[1], 100.0, 1e-4);
  EXPECT_EQ(person.confidence[16], 0.75F);
  EXPECT_FALSE(person.track_id.has_value());
}

TEST(Ultralytics, WhatFollowsTheKeypointsIsConfidenceOrTrack) {
  const Labels both;
  both.Add("v_1.txt", Line(17, 3, " 0.875 4"));
  both.Add("v_2.txt", Line(17, 3, " 0.875"));  // the tracker has lost the person
  const DetectedCamera camera = both.Read().at(0);
  EXPECT_EQ(camera.frames[0].people.at(0).track_id, 4);
  EXPECT_EQ(camera.frames[0].people.at(0).score, 0.875);
  EXPECT_FALSE(camera.frames[1].people.at(0).track_id.has_value());
  EXPECT_EQ(camera.frames[1].people.at(0).score, 0.875);
  const Labels track;
  track.Add("v_1.txt", Line(17, 2, " 1") + Line(17, 2, " 2"));
  EXPECT_EQ(track.Read().at(0).frames[0].people.at(1).track_id, 2);
  EXPECT_EQ(track.Read().at(0).frames[0].people.at(1).confidence[3], 1.0F) << "without a confidence";
  const Labels sure;
  sure.Add("v_1.txt", Line(17, 3, " 1") + Line(17, 3, " 0.5"));
  EXPECT_EQ(sure.Read().at(0).frames[0].people.at(0).score, 1.0);
  EXPECT_FALSE(sure.Read().at(0).frames[0].people.at(0).track_id.has_value());
}

TEST(Ultralytics, CamerasAreFoldersOrNames) {
  const Labels folders;
  folders.Add("cam1/labels/video_1.txt", Line());
  folders.Add("cam2/labels/video_1.txt", Line());
  const auto names = [](const Labels& labels) {
    std::vector<std::string> result;
    for (const DetectedCamera& camera : labels.Read())
      result.push_back(fmt::format("{} {}", camera.name, camera.frames.size()));
    return result;
  };
  EXPECT_THAT(names(folders), ElementsAre("cam1 1", "cam2 1"));
  const Labels one_folder;
  for (const char* const name : {"left_1", "left_2", "right_1", "right_2", "right_3"})
    one_folder.Add(fmt::format("labels/{}.txt", name), Line());
  EXPECT_THAT(names(one_folder), ElementsAre("left 2", "right 3"));
}

TEST(Ultralytics, OtherClassesAreLeftOut) {
  const Labels labels;
  labels.Add("v_1.txt", Line() + Line(17, 3, "", 16));
  const CollectedMessages messages;
  EXPECT_EQ(labels.Read().at(0).frames[0].people.size(), 1U);
  EXPECT_THAT(messages.text(), HasSubstr("warning: "));
  EXPECT_THAT(messages.text(), HasSubstr("1 detections of class 16 are left out; only people (class 0) are read"));
  const Labels dogs;
  dogs.Add("v_1.txt", Line(17, 3, "", 16));
  EXPECT_THAT(dogs.Error(), HasSubstr("expected people, class 0, found classes 16"));
}

TEST(Ultralytics, OtherModelsNeedALayout) {
  const Labels labels;
  labels.Add("v_1.txt", Line(24, 3, " 3"));
  EXPECT_THAT(labels.Error(),
              AllOf(HasSubstr("v_1.txt: line 1: expected 56 or 39 values for 17 keypoints, and at most two "
                              "more, found 78"),
                    HasSubstr("name the `layout`")));
  const DetectedCamera camera = labels.Read({{100, 200}, 24}).at(0);
  EXPECT_EQ(camera.keypoint_count, 24);
  EXPECT_EQ(camera.frames[0].people.at(0).track_id, 3);
}

TEST(Ultralytics, WrongTextsAreRefused) {
  const auto error = [](const std::string& text) {
    const Labels labels;
    labels.Add("v_1.txt", text);
    return labels.Error();
  };
  EXPECT_THAT(error("0 0.5 0.5 0.2 0.4\n"), HasSubstr("these are boxes without keypoints: run a pose model"));
  EXPECT_THAT(error(Line() + "0 a b\n"), HasSubstr("line 2: expected numbers separated by spaces, found \"a\""));
  EXPECT_THAT(error(Line() + Line(17, 2)), HasSubstr("line 2: expected 56 values as in"));
  EXPECT_THAT(error("0.5 0.5 0.2\n"), HasSubstr("expected the number of a class, found 0.5"));
  EXPECT_THAT(error(""), HasSubstr("nobody in any of 1 frames"));
  std::string pixels = "0 100 100 20 40";
  for (int k = 0; k < 17; ++k) pixels += fmt::format(" {} 150 0.5", 100 + k);
  EXPECT_THAT(
      error(pixels),
      HasSubstr("expected keypoints as fractions of the image, as save_txt writes them, found coordinates up to 150"));
  const Labels unnumbered;
  unnumbered.Add("notes.txt", "hello");
  EXPECT_THAT(unnumbered.Error(),
              HasSubstr("a text file per frame, with the frame's number in its name, found notes.txt"));
  EXPECT_THAT(ReadTextError("ultralytics", "v_1.txt", Line()),
              HasSubstr("expected a folder with a text file per frame"));
}

/// A person as Results.to_json() writes it.
std::string Detection(double scale, const std::string& more = "", int number = 0) {
  std::string x;
  std::string y;
  std::string visible;
  for (int k = 0; k < 17; ++k) {
    x += fmt::format("{}{}", k == 0 ? "" : ",", scale * (0.1 + 0.01 * k));
    y += fmt::format("{}{}", k == 0 ? "" : ",", scale * 0.25);
    visible += k == 0 ? "0.75" : ",0.75";
  }
  return fmt::format(
      R"({{"name":"x","class":{},"confidence":0.9,{}"box":{{"x1":1,"y1":1,"x2":2,"y2":2}},"keypoints":{{"x":[{}],"y":[{}],"visible":[{}]}}}})",
      number, more, x, y, visible);
}

TEST(Ultralytics, JsonInAllItsForms) {
  const std::string person = Detection(100.0, R"("track_id":7,)");
  const auto expect = [](const DetectedCamera& camera, const std::string& what) {
    ASSERT_EQ(camera.frames.size(), 2U) << what;
    EXPECT_TRUE(camera.frames[0].people.empty()) << what;
    ASSERT_EQ(camera.frames[1].people.size(), 1U) << what;
    EXPECT_EQ(camera.frames[1].people[0].track_id, 7) << what;
    EXPECT_NEAR(PointOf(camera.frames[1].people[0], 16)[0], 26.0, 1e-4) << what;
  };
  expect(ReadText("ultralytics", "a.json", "[[],[" + person + "]]"), "lists");
  expect(ReadText("ultralytics", "a.json", R"({"frame_1":[],"frame_2":[)" + person + "]}"), "object of frames");
  expect(
      ReadText("ultralytics", "a.json", R"([{"frame":1,"detections":[]},{"frame":2,"detections":[)" + person + "]}]"),
      "numbered lists");
  const Labels folder;
  folder.Add("cam/v_1.json", "[]");
  folder.Add("cam/v_2.json", "[" + person + "]");
  expect(folder.Read().at(0), "a file per frame");
  const std::string flat = Detection(100.0, R"("frame":4,)");
  const DetectedCamera camera = ReadText("ultralytics", "a.json", "[" + flat + "," + flat + "]");
  EXPECT_EQ(camera.frames.at(0).number, 4);
  EXPECT_EQ(camera.frames.at(0).people.size(), 2U);
}

TEST(Ultralytics, JsonMayHaveFractions) {
  const DetectedCamera camera = ReadText("ultralytics", "a.json", "[[" + Detection(1.0) + "]]");
  EXPECT_NEAR(PointOf(camera.frames[0].people.at(0), 0)[0], 10.0, 1e-4);
  EXPECT_NEAR(PointOf(camera.frames[0].people.at(0), 0)[1], 50.0, 1e-4);
}

TEST(Ultralytics, WrongJsonIsRefused) {
  const auto error = [](const std::string& text) { return ReadTextError("ultralytics", "a.json", text); };
  EXPECT_THAT(error(R"({"a":1})"), HasSubstr("expected Ultralytics' lists of people with keypoints"));
  EXPECT_THAT(error("[[" + Detection(1.0, "", 16) + "]]"), HasSubstr("expected people, class 0, found classes 16"));
  EXPECT_THAT(error(R"([[{"class":0,"box":{}}]])"), HasSubstr("expected a detection with keypoints"));
  EXPECT_THAT(error(R"([[{"class":0,"box":{},"keypoints":{"x":[1],"y":[1,2]}}]])"),
              HasSubstr("expected as many x, y and visible"));
  EXPECT_THAT(error("[[],[]]"), HasSubstr("nobody in any of 2 frames"));
}

}  // namespace
}  // namespace canonpose
