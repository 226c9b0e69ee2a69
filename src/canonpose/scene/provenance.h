// What is known of a world, from what, and how surely.
#pragma once

#include <limits>
#include <string>

namespace canonpose {

/// Something that was found or given, and how: "the height given", "" where it is unknown.
struct Provenance {
  std::string source;
  /// A standard deviation: degrees of an angle, the unit of the scene's people of a length, percent of a scale; NaN
  /// where nobody knows.
  double uncertainty = std::numeric_limits<double>::quiet_NaN();

  [[nodiscard]] bool is_known() const { return !source.empty(); }
};

/// What is known of the world of some people and cameras.
struct WorldProvenance {
  Provenance up;     ///< that z points up; degrees
  Provenance floor;  ///< that it is z = 0; in the unit of the people
  Provenance scale;  ///< that lengths are in millimetres; percent
};

}  // namespace canonpose
