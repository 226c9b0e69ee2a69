#include "canonpose/export/nested_json.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

template <typename T>
void AppendNestedJson(const T*& value, const std::vector<std::size_t>& shape, std::size_t depth, std::string& text) {
  if (depth == shape.size()) {
    if (std::isfinite(*value)) {
      fmt::format_to(std::back_inserter(text), "{}", *value);
    } else {
      text += "null";
    }
    ++value;
    return;
  }
  text += '[';
  for (std::size_t i = 0; i < shape[depth]; ++i) {
    if (i > 0) text += ", ";
    AppendNestedJson(value, shape, depth + 1, text);
  }
  text += ']';
}

template <typename T>
std::string NestedJsonOf(const std::vector<T>& values, const std::vector<std::size_t>& shape, int indent) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  CANONPOSE_CHECK(!shape.empty() && count == values.size(), "{} values for a shape of {}", values.size(), count);
  const std::string line = "\n" + std::string(static_cast<std::size_t>(indent), ' ');
  std::string text = "[";
  const T* value = values.data();
  for (std::size_t i = 0; i < shape.front(); ++i) {
    text += (i == 0 ? "" : ",") + line;
    AppendNestedJson(value, shape, 1, text);
  }
  if (shape.front() > 0) text += line.substr(0, line.size() - (indent >= 2 ? 2 : 0));
  return text + ']';
}

}  // namespace

std::string NestedJson(const std::vector<float>& values, const std::vector<std::size_t>& shape, int indent) {
  return NestedJsonOf(values, shape, indent);
}

std::string NestedJson(const std::vector<double>& values, const std::vector<std::size_t>& shape, int indent) {
  return NestedJsonOf(values, shape, indent);
}

}  // namespace canonpose
