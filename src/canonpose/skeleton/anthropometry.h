// The proportions of the human body, by which a stature shows in the lengths of bones.
#pragma once

#include <array>
#include <string_view>

namespace canonpose {

/// A part of the body between two joints of one side, as FindPart() names them without the side.
struct BodySegment {
  std::string_view from;
  std::string_view to;
  double share;  ///< of the stature
};

/// Thigh, shank, upper arm, forearm and the trunk between hip and shoulder (Drillis and Contini 1966, as in Winter,
/// "Biomechanics and Motor Control of Human Movement").
inline constexpr std::array<BodySegment, 5> kBodySegments = {{{"hip", "knee", 0.245},
                                                              {"knee", "ankle", 0.246},
                                                              {"shoulder", "elbow", 0.186},
                                                              {"elbow", "wrist", 0.146},
                                                              {"shoulder", "hip", 0.288}}};

/// How high above the floor a joint of a foot is that stands flat on it, as a share of the stature. The ankle is from
/// the same source; detectors mark heels and toes near their surface.
inline constexpr double kAnkleHeight = 0.039;
inline constexpr double kHeelHeight = 0.012;
inline constexpr double kToeHeight = 0.008;

/// Throws Error(kInvalidArgument), naming `height`, where nobody is that tall; says so where the number is one in
/// centimetres or millimetres.
void RequireHeight(double height_m);

}  // namespace canonpose
