// Angles: radians everywhere in the code, degrees where people read or write them.
#pragma once

#include <numbers>

namespace canonpose {

constexpr double RadFromDeg(double degrees) { return degrees * std::numbers::pi / 180.0; }
constexpr double DegFromRad(double radians) { return radians * 180.0 / std::numbers::pi; }

}  // namespace canonpose
