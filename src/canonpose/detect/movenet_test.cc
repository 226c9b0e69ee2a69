#include "canonpose/detect/movenet.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/video/video_reader.h"

namespace canonpose {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// Skips the test where scripts/get-detector was not run.
#define CANONPOSE_SKIP_WITHOUT_DETECTOR()                                                                     \
  if (!std::filesystem::exists(DefaultModelFolder() / "movenet-multipose.bin")) {                             \
    GTEST_SKIP() << DefaultModelFolder() << " does not have the detector; scripts/get-detector downloads it"; \
  }

template <typename Number>
std::vector<Number> ReadNumbers(const std::filesystem::path& path) {
  const std::string bytes = ReadFile(path);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

TEST(MoveNet, GivesWhatTensorFlowGives) {
  CANONPOSE_SKIP_WITHOUT_DETECTOR();
  CANONPOSE_SKIP_WITHOUT_SHARED("golden/movenet/crop.i32");
  const std::vector<std::int32_t> crop = ReadNumbers<std::int32_t>(testing::Shared("golden/movenet/crop.i32"));
  const std::vector<float> expected = ReadNumbers<float>(testing::Shared("golden/movenet/crop_out.f32"));
  ASSERT_THAT(crop, SizeIs(256 * 256 * 3));
  ASSERT_THAT(expected, SizeIs(51));
  MoveNet network(MoveNetFiles::Read(DefaultModelFolder()));
  const DetectedPose pose = network.PoseOf({crop.begin(), crop.end()});
  for (std::size_t j = 0; j < kPoseJoints; ++j) {
    EXPECT_NEAR(pose.joints[j].position.y(), expected[3 * j], 1e-5) << j;
    EXPECT_NEAR(pose.joints[j].position.x(), expected[3 * j + 1], 1e-5) << j;
    EXPECT_NEAR(pose.joints[j].score, expected[3 * j + 2], 1e-5) << j;
  }
}

TEST(MoveNet, FindsPeopleInAnImageAndAgreesWithItselfInACrop) {
  CANONPOSE_SKIP_WITHOUT_DETECTOR();
  CANONPOSE_SKIP_WITHOUT_SHARED("data/videos/two/cam01.mp4");
  VideoReader reader(FindVideos({testing::Shared("data/videos/two/cam01.mp4").string()}).front());
  VideoFrame frame;
  ASSERT_TRUE(reader.Read(frame));
  MoveNet network(MoveNetFiles::Read(DefaultModelFolder()));
  const std::vector<DetectedPose> people = network.FindPeople(frame.image);
  ASSERT_THAT(people, SizeIs(3));
  for (const DetectedPose& person : people) {
    EXPECT_GT(person.score, 0.3F);
    const DetectedPose pose = network.PoseInCrop(frame.image, CropAround(person, frame.image.cols, frame.image.rows));
    EXPECT_GT(pose.score, 0.5F);
    EXPECT_LT(PoseDistance(pose, person), 0.2F);
  }
}

TEST(MoveNet, SaysHowToGetTheNetworks) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { (void)MoveNetFiles::Read(folder / "gone"); }),
              AllOf(HasSubstr("movenet-thunder.json"), HasSubstr("scripts/get-detector")));
}

}  // namespace
}  // namespace canonpose
