#include "canonpose/detect/graph_model.h"

#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/data/codecs/json.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

/// No weight of such a network is larger; what is comes from a damaged file.
constexpr std::size_t kLargestConstant = 1U << 26U;

/// The bytes behind base64, which is how the format writes strings.
std::string DecodeBase64(const JsonValue& value) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : value.String()) {
    if (c == '=') break;
    const std::size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) value.Fail("base64", kGetDetectorAgain);
    bits = (bits << 6U) | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    text.push_back(static_cast<char>((bits >> static_cast<unsigned>(count)) & 0xFFU));
  }
  return text;
}

/// Integers, which the format writes as strings.
int ToInt(const JsonValue& value) {
  if (value.json().is_number_integer()) {
    const std::int64_t integer = value.Integer();
    if (!std::in_range<int>(integer)) value.Fail("an integer of 32 bits", kGetDetectorAgain);
    return static_cast<int>(integer);
  }
  const std::string text = value.String();
  int integer = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
  if (error != std::errc() || end != text.data() + text.size()) value.Fail("an integer of 32 bits", kGetDetectorAgain);
  return integer;
}

/// attr.NAME.list.KIND
std::optional<JsonValue> ListAttribute(const JsonValue& attributes, const char* name, const char* kind) {
  const std::optional<JsonValue> attribute = attributes.Find(name);
  const std::optional<JsonValue> list = attribute ? attribute->Find("list") : std::nullopt;
  return list ? list->Find(kind) : std::nullopt;
}

void ReadAttributes(const JsonValue& attributes, GraphNode& node) {
  if (const std::optional<JsonValue> strides = ListAttribute(attributes, "strides", "i")) {
    for (std::size_t i = 0; i < strides->ArraySize(); ++i) node.strides.push_back(ToInt(strides->At(i)));
  }
  if (const std::optional<JsonValue> ops = ListAttribute(attributes, "fused_ops", "s")) {
    for (std::size_t i = 0; i < ops->ArraySize(); ++i) node.fused_ops.push_back(DecodeBase64(ops->At(i)));
  }
  if (const std::optional<JsonValue> padding = attributes.Find("padding"); padding && padding->Has("s")) {
    node.padding = DecodeBase64((*padding)["s"]);
  }
  if (const std::optional<JsonValue> centers = attributes.Find("half_pixel_centers"); centers && centers->Has("b")) {
    node.half_pixel_centers = (*centers)["b"].json() == true;
  }
}

GraphNode ReadNode(const JsonValue& value) {
  GraphNode node;
  node.name = value["name"].String();
  node.op = value["op"].String();
  if (const std::optional<JsonValue> inputs = value.Find("input")) {
    for (std::size_t i = 0; i < inputs->ArraySize(); ++i) node.inputs.push_back(inputs->At(i).String());
  }
  if (const std::optional<JsonValue> attributes = value.Find("attr")) ReadAttributes(*attributes, node);
  return node;
}

/// Takes the weights from the file one after the other.
class WeightBytes {
 public:
  explicit WeightBytes(const fs::path& path) : path_(path), bytes_(ReadFile(path)) {}

  GraphConstant Take(const JsonValue& entry) {
    GraphConstant constant;
    const JsonValue shape = entry["shape"];
    std::size_t count = 1;
    for (std::size_t i = 0; i < shape.ArraySize(); ++i) {
      const int extent = ToInt(shape.At(i));
      if (extent < 0 || (extent > 0 && count > kLargestConstant / static_cast<std::size_t>(extent))) {
        shape.Fail("the shape of a weight", kGetDetectorAgain);
      }
      count *= static_cast<std::size_t>(extent);
      constant.shape.push_back(extent);
    }
    const std::string type = StoredType(entry);
    constant.values.reserve(std::min(count, bytes_.size()));
    for (std::size_t i = 0; i < count; ++i) constant.values.push_back(Value(type, entry));
    return constant;
  }

  void RequireEnd() const {
    if (next_ == bytes_.size()) return;
    ThrowBadInput(
        {path_.string(), "", fmt::format("{} bytes", next_), fmt::format("{}", bytes_.size()), kGetDetectorAgain});
  }

