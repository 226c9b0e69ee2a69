// Shared by tests only: writes small graph models.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "canonpose/base/temporary_folder.h"
#include "canonpose/detect/graph_model.h"

namespace canonpose::testing {

/// A model in the making: operators and 32-bit weights.
class GraphFile {
 public:
  /// Adds weights, and the node that stands for them.
  GraphFile& Weights(const std::string& name, const std::vector<int>& shape, const std::vector<float>& values) {
    nodes_.push_back({{"name", name}, {"op", "Const"}});
    entries_.push_back({{"name", name}, {"shape", shape}, {"dtype", "float32"}});
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    return *this;
  }

  GraphFile& Node(const std::string& name, const std::string& op, const std::vector<std::string>& inputs,
                  const nlohmann::json& attributes = nlohmann::json::object()) {
    nodes_.push_back({{"name", name}, {"op", op}, {"input", inputs}, {"attr", attributes}});
    return *this;
  }

  [[nodiscard]] nlohmann::json ToJson() const {
    return {{"format", "graph-model"},
            {"modelTopology", {{"node", nodes_}}},
            {"weightsManifest", {{{"paths", {"model.bin"}}, {"weights", entries_}}}}};
  }

  /// Writes model.json and model.bin; returns the path of the first.
  std::filesystem::path Write(const TemporaryFolder& folder) const {
    std::ofstream(folder / "model.bin", std::ios::binary) << bytes_;
    std::ofstream(folder / "model.json") << ToJson().dump();
    return folder / "model.json";
  }

 private:
  nlohmann::json nodes_ = nlohmann::json::array();
  nlohmann::json entries_ = nlohmann::json::array();
  std::string bytes_;
};

/// Attributes of a convolution. Strings are base64: U0FNRQ== is SAME, VkFMSUQ= VALID.
inline nlohmann::json ConvolutionAttributes(int stride, bool is_same, const std::vector<std::string>& fused = {}) {
  const std::string step = std::to_string(stride);
  nlohmann::json attributes{{"strides", {{"list", {{"i", {"1", step, step, "1"}}}}}},
                            {"padding", {{"s", is_same ? "U0FNRQ==" : "VkFMSUQ="}}}};
  if (!fused.empty()) attributes["fused_ops"] = {{"list", {{"s", fused}}}};
  return attributes;
}
inline constexpr const char* kBiasAddInBase64 = "Qmlhc0FkZA==";
inline constexpr const char* kRelu6InBase64 = "UmVsdTY=";

}  // namespace canonpose::testing
