// The names of cameras as keys of OpenCV's FileStorage, which allows few characters in them.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace canonpose {

/// A camera's name with '_' for every character that a key of cv::FileStorage cannot have.
inline std::string OpenCvKey(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return c >= 0x80 || (std::isalnum(c) == 0 && c != '-' && c != '_'); }, '_');
  return name;
}

}  // namespace canonpose
