// Single values as JSON, in files that are otherwise written by hand.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace canonpose {

/// On one line; bytes that are not UTF-8 are replaced.
inline std::string JsonText(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace canonpose
