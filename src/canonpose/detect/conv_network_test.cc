#include "canonpose/detect/conv_network.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "canonpose/base/testing.h"
#include "canonpose/detect/graph_testing.h"

namespace canonpose {
namespace {

using testing::ConvolutionAttributes;
using testing::GraphFile;
using ::testing::HasSubstr;
using testing::kBiasAddInBase64;
using testing::kRelu6InBase64;

/// Numbers that look random and are the same everywhere.
std::vector<float> Numbers(std::size_t count, unsigned seed) {
  std::vector<float> numbers;
  for (std::size_t i = 0; i < count; ++i) {
    seed = seed * 1664525U + 1013904223U;
    numbers.push_back(static_cast<float>(seed >> 8U) / static_cast<float>(1U << 24U) - 0.5F);
  }
  return numbers;
}

/// TensorFlow's convolution, by its definition: `kernel` is (size, size, in, out), or for depthwise ones (size, size,
/// in, 1).
FeatureMap Convolve(const FeatureMap& input, const std::vector<float>& kernel, int size, int outputs, int stride,
                    bool is_depthwise) {
  FeatureMap result{(input.height + stride - 1) / stride, (input.width + stride - 1) / stride, outputs, {}};
  const auto margin = [&](int in, int out) { return std::max(0, (out - 1) * stride + size - in) / 2; };
  const int top = margin(input.height, result.height);
  const int left = margin(input.width, result.width);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      for (int o = 0; o < outputs; ++o) {
        double sum = 0.0;
        for (int v = 0; v < size; ++v) {
          for (int u = 0; u < size; ++u) {
            const int yy = y * stride + v - top;
            const int xx = x * stride + u - left;
            if (yy < 0 || xx < 0 || yy >= input.height || xx >= input.width) continue;
            for (int i = is_depthwise ? o : 0; i < (is_depthwise ? o + 1 : input.channels); ++i) {
              const int place = is_depthwise ? (v * size + u) * input.channels + i
                                             : ((v * size + u) * input.channels + i) * outputs + o;
              sum += static_cast<double>(input.At(yy, xx)[i]) * kernel[static_cast<std::size_t>(place)];
            }
          }
        }
        result.values.push_back(static_cast<float>(sum));
      }
    }
  }
  return result;
}

void ExpectNear(const FeatureMap& a, const FeatureMap& b) {
  ASSERT_EQ(a.height, b.height);
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.channels, b.channels);
  for (std::size_t i = 0; i < a.values.size(); ++i) ASSERT_NEAR(a.values[i], b.values[i], 1e-5) << i;
}

TEST(ConvNetwork, ConvolvesAsTensorFlowDoes) {
  const testing::TemporaryFolder folder;
  const std::vector<float> full = Numbers(3 * 3 * 3 * 5, 1);
  const std::vector<float> depthwise = Numbers(5 * 5 * 5, 2);
  const std::vector<float> pointwise = Numbers(5 * 4, 3);
  for (const int stride : {1, 2}) {
    GraphFile file;
    file.Weights("k", {3, 3, 3, 5}, full).Weights("d", {5, 5, 5, 1}, depthwise).Weights("p", {1, 1, 5, 4}, pointwise);
    file.Node("in", "Placeholder", {});
    file.Node("a", "_FusedConv2D", {"in", "k"}, ConvolutionAttributes(stride, true));
    file.Node("b", "DepthwiseConv2dNative", {"a", "d"}, ConvolutionAttributes(stride, true));
    file.Node("c", "_FusedConv2D", {"b", "p"}, ConvolutionAttributes(1, false));
    const ConvNetwork network(ReadGraphModel(file.Write(folder)), "in", {"a", "b", "c"});
    EXPECT_EQ(network.operator_count(), 3);
    const FeatureMap input{64, 32, 3, Numbers(64 * 32 * 3, 4)};
    const std::vector<FeatureMap> maps = network.Evaluate(input.values, 64, 32);
    const FeatureMap a = Convolve(input, full, 3, 5, stride, false);
    const FeatureMap b = Convolve(a, depthwise, 5, 5, stride, true);
    ExpectNear(maps[0], a);
    ExpectNear(maps[1], b);
    ExpectNear(maps[2], Convolve(b, pointwise, 1, 4, 1, false));
    // A second evaluation, in memory that is used again, gives the same.
    EXPECT_EQ(network.Evaluate(input.values, 64, 32)[2].values, maps[2].values);
  }
}

