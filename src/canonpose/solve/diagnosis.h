// Whether a capture can be solved, and whether what came out can be true.
#pragma once

#include <string>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Fewer frames that two cameras share say too little of the cameras.
inline constexpr int kMinFrames = 10;

/// What a recording lacks before anything is tried: cameras, frames that two of them share, motion. Empty where
/// nothing is missing; one line otherwise.
std::string MissingInput(const CaptureObservations& capture);

/// Figures that a wrong solution gives away. Lengths in body units.
struct Plausibility {
  double reprojection = 0.0;      ///< median distance of keypoints
  double view_angle_deg = 0.0;    ///< the largest between two viewing axes, modulo 180 degrees; median over frames
  double depth_over_width = 0.0;  ///< extent of poses along the viewing axes against across; median
  double bone_scatter = 0.0;      ///< median |log(length / the subject's)| of bones between triangulated joints
  double asymmetry = 0.0;         ///< median over limbs of |log(left length / right length)|
};

Plausibility MeasurePlausibility(const CaptureObservations& capture, const Solution& solution);

/// Why a solution cannot be believed, one line; empty where it can.
std::string Implausible(const Plausibility& plausibility);

/// What is to be warned of in a solution that may be right, one line; empty where there is nothing.
std::string Doubtful(const Plausibility& plausibility);

/// How much the keypoints of a capture change over time (of moving cameras: relative to the root and the body's size in
/// the image), body sizes.
double MotionSpread(const CaptureObservations& capture);

}  // namespace canonpose
