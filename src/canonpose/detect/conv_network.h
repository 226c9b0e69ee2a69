// Evaluates the convolutional part of a graph model on the CPU. No LibTorch in this header.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "canonpose/detect/graph_model.h"

namespace canonpose {

/// One output: row-major (height, width, channels).
struct FeatureMap {
  int height = 0;
  int width = 0;
  int channels = 0;
  std::vector<float> values;

  [[nodiscard]] const float* At(int y, int x) const {
    return &values[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
                   static_cast<std::size_t>(channels)];
  }
};

/// The operators between `input`, a node whose value is given, and the nodes `outputs`: convolutions, depthwise
/// convolutions, with or without bias and relu or relu6, additions, and bilinear resizing to twice the size. Each
/// object is for one thread at a time; objects on several threads need not know of each other.
class ConvNetwork {
 public:
  /// Throws Error(kBadInput) where the graph has other operators in that part, or weights that do not fit them.
  ConvNetwork(const GraphModel& model, const std::string& input, const std::vector<std::string>& outputs);
  ~ConvNetwork();
  ConvNetwork(ConvNetwork&&) noexcept;
  ConvNetwork& operator=(ConvNetwork&&) noexcept;

  /// The outputs, in the order given, for an input (height, width, 3), both multiples of 32.
  [[nodiscard]] std::vector<FeatureMap> Evaluate(std::span<const float> input, int height, int width) const;

  /// Height, width and channels of the outputs for an input of 32x32.
  [[nodiscard]] const std::vector<std::array<int, 3>>& output_shapes() const;

  /// How many operators there are.
  [[nodiscard]] int operator_count() const;

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace canonpose
