// Arrays of numbers as nested JSON. Not written by the library, which would print floats as doubles.
#pragma once

#include <string>
#include <vector>

namespace canonpose {

/// The values of an array of that shape as nested arrays, null where they are not finite. Each element of the first
/// dimension stands on a line of its own, `indent` characters in.
std::string NestedJson(const std::vector<float>& values, const std::vector<std::size_t>& shape, int indent);
std::string NestedJson(const std::vector<double>& values, const std::vector<std::size_t>& shape, int indent);

}  // namespace canonpose
