#include "canonpose/data/readers/mediapipe.h"

#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/data/codecs/json.h"
#include "canonpose/data/readers/mediapipe_layout.h"
#include "canonpose/data/readers/readers_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using testing::CollectedMessages;
using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::PointOf;
using testing::ReadCameras;
using testing::ReadText;
using testing::ReadTextError;
using testing::TemporaryFolder;
using testing::TestData;

/// Texts of all landmarks, with commas.
std::string Join(const std::function<std::string(int)>& text) {
  std::string all;
  for (int k = 0; k < 33; ++k) all += (k == 0 ? "" : ",") + text(k);
  return all;
}

/// Landmark k at (0.2 + k / 100, 0.4), with visibility 0.5.
std::string Values(int /*unused*/ = 0) {
  return Join([](int k) { return fmt::format("{},0.4,-0.1,0.5", 0.2 + 0.01 * k); });
}
std::string Objects() {
  return "[" +
         Join([](int k) { return fmt::format(R"({{"x":{},"y":0.4,"z":-0.1,"visibility":0.5}})", 0.2 + 0.01 * k); }) +
         "]";
}

/// Frames 0 and 1 with that person, in an image of 100 x 200.
void ExpectTwoFrames(const DetectedCamera& camera, const std::string& what) {
  ASSERT_EQ(camera.frames.size(), 2U) << what;
  EXPECT_EQ(camera.layout->name, "mediapipe-33");
  for (std::size_t t = 0; t < 2; ++t) {
    EXPECT_EQ(camera.frames[t].number, static_cast<std::int64_t>(t)) << what;
    ASSERT_EQ(camera.frames[t].people.size(), 1U) << what;
    const DetectedPerson& person = camera.frames[t].people[0];
    ASSERT_EQ(person.confidence.size(), 33U) << what;
    for (std::size_t k = 0; k < 33; ++k) {
      EXPECT_NEAR(PointOf(person, k)[0], 20.0 + static_cast<double>(k), 1e-4) << what;
      EXPECT_NEAR(PointOf(person, k)[1], 80.0, 1e-4) << what;
      EXPECT_EQ(person.confidence[k], 0.5F) << what;
    }
  }
}

TEST(Mediapipe, TextInAllItsForms) {
  const auto header = [](const char* form, int first = 0) {
    return Join([&](int k) { return fmt::format(fmt::runtime(form), k + first); });
  };
  const std::string frames = "0," + Values() + "\n1," + Values() + "\n";
  for (const std::string& names : {header("x{0},y{0},z{0},v{0}"), header("x{0},y{0},z{0},v{0}", 1),
                                   header("x_{0},y_{0},z_{0},vis_{0}"), header("{0}_x,{0}_y,{0}_z,{0}_visibility"),
                                   header("landmark_{0}_X,landmark_{0}_Y,landmark_{0}_Z,landmark_{0}_V")}) {
    ExpectTwoFrames(ReadText("mediapipe", "a.csv", fmt::format("frame,{}\n{}", names, frames)), names.substr(0, 40));
    ExpectTwoFrames(
        ReadText("mediapipe", "a.csv", "class," + names + "\nwalk," + Values() + "\nwalk," + Values() + "\n"),
        "rows count the frames");
  }
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", frames), "without a header");
  const std::string semicolons = [&] {
    std::string text = "frame," + header("x{0},y{0},z{0},v{0}") + "\n" + frames;
    std::replace(text.begin(), text.end(), ',', ';');
    return text;
  }();
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", semicolons), "semicolons");
  std::string by_name = "frame";
  for (const std::string& joint : MediapipeLayout().joints)
    by_name += fmt::format(",{0}_x,{0}_y,{0}_z,{0}_visibility", joint);
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", by_name + "\n" + frames), "names");
}

