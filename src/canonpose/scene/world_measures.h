// What people tell of the size of a scene, and the scale that follows from it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "canonpose/scene/scene.h"

namespace canonpose {

struct KnownHeight {
  std::string person;  ///< empty: of everybody
  double height_mm = 0.0;

  /// Parses "1.75" or "Ann=1.75", metres. Throws Error(kInvalidArgument), naming `height`.
  static KnownHeight Parse(const std::string& text);
};

struct KnownDistance {
  std::string camera;
  std::string other;
  double distance_mm = 0.0;

  /// Parses "cam1,cam2=4.2", metres. Throws Error(kInvalidArgument), naming `camera_distance`.
  static KnownDistance Parse(const std::string& text);
};

/// What is known of sizes: heights or distances, not both.
struct WorldMeasures {
  std::vector<KnownHeight> heights;
  std::vector<KnownDistance> distances;  ///< of static cameras
  /// Where the distances come from, "the calibration"; empty: they were given.
  std::string distances_source{};
};

/// The scale of scenes, in millimetres per unit, from the heights of people and the lengths of their bones
/// (stature.h). Nothing where none of them, or too few bones, are in the scenes.
struct MeasuredScale {
  double mm_per_unit = 0.0;
  Provenance known;  ///< percent
};
std::optional<MeasuredScale> ScaleByHeights(std::span<const Scene> scenes, const std::vector<KnownHeight>& heights);

/// The same from distances between static cameras. Throws Error(kInvalidArgument) where one of them was not solved, or
/// two are at the same place.
MeasuredScale ScaleByDistances(const std::vector<const SceneCamera*>& cameras, const WorldMeasures& measures);

}  // namespace canonpose