TEST(ConvNetwork, AddsBiasClampsAddsAndDoubles) {
  const testing::TemporaryFolder folder;
  GraphFile file;
  file.Weights("k", {1, 1, 3, 1}, {100.0F, 0.0F, 0.0F}).Weights("bias", {1}, {1.0F});
  file.Node("in", "Placeholder", {});
  file.Node("a", "_FusedConv2D", {"in", "k", "bias"},
            ConvolutionAttributes(1, true, {kBiasAddInBase64, kRelu6InBase64}));
  file.Node("sum", "AddV2", {"a", "a"});
  file.Node("large", "ResizeBilinear", {"sum", "size"}, {{"half_pixel_centers", {{"b", true}}}});
  const ConvNetwork network(ReadGraphModel(file.Write(folder)), "in", {"sum", "large"});
  std::vector<float> input(32 * 32 * 3, 0.0F);
  input[0] = 0.02F;  // 2 + 1
  input[3] = 1.0F;   // more than 6
  input[6] = -1.0F;  // less than 0
  const std::vector<FeatureMap> maps = network.Evaluate(input, 32, 32);
  EXPECT_FLOAT_EQ(*maps[0].At(0, 0), 6.0F);
  EXPECT_FLOAT_EQ(*maps[0].At(0, 1), 12.0F);
  EXPECT_FLOAT_EQ(*maps[0].At(0, 2), 0.0F);
  EXPECT_FLOAT_EQ(*maps[0].At(5, 5), 2.0F);
  ASSERT_EQ(maps[1].height, 64);
  EXPECT_FLOAT_EQ(*maps[1].At(0, 0), 6.0F) << "pixels' centres are half a pixel from their corners";
  EXPECT_FLOAT_EQ(*maps[1].At(0, 1), 0.75F * 6.0F + 0.25F * 12.0F);
  EXPECT_FLOAT_EQ(*maps[1].At(0, 2), 0.25F * 6.0F + 0.75F * 12.0F);
}

TEST(ConvNetwork, RefusesGraphsThatItCannotEvaluate) {
  const testing::TemporaryFolder folder;
  const auto message = [&](const std::string& op, const std::vector<std::string>& inputs,
                           const nlohmann::json& attributes = nlohmann::json::object()) {
    GraphFile file;
    file.Weights("k", {3, 3, 3, 2}, Numbers(54, 1))
        .Weights("short", {1}, {0.0F})
        .Weights("none", {1, 1, 3, 0}, {})
        .Weights("wide", {3, 3, 7, 2}, Numbers(126, 1));
    file.Node("in", "Placeholder", {}).Node("a", op, inputs, attributes);
    const GraphModel model = ReadGraphModel(file.Write(folder));
    return testing::ErrorOf(ErrorKind::kBadInput, [&] { const ConvNetwork network(model, "in", {"a"}); });
  };
  EXPECT_THAT(message("MatMul", {"in", "k"}), HasSubstr("found MatMul"));
  EXPECT_THAT(message("_FusedConv2D", {"in"}, ConvolutionAttributes(1, true)), HasSubstr("2 inputs"));
  EXPECT_THAT(message("_FusedConv2D", {"in", "gone"}, ConvolutionAttributes(1, true)), HasSubstr("the weights gone"));
  EXPECT_THAT(message("_FusedConv2D", {"gone", "k"}, ConvolutionAttributes(1, true)), HasSubstr("the operator gone"));
  EXPECT_THAT(message("_FusedConv2D", {"in", "k"}), HasSubstr("strides"));
  EXPECT_THAT(message("_FusedConv2D", {"in", "k", "short"}, ConvolutionAttributes(1, true, {kBiasAddInBase64})),
              HasSubstr("a bias of 2 values"));
  EXPECT_THAT(message("_FusedConv2D", {"in", "wide"}, ConvolutionAttributes(1, true)),
              HasSubstr("weights that fit the operators"));
  EXPECT_THAT(message("AddV2", {"in", "a"}), HasSubstr("needs its own output"));
  EXPECT_THAT(message("_FusedConv2D", {"in", "none"}, ConvolutionAttributes(1, true)),
              HasSubstr("a kernel of four dimensions"));
  EXPECT_THAT(message("ResizeBilinear", {"in"}), HasSubstr("half_pixel_centers"));
}

TEST(ConvNetwork, RefusesChainsThatWouldFillTheStack) {
  const testing::TemporaryFolder folder;
  GraphFile file;
  file.Node("in", "Placeholder", {});
  std::string last = "in";
  for (int i = 0; i < 100000; ++i) {
    const std::string name = fmt::format("a{}", i);
    file.Node(name, "AddV2", {last, last});
    last = name;
  }
  const GraphModel model = ReadGraphModel(file.Write(folder));
  EXPECT_THAT(testing::ErrorOf(ErrorKind::kBadInput, [&] { const ConvNetwork network(model, "in", {last}); }),
              HasSubstr("no more than 1000 operators in a row"));
  EXPECT_EQ(ConvNetwork(model, "in", {"a900"}).operator_count(), 901);
}

}  // namespace
}  // namespace canonpose
