// Whether a capture can be solved, and whether its solution is plausible.
#pragma once

#include <string>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Frames that two cameras must share. Fewer determine the cameras poorly.
inline constexpr int kMinFrames = 10;

/// What a recording lacks to be solved at all: cameras, frames that two of them share, or motion. One line; empty where
/// nothing is missing.
std::string MissingInput(const CaptureObservations& capture);

/// Figures that give a wrong solution away. Lengths are in body units.
struct Plausibility {
  double reprojection = 0.0;      ///< median distance of keypoints
  double view_angle_deg = 0.0;    ///< the largest between two viewing axes, modulo 180 degrees; median over frames
  double depth_over_width = 0.0;  ///< extent of poses along the viewing axes against across; median
  double bone_scatter = 0.0;      ///< median |log(length / the subject's)| of bones between triangulated joints
  double asymmetry = 0.0;         ///< median over limbs of |log(left length / right length)|
};

Plausibility MeasurePlausibility(const CaptureObservations& capture, const Solution& solution);

/// Why a solution cannot be right, one line; empty where it can.
std::string Implausible(const Plausibility& plausibility);

/// A warning about a solution that may be right, one line; empty where there is nothing to warn of.
std::string Doubtful(const Plausibility& plausibility);

/// How far the keypoints of a capture move over time, in units of the body's size in the image. Where cameras move,
/// keypoints are taken relative to the root and to that size.
double MotionSpread(const CaptureObservations& capture);

}  // namespace canonpose
