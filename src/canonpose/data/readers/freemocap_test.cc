#include "canonpose/data/readers/freemocap.h"

#include <cmath>
#include <cstdint>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/data/codecs/npy.h"
#include "canonpose/data/readers/readers_testing.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using testing::PointOf;
using testing::ReadCameras;
using testing::TemporaryFolder;
using testing::TestData;

std::string Array(const std::vector<std::size_t>& shape, const std::vector<double>& values) {
  std::string bytes = npy::MakeHeader("<f8", shape);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  return bytes;
}

/// (cameras, 2 frames, points, width): point k of camera c at (10 c + k, 5), the third value `third`.
std::string Session(std::size_t cameras, std::size_t points, std::size_t width, double third = -7.0,
                    double scale = 1.0) {
  std::vector<double> values;
  for (std::size_t c = 0; c < cameras; ++c) {
    for (int t = 0; t < 2; ++t) {
      for (std::size_t k = 0; k < points; ++k) {
        values.push_back(scale * static_cast<double>(10 * c + k));
        values.push_back(scale * 5.0);
        if (width == 3) values.push_back(third);
      }
    }
  }
  return Array({cameras, 2, points, width}, values);
}

std::vector<DetectedCamera> Read(const std::string& bytes) {
  const TemporaryFolder folder;
  WriteFileAtomically(folder / "a_2d.npy", bytes);
  return ReadCameras("freemocap", folder / "a_2d.npy");
}

std::string ReadError(const std::string& bytes) {
  return ErrorOf(ErrorKind::kBadInput, [&] { Read(bytes); });
}

TEST(Freemocap, EveryCameraOfTheArray) {
  const std::vector<DetectedCamera> cameras = Read(Session(3, 33, 2));
  ASSERT_EQ(cameras.size(), 3U);
  EXPECT_EQ(cameras[2].name, "camera2");
  EXPECT_EQ(cameras[2].layout->name, "mediapipe-33");
  ASSERT_EQ(cameras[2].frames.size(), 2U);
  EXPECT_THAT(PointOf(cameras[2].frames[1].people.at(0), 4), ElementsAre(24, 5));
  EXPECT_EQ(cameras[2].frames[1].people[0].confidence[4], 1.0F);
}

TEST(Freemocap, ColumnMajorArraysAreReadAsWell) {
  constexpr std::size_t kCameras = 2;
  constexpr std::size_t kPoints = 33;
  std::string bytes = npy::MakeHeader("<f8", {kCameras, 1, kPoints, 2});
  const std::size_t order = bytes.find("False");
  bytes.replace(order, 5, "True ");
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t k = 0; k < kPoints; ++k) {
      for (std::size_t c = 0; c < kCameras; ++c) {
        const double value = axis == 0 ? static_cast<double>(100 * c + k) : 7.0;
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    }
  }
  const std::vector<DetectedCamera> cameras = Read(bytes);
  EXPECT_THAT(PointOf(cameras.at(0).frames.at(0).people.at(0), 4), ElementsAre(4, 7));
  EXPECT_THAT(PointOf(cameras.at(1).frames.at(0).people.at(0), 32), ElementsAre(132, 7));
}

