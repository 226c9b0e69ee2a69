// The binary part of a GLB file: arrays, as accessors.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tiny_gltf.h>

namespace canonpose {

/// Appends arrays to a model's only buffer. Each has its own buffer view, since values of vertices, indices and
/// animations must not share one.
class GlbBuffer {
 public:
  explicit GlbBuffer(tinygltf::Model& model) : model_(model) {
    if (model_.buffers.empty()) model_.buffers.emplace_back();
  }

  enum class Use { kVertices, kIndices, kOther };

  /// Floats of `type` (TINYGLTF_TYPE_SCALAR, _VEC3, ...). Minimum and maximum are stated where `has_range`, as the
  /// format demands of positions and times. Returns the accessor.
  int AddFloats(const std::vector<float>& values, int type, Use use, bool has_range = false);
  int AddIndices(const std::vector<std::uint32_t>& indices);
  /// Four per vertex; `is_share`: 255 stands for 1.
  int AddBytes(const std::vector<std::array<std::uint8_t, 4>>& values, bool is_share);

 private:
  int Add(const void* data, std::size_t bytes, std::size_t count, int component, int type, Use use);

  tinygltf::Model& model_;
};

}  // namespace canonpose
