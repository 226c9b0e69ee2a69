#include "canonpose/detect/movenet.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/testing.h"
#include "canonpose/detect/graph_testing.h"
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

/// A network of the right outputs and nothing else: one convolution per head.
GraphModel ModelOfHeads(const testing::TemporaryFolder& folder, const std::map<std::string, int>& channels,
                        int centre_weights = 64 * 64) {
  const std::string prefix = "StatefulPartitionedCall/";
  testing::GraphFile file;
  file.Weights(prefix + "truediv", {}, {0.0078F});
  const auto weights = static_cast<std::size_t>(centre_weights);
  file.Weights("ConstantFolding/" + prefix + "truediv_2_recip", {centre_weights}, std::vector<float>(weights, 1.0F));
  file.Node(prefix + "sub_1", "Sub", {});
  for (const auto& [head, count] : channels) {
    const std::size_t values = 16 * 3 * static_cast<std::size_t>(count);
    file.Weights(head + "/kernel", {4, 4, 3, count}, std::vector<float>(values, 0.1F));
    file.Node(prefix + head + "/x/BiasAdd", "_FusedConv2D", {prefix + "sub_1", head + "/kernel"},
              testing::ConvolutionAttributes(4, true));
  }
  return ReadGraphModel(file.Write(folder));
}

TEST(MoveNet, RefusesNetworksOfOtherShapes) {
  const testing::TemporaryFolder folder;
  const std::map<std::string, int> right{{"kpt_heatmap_0", 17}, {"kpt_regress_0", 34}, {"center_0", 1},
                                         {"kpt_offset_0", 34},  {"box_scale_0", 2},    {"box_offset_0", 2}};
  const GraphModel whole = ModelOfHeads(folder, right);
  const MoveNet network({whole, whole, 1});
  const auto message = [](const GraphModel& thunder, const GraphModel& multipose) {
    return testing::ErrorOf(ErrorKind::kBadInput, [&] { const MoveNet damaged({thunder, multipose, 1}); });
  };
  for (const auto& [head, count] : right) {
    std::map<std::string, int> wrong = right;
    wrong[head] = count + 1;
    EXPECT_THAT(message(whole, ModelOfHeads(folder, wrong)),
                AllOf(HasSubstr("model.json"), HasSubstr(head), HasSubstr(fmt::format("expected 8x8x{} ", count)),
                      HasSubstr(fmt::format("found 8x8x{}", count + 1))));
  }
  EXPECT_THAT(message(ModelOfHeads(folder, right, 100), whole),
              AllOf(HasSubstr("4096 values"), HasSubstr("found 100")));
  std::map<std::string, int> less = right;
  less.erase("center_0");
  EXPECT_THAT(message(ModelOfHeads(folder, less), whole), HasSubstr("center_0"));
}

}  // namespace
}  // namespace canonpose