TEST(Mediapipe, ARowPerLandmark) {
  std::string by_number = "frame,landmark,x,y,z,visibility\n";
  std::string without_frame = "landmark_id,x,y,z,visibility\n";
  std::string two_people = "frame,person,landmark,x,y,visibility\n";
  for (int t = 0; t < 2; ++t) {
    for (int k = 0; k < 33; ++k) {
      const std::string values = fmt::format("{},0.4,-0.1,0.5\n", 0.2 + 0.01 * k);
      by_number += fmt::format("{},{},{}", t, k, values);
      without_frame += fmt::format("{},{}", k + 1, values);
      for (int person = 0; person < 2; ++person)
        two_people += fmt::format("{},{},{},0.5,0.{},0.9\n", t, person, k, person + 1);
    }
  }
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", by_number), "by number");
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", without_frame), "without frames, from 1");
  const DetectedCamera camera = ReadText("mediapipe", "a.csv", two_people);
  ASSERT_EQ(camera.frames.at(0).people.size(), 2U);
  EXPECT_NEAR(PointOf(camera.frames[0].people[1], 7)[1], 40.0, 1e-4);
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "frame,landmark,x,y\n0,0,0.5,0.5\n0,0,0.5,0.5\n"),
              AllOf(HasSubstr("line 3"), HasSubstr("landmark Nose again")));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "frame,landmark,x,y\n0,pelvis,0.5,0.5\n"),
              HasSubstr("line 2, column 2: expected a landmark of MediaPipe, by number or name, found \"pelvis\""));
}

TEST(Mediapipe, NumberedLandmarksOfHandsAndFaceAreNotTheBodys) {
  // Those of the face and hands are all at (0.9, 0.9).
  const auto table = [](const std::string& face, const std::string& hand, const std::string& body) {
    std::string header = "frame";
    std::string others;
    for (const auto& [name, count] : {std::pair(face, 468), std::pair(hand, 21)}) {
      for (int k = 0; k < count; ++k) {
        header += fmt::format(",{0}_{1}_x,{0}_{1}_y", name, k);
        others += ",0.9,0.9";
      }
    }
    header += "," + Join([&](int k) { return fmt::format("{0}_{1}_x,{0}_{1}_y,{0}_{1}_z,{0}_{1}_v", body, k); });
    return fmt::format("{}\n0{},{}\n1{},{}\n", header, others, Values(), others, Values());
  };
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", table("face", "left_hand", "pose")), "pose");
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", table("face_landmark", "hand_landmark", "pose_landmark")), "pose");
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", table("face", "left_hand", "Landmark")), "landmark");
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", table("pose_world_landmark", "left_hand", "pose_landmark")), "world");
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", table("face", "left_hand", "body")),
              HasSubstr("line 1: expected the numbered landmarks of one body, found \"body_0\", \"face_0\", "
                        "\"left_hand_0\"; name those of the body pose_0 to pose_32"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", table("face", "pose_0", "pose_1")), HasSubstr("\"pose_1_0\""));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv",
                            "frame," + Join([](int k) { return fmt::format("face_{0}_x,face_{0}_y", k); }) + "\n0," +
                                Join([](int) { return "0.5,0.5"; }) + "\n"),
              HasSubstr("expected the numbered landmarks of one body, found \"face_0\""));

  std::string names = "frame,left_hand_0_x,left_hand_0_y";
  for (const std::string& joint : MediapipeLayout().joints)
    names += fmt::format(",{0}_x,{0}_y,{0}_z,{0}_visibility", joint);
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", names + "\n0,0.9,0.9," + Values() + "\n1,0.9,0.9," + Values() + "\n"),
                  "a hand's numbers beside names");

  std::string rows = "landmark,x,y,visibility\n";
  for (int t = 0; t < 2; ++t) {
    for (int k = 0; k < 40; ++k) rows += fmt::format("face_{},0.9,0.9,1\n", k);
    for (int k = 0; k < 33; ++k) rows += fmt::format("pose_{},{},0.4,0.5\n", k, 0.2 + 0.01 * k);
  }
  ExpectTwoFrames(ReadText("mediapipe", "a.csv", rows), "a row per landmark");
}

