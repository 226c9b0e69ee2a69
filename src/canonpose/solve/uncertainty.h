// How uncertain solved joints are.
#pragma once

#include <vector>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// The standard deviation of each joint along an axis (F, J), body units: the root of the mean over three axes. NaN
/// where a joint is not solved.
///
/// It is that of the joint's place in the body and, where cameras stand, in the scene. What keypoints leave open or
/// what moves everything alike is not in it: where the scene is, how it is turned and how large it is; and, where
/// cameras move, how they drift.
///
///   s^2 = (k q n)^2 + (b typical)^2
///
/// n is the scatter of the triangulated joint: that of the keypoints, carried through the weights that the adjustment
/// gave them. A keypoint with a large weight draws the joint, so that its distance from it says little; the scatter of
/// keypoints is measured with distances that are corrected for that. Keypoints whose distance is large for their
/// scatter count as so much more uncertain. q is how much larger the distances of this joint's keypoints are in the
/// third of a second around the frame than that scatter lets expect, so that the uncertainty is large where views
/// disagree. b stands for the cameras' errors, k for smoothness and bones; both were measured: experiments/uncertainty.
std::vector<double> MeasureUncertainty(const CaptureObservations& capture, const Solution& solution);

}  // namespace canonpose