TEST(Freemocap, SingleNumbersAndIntegersAreReadAsWell) {
  const auto read = [](const char* type, auto first) {
    std::string bytes = npy::MakeHeader(type, {2, 1, 33, 2});
    for (int i = 0; i < 2 * 33 * 2; ++i) {
      const auto value = static_cast<decltype(first)>(i);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    return PointOf(Read(bytes).at(1).frames.at(0).people.at(0), 1);
  };
  EXPECT_THAT(read("<f4", 0.0F), ElementsAre(68, 69));
  EXPECT_THAT(read("<i8", std::int64_t{0}), ElementsAre(68, 69));
}

TEST(Freemocap, HandsAndFaceAreReportedAndLeftOut) {
  EXPECT_THAT(Read(Session(1, 33, 3)).at(0).unused_parts, ::testing::IsEmpty());
  const DetectedCamera hands = Read(Session(1, 75, 3)).at(0);
  EXPECT_EQ(hands.keypoint_count, 33);
  EXPECT_THAT(hands.unused_parts, ElementsAre("hands"));
  EXPECT_THAT(Read(Session(1, 553, 3)).at(0).unused_parts, ElementsAre("face", "hands"));
  EXPECT_EQ(Read(Session(1, 17, 2)).at(0).keypoint_count, 17) << "YOLO's, which is recognised by its number";
  EXPECT_FALSE(Read(Session(1, 17, 2)).at(0).layout.has_value());
}

TEST(Freemocap, TheThirdValueIsAConfidenceOnlyWithinZeroAndOne) {
  EXPECT_EQ(Read(Session(1, 33, 3, 0.25)).at(0).frames[0].people.at(0).confidence[3], 0.25F);
  EXPECT_EQ(Read(Session(1, 33, 3, -0.25)).at(0).frames[0].people.at(0).confidence[3], 1.0F);
  EXPECT_EQ(Read(Session(1, 33, 3, 30.0)).at(0).frames[0].people.at(0).confidence[3], 1.0F);
}

TEST(Freemocap, OldFilesHaveFractions) {
  const DetectedCamera camera = Read(Session(1, 33, 3, -0.1, 0.01)).at(0);  // of 100 x 200 pixels
  EXPECT_NEAR(PointOf(camera.frames[0].people.at(0), 30)[0], 30.0, 1e-4);
  EXPECT_NEAR(PointOf(camera.frames[0].people.at(0), 30)[1], 10.0, 1e-4);
}

TEST(Freemocap, MissingPointsAreNaNOrZero) {
  std::vector<double> values(2 * 33 * 2, NAN);
  for (std::size_t i = 0; i < 66; ++i) values[i] = i < 2 ? 0.0 : 50.0;
  const DetectedCamera camera = Read(Array({1, 2, 33, 2}, values)).at(0);
  EXPECT_EQ(camera.frames[0].people.at(0).confidence[0], 0.0F);
  EXPECT_EQ(camera.frames[0].people.at(0).confidence[1], 1.0F);
  EXPECT_TRUE(camera.frames[1].people.empty());
}

TEST(Freemocap, ASessionsFolderNamesTheCameras) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "synchronized_videos");
  fs::create_directories(folder / "output_data/raw_data");
  WriteFileAtomically(folder / "output_data/raw_data/mediapipe2dData_numCams.npy", Session(2, 33, 2));
  WriteFileAtomically(folder / "output_data/raw_data/mediapipe3dData_numFrames.npy",
                      Array({2, 33, 3}, std::vector<double>(198)));
  for (const char* const camera : {"left", "right"})
    WriteFileAtomically(folder / "synchronized_videos" / (std::string(camera) + ".mp4"), "x");
  const std::vector<CameraInput> cameras = FindFreemocapCameras(folder.path());
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[0].name, "left");
  EXPECT_EQ(cameras[1].name, "right");
  EXPECT_EQ(cameras[1].part, "1");
  EXPECT_EQ(DetectFormat(TestData("detections/freemocap/output_data/raw_data")), "freemocap");
  EXPECT_EQ(ReadCameras("freemocap", TestData("detections/freemocap")).at(1).frames.size(), 8U);
}

TEST(Freemocap, WrongArraysAreRefused) {
  EXPECT_THAT(ReadError(Array({2, 33, 3}, std::vector<double>(198))),
              HasSubstr("expected numbers (cameras, frames, points, 2 or 3), found (2, 33, 3)"));
  EXPECT_THAT(ReadError(Array({1, 1, 33, 4}, std::vector<double>(132))), HasSubstr("found (1, 1, 33, 4)"));
  EXPECT_THAT(ReadError(Array({1, 2, 33, 2}, std::vector<double>(132, NAN))), HasSubstr("nobody in any of 2 frames"));
  EXPECT_THAT(ReadError(Array({1, 1000000000, 0, 2}, {})), HasSubstr("the array is cut short or damaged"));
  EXPECT_THAT(ReadError(Session(1, 33, 2).substr(0, 500)), HasSubstr("the array is cut short or damaged"));
  EXPECT_THAT(ReadError(npy::MakeHeader("<f2", {1, 1, 33, 2}) + std::string(132, '\0')), HasSubstr("found '<f2'"));
  EXPECT_THAT(ReadError(npy::MakeHeader("<U1", {1, 1, 33, 2}) + std::string(264, '\0')),
              HasSubstr("expected numbers (cameras, frames, points, 2 or 3)"));
  EXPECT_THAT(ReadError("hello"), HasSubstr("expected a NumPy file (.npy), found another file"));
  const TemporaryFolder folder;
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindFreemocapCameras(folder.path()); }),
              HasSubstr("expected FreeMoCap's 2D points"));
  WriteFileAtomically(folder / "a_2d.npy", Session(1, 33, 2));
  WriteFileAtomically(folder / "b_2d.npy", Session(1, 33, 2));
  EXPECT_THAT(ErrorOf(ErrorKind::kBadInput, [&] { FindFreemocapCameras(folder.path()); }),
              HasSubstr("found a_2d.npy and 1 more; give the path of the file itself"));
}

}  // namespace
}  // namespace canonpose