 private:
  static std::string StoredType(const JsonValue& entry) {
    const std::optional<JsonValue> quantization = entry.Find("quantization");
    const JsonValue type = quantization ? (*quantization)["dtype"] : entry["dtype"];
    std::string name = type.String();
    if (name != "float16" && name != "float32" && name != "int32")
      type.Fail("float16, float32 or int32", kGetDetectorAgain);
    return name;
  }

  float Value(const std::string& type, const JsonValue& entry) {
    if (type == "float16") return HalfToFloat(Read<std::uint16_t>(entry));
    if (type == "int32") return static_cast<float>(Read<std::int32_t>(entry));
    return Read<float>(entry);
  }

  template <typename Number>
  Number Read(const JsonValue& entry) {
    if (bytes_.size() - next_ < sizeof(Number)) {
      ThrowBadInput({path_.string(), "", "the weights that " + entry.file() + " names, up to " + entry["name"].String(),
                     fmt::format("{} bytes", bytes_.size()), kGetDetectorAgain});
    }
    Number number;
    std::memcpy(&number, bytes_.data() + next_, sizeof number);
    next_ += sizeof number;
    return number;
  }

  fs::path path_;
  std::string bytes_;
  std::size_t next_ = 0;
};

}  // namespace

float HalfToFloat(std::uint16_t half) {
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000U) << 16U;
  const std::uint32_t exponent = (half >> 10U) & 0x1FU;
  const std::uint32_t fraction = half & 0x3FFU;
  if (exponent == 0x1FU) return std::bit_cast<float>(sign | 0x7F800000U | (fraction << 13U));
  if (exponent > 0) return std::bit_cast<float>(sign | ((exponent + 112U) << 23U) | (fraction << 13U));
  // Zero, and numbers too small for an exponent: multiples of 2^-24.
  const float value = static_cast<float>(fraction) * 0x1p-24F;
  return sign != 0 ? -value : value;
}

const GraphNode& GraphModel::Node(const std::string& name) const {
  const auto found = nodes.find(name);
  if (found == nodes.end())
    ThrowBadInput({file, "modelTopology.node", "the operator " + name, "none", kGetDetectorAgain});
  return found->second;
}

const GraphConstant& GraphModel::Constant(const std::string& name) const {
  const auto found = constants.find(name);
  if (found == constants.end())
    ThrowBadInput({file, "weightsManifest", "the weights " + name, "none", kGetDetectorAgain});
  return found->second;
}

const GraphNode& GraphModel::NodeLike(const std::string& begin, const std::string& end) const {
  const GraphNode* found = nullptr;
  int count = 0;
  for (const auto& [name, node] : nodes) {
    if (!name.starts_with(begin) || !name.ends_with(end) || node.op == "Const") continue;
    found = &node;
    ++count;
  }
  if (count == 1) return *found;
  ThrowBadInput({file, "modelTopology.node", fmt::format("one operator {}...{}", begin, end), fmt::format("{}", count),
                 kGetDetectorAgain});
}

GraphModel ReadGraphModel(const fs::path& json) {
  const JsonValue root = JsonValue::Load(json);
  GraphModel model;
  model.file = json.string();
  const JsonValue nodes = root["modelTopology"]["node"];
  for (std::size_t i = 0; i < nodes.ArraySize(); ++i) {
    GraphNode node = ReadNode(nodes.At(i));
    std::string name = node.name;
    model.nodes.emplace(std::move(name), std::move(node));
  }
  const JsonValue manifest = root["weightsManifest"];
  if (manifest.ArraySize() != 1 || manifest.At(0)["paths"].ArraySize() != 1) {
    manifest.Fail("one file of weights", kGetDetectorAgain, fmt::format("{} groups of files", manifest.ArraySize()));
  }
  fs::path weights = json;
  WeightBytes bytes(weights.replace_extension(".bin"));
  const JsonValue entries = manifest.At(0)["weights"];
  for (std::size_t i = 0; i < entries.ArraySize(); ++i) {
    const JsonValue entry = entries.At(i);
    model.constants[entry["name"].String()] = bytes.Take(entry);
  }
  bytes.RequireEnd();
  return model;
}

}  // namespace canonpose
