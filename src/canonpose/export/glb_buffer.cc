#include "canonpose/export/glb_buffer.h"

#include <algorithm>
#include <cstring>

namespace canonpose {

int GlbBuffer::Add(const void* data, std::size_t bytes, std::size_t count, int component, int type, Use use) {
  std::vector<unsigned char>& buffer = model_.buffers.front().data;
  buffer.resize((buffer.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer.size();
  view.byteLength = bytes;
  if (use == Use::kVertices) view.target = TINYGLTF_TARGET_ARRAY_BUFFER;
  if (use == Use::kIndices) view.target = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
  buffer.resize(buffer.size() + bytes);
  std::memcpy(buffer.data() + view.byteOffset, data, bytes);
  model_.bufferViews.push_back(view);
  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model_.bufferViews.size()) - 1;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model_.accessors.push_back(accessor);
  return static_cast<int>(model_.accessors.size()) - 1;
}

int GlbBuffer::AddFloats(const std::vector<float>& values, int type, Use use, bool has_range) {
  const auto width = static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
  const int index = Add(values.data(), values.size() * sizeof(float), values.size() / width,
                        TINYGLTF_COMPONENT_TYPE_FLOAT, type, use);
  if (!has_range || values.empty()) return index;
  tinygltf::Accessor& accessor = model_.accessors.back();
  accessor.minValues.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(width));
  accessor.maxValues = accessor.minValues;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    accessor.minValues[i % width] = std::min(accessor.minValues[i % width], value);
    accessor.maxValues[i % width] = std::max(accessor.maxValues[i % width], value);
  }
  return index;
}

int GlbBuffer::AddIndices(const std::vector<std::uint32_t>& indices) {
  return Add(indices.data(), indices.size() * sizeof(std::uint32_t), indices.size(),
             TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, Use::kIndices);
}

int GlbBuffer::AddBytes(const std::vector<std::array<std::uint8_t, 4>>& values, bool is_share) {
  const int index = Add(values.data(), values.size() * 4, values.size(), TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE,
                        TINYGLTF_TYPE_VEC4, Use::kVertices);
  model_.accessors.back().normalized = is_share;
  return index;
}

}  // namespace canonpose
