// The keys under which people's scripts keep frames, whatever the detector.
#pragma once

#include <array>
#include <optional>

#include "canonpose/data/codecs/json.h"

namespace canonpose {

/// Under which a frame keeps its number.
inline constexpr std::array<const char*, 7> kFrameKeys{"frame",       "frame_id",   "frame_number", "frame_idx",
                                                       "frame_index", "frameIndex", "frameNumber"};
/// Under which a file keeps the list of its frames, or an object of them by number.
inline constexpr std::array<const char*, 4> kFrameListKeys{"frames", "results", "data", "sequence"};

/// The first of an object's members that is not null; nothing where there is none.
std::optional<JsonValue> FindAny(const JsonValue& object, const auto& keys) {
  for (const char* const key : keys) {
    if (std::optional<JsonValue> value = object.Find(key)) return value;
  }
  return std::nullopt;
}

/// The first of an object's members that is an array or an object; nothing where there is none.
std::optional<JsonValue> FindAnyList(const JsonValue& object, const auto& keys) {
  for (const char* const key : keys) {
    const std::optional<JsonValue> value = object.Find(key);
    if (value && value->json().is_structured()) return value;
  }
  return std::nullopt;
}

}  // namespace canonpose
