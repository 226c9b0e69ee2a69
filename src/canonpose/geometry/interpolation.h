// Interpolation between samples at equal distances.
#pragma once

#include <array>

namespace canonpose {

/// The weights of the samples 1 before, at, 1 after and 2 after a place, for a value `share` (0..1) of the way from the
/// second to the third: those of the cubic through them (Catmull and Rom, 1974), which passes through every sample with
/// the slope between its neighbours, or of the line through the middle two.
std::array<double, 4> CubicWeights(double share);
std::array<double, 4> LinearWeights(double share);

}  // namespace canonpose