TEST(Mediapipe, AFrameWithoutNumberBeginsWhereAPersonReturns) {
  std::string table = "person,landmark,x,y\n";
  for (int t = 0; t < 3; ++t) {
    for (const char* const person : {"a", "b"}) {
      if (t == 0 && *person == 'b') continue;
      for (int k = 0; k < 33; ++k) table += fmt::format("{},{},0.5,0.{}\n", person, k, t + (*person == 'a' ? 1 : 5));
    }
  }
  const DetectedCamera camera = ReadText("mediapipe", "a.csv", table);
  ASSERT_EQ(camera.frames.size(), 3U);
  for (std::size_t t = 0; t < 3; ++t) {
    ASSERT_EQ(camera.frames[t].people.size(), t == 0 ? 1U : 2U) << t;
    EXPECT_NEAR(PointOf(camera.frames[t].people[0], 7)[1], 20.0 * static_cast<double>(t + 1), 1e-4);
  }
  EXPECT_NEAR(PointOf(camera.frames[2].people[1], 7)[1], 140.0, 1e-4);
}

TEST(Mediapipe, JsonInAllItsForms) {
  const std::string person = Objects();
  const std::string arrays = "[" + Join([](int k) { return fmt::format("[{},0.4,-0.1,0.5]", 0.2 + 0.01 * k); }) + "]";
  const std::string named = "{" + Join([](int k) {
                              return fmt::format(R"("{}":{{"x":{},"y":0.4,"visibility":0.5}})",
                                                 MediapipeLayout().joints[static_cast<std::size_t>(k)], 0.2 + 0.01 * k);
                            }) +
                            "}";
  for (const std::string& frame :
       {person, arrays, named, "[" + Values() + "]", R"({"landmarks":)" + person + "}",
        R"({"pose_landmarks":[)" + person + "]}", R"({"poseLandmarks":{"landmark":)" + person + "}}",
        R"({"keypoints":)" + arrays + "}", R"({"pose_world_landmarks":[],"pose_landmarks":)" + person + "}"}) {
    const std::string what = frame.substr(0, 50);
    ExpectTwoFrames(ReadText("mediapipe", "a.json", fmt::format("[{0},{0}]", frame)), what);
    ExpectTwoFrames(ReadText("mediapipe", "a.json", fmt::format(R"({{"fps":30,"frames":[{0},{0}]}})", frame)), what);
    ExpectTwoFrames(ReadText("mediapipe", "a.json", fmt::format(R"({{"0":{0},"1":{0}}})", frame)), what);
    const TemporaryFolder folder;
    fs::create_directories(folder / "cam");
    WriteFileAtomically(folder / "cam/frame_0.json", frame);
    WriteFileAtomically(folder / "cam/frame_1.json", frame);
    // [[33 points]] and the like are a video of one frame as well.
    if (frame.starts_with("[[") || frame.starts_with("[0")) continue;
    ExpectTwoFrames(ReadCameras("mediapipe", folder / "cam").at(0), what);
  }
  const DetectedCamera numbered = ReadText(
      "mediapipe", "a.json",
      fmt::format(R"([{{"frame":3,"landmarks":{0}}},{{"frame":5,"landmarks":null}},{{"frame":6,"landmarks":{0}}}])",
                  person));
  EXPECT_EQ(numbered.frames.front().number, 3);
  EXPECT_EQ(numbered.frames.back().number, 6);
  EXPECT_EQ(numbered.frames.size(), 4U) << "frame 4, which the script left out, is a frame without people";
  EXPECT_TRUE(numbered.frames[2].people.empty());
}

