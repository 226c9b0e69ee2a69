// Reads graph models of TensorFlow.js: NAME.json with the operators, NAME.bin with the weights. No LibTorch here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace canonpose {

/// The advice of every error about a model's files.
inline constexpr const char* kGetDetectorAgain = "get the detector again";

/// A constant of the graph, as 32-bit floats whatever the file has; integers are exact up to 2^24.
struct GraphConstant {
  std::vector<int>
      shape;  ///< as TensorFlow has it: convolutions (height, width, in, out), depthwise (height, width, in, 1)
  std::vector<float> values;  ///< row-major
};

/// One operator.
struct GraphNode {
  std::string name;
  std::string op;                      ///< "_FusedConv2D", ...
  std::vector<std::string> inputs;     ///< names of nodes
  std::vector<int> strides;            ///< (4) batch, height, width, channel; empty where it has none
  std::vector<std::string> fused_ops;  ///< "BiasAdd", "Relu6"
  std::string padding;                 ///< "SAME", "VALID" or empty
  bool half_pixel_centers = false;
};

struct GraphModel {
  std::string file;  ///< of the operators, for messages
  std::map<std::string, GraphNode> nodes;
  std::map<std::string, GraphConstant> constants;

  /// Throw Error(kBadInput) where there is none of that name.
  [[nodiscard]] const GraphNode& Node(const std::string& name) const;
  [[nodiscard]] const GraphConstant& Constant(const std::string& name) const;
  /// The only node whose name begins and ends like that. Throws Error(kBadInput) where there is none or several.
  [[nodiscard]] const GraphNode& NodeLike(const std::string& begin, const std::string& end) const;
};

/// Reads the model. Throws Error(kBadInput) where a file cannot be read, is cut off or is not such a model.
GraphModel ReadGraphModel(const std::filesystem::path& json);

/// The value of a 16-bit float (IEEE 754 binary16), as weights are stored.
float HalfToFloat(std::uint16_t half);

}  // namespace canonpose