TEST(Mediapipe, ZerosAndPointsOutsideTheImageAreMissing) {
  const std::string zeros = Join([](int) { return "0,0,0,0"; });
  const std::string outside =
      Join([](int k) { return k < 11 ? "0.5,-0.2,0,0.9" : (k == 11 ? "1.4,0.5,0,0.9" : "0.5,0.5,0,0.9"); });
  const CollectedMessages messages;
  const DetectedCamera camera = ReadText("mediapipe", "a.csv", zeros + "\n" + outside + "\n");
  EXPECT_TRUE(camera.frames[0].people.empty());
  const DetectedPerson& person = camera.frames[1].people.at(0);
  for (std::size_t k = 0; k < 33; ++k) {
    EXPECT_EQ(person.confidence[k] == 0.0F, k < 12) << k;
    EXPECT_EQ(std::isnan(PointOf(person, k)[0]), k < 12) << k;
  }
  EXPECT_THAT(messages.text(), HasSubstr("36.4 % of the landmarks lie outside the image"));
}

TEST(Mediapipe, PixelsAreTakenAsSuch) {
  const std::string pixels = Join([](int k) { return fmt::format("{},300.5,0,0.9", 100 + k); });
  const CollectedMessages messages;
  const DetectedCamera camera = ReadText("mediapipe", "a.csv", pixels + "\n");
  EXPECT_THAT(PointOf(camera.frames[0].people.at(0), 32), ElementsAre(132.0F, 300.5F));
  EXPECT_THAT(messages.text(), HasSubstr("the landmarks are pixels"));
}

TEST(Mediapipe, WorldLandmarksAreRefused) {
  const std::string world = Join([](int k) {
    return k == 23   ? "0.1,0.001,0,0.9"
           : k == 24 ? "-0.1,-0.001,0,0.9"
                     : fmt::format("{},{},0,0.9", 0.01 * (k - 16), 0.02 * (k - 20));
  });
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", world + "\n"),
              HasSubstr("points around the middle of the hips, so world landmarks in metres; dump pose_landmarks"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.json", R"([{"pose_world_landmarks":[]}])"),
              HasSubstr("pose_world_landmarks are metres"));
}

TEST(Mediapipe, WrongFilesAreRefused) {
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "frame,x0,y0\n0,0.5,0.5\n"),
              HasSubstr("line 1: expected columns x and y of all 33 landmarks, found none of landmark 1 (LEyeInner)"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "time,speed\n0,1\n"), HasSubstr("found \"time,speed\""));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "1,2,3\n"),
              HasSubstr("2, 3 or 4 values of 33 landmarks, found 3 values"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "0," + Values() + "\n0," + Values() + "\n"),
              HasSubstr("line 1 and line 2, both frame 0"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", "0.5," + Values() + "\n"),
              HasSubstr("expected the number of a frame"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.json", R"([[{"x":0.5,"y":0.5}]])"),
              HasSubstr("expected 33 landmarks of MediaPipe's pose, found 1 landmarks"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.json", "[[],null]"), HasSubstr("nobody in any of 2 frames"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.json", R"([{"a":1}])"),
              HasSubstr("[0]: expected MediaPipe's landmarks of a person"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.json", R"({"a":1})"),
              HasSubstr("expected MediaPipe's landmarks, 33 for each person"));
  EXPECT_THAT(ReadTextError("mediapipe", "a.csv", Values() + "\n", {{0, 0}, 0}),
              AllOf(HasSubstr("the image size of camera a"), HasSubstr("give `image_size`")));
}

TEST(Mediapipe, TheSamplesAreRecognised) {
  for (const char* const folder : {"mediapipe_csv", "mediapipe_json"}) {
    EXPECT_EQ(DetectFormat(TestData("detections") / folder), "mediapipe");
    const std::vector<DetectedCamera> cameras =
        ReadCameras("mediapipe", TestData("detections") / folder, {{640, 480}, 0});
    ASSERT_EQ(cameras.size(), 2U);
    EXPECT_EQ(cameras[0].name, "left");
    EXPECT_EQ(cameras[1].frames.size(), 8U);
    EXPECT_TRUE(cameras[1].frames[5].people.empty());
  }
}

}  // namespace
}  // namespace canonpose
