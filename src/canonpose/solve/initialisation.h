// From rotations between cameras to a first estimate of everything, in closed form or frame by frame.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/geometry/points.h"
#include "canonpose/geometry/triangulation.h"
#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/rig_estimate.h"

namespace canonpose {

/// F R F with F = diag(1, 1, -1). Under orthography a pose X seen with rotation R and its mirror F X seen with F R F
/// give the same image: the depth-reversal ambiguity.
Eigen::Matrix3d MirrorRotation(const Eigen::Matrix3d& rotation);

/// The pose of one frame under scaled orthography.
struct FrameShape {
  Points3d joints;             ///< (J, 3) in the world, centred on the root; the sum of the bone lengths is 1
  std::vector<double> scales;  ///< (V) normalised image coordinates per unit; 0 where the view was not used
  bool valid = false;          ///< at least two views have a start pose and a rotation and do not contradict each other
};

/// The joints that fit the views' keypoints best under scaled orthography, given the cameras' rotations (V). They are
/// pulled a little towards the mean of the start's poses, which fill in what is not seen. With `mirrored`, the
/// start's poses are mirrored first; the rotations must then be those of the mirror.
FrameShape ShapeFromViews(const CaptureObservations& capture, int frame,
                          std::span<const Eigen::Matrix3d> camera_from_world, bool mirrored);

/// A first estimate for static cameras from their rotations (V); joints are set at `frames` only. All cameras have the
/// given focal length, in image diagonals. The root's distance from a camera follows from the image scale, and the
/// cameras' translations from the root's trajectories in their frames. Cameras without a rotation, or without a frame
/// in common with the others, are invalid.
RigEstimate InitialiseStatic(const CaptureObservations& capture, std::span<const int> frames,
                             std::span<const Eigen::Matrix3d> camera_from_world, bool mirrored, double focal = 1.0);

/// The same for moving cameras, from the rotations (F, V) of all frames of the capture.
RigEstimate InitialiseMoving(const CaptureObservations& capture, std::span<const int> frames,
                             const std::vector<std::vector<Eigen::Matrix3d>>& camera_from_world, bool mirrored);

/// A joint from the views that see it (TriangulateRobustly()), in body units. `left_out_view` is not used; -1 uses all
/// views.
RobustPoint TriangulateJoint(const CaptureObservations& capture, int frame, int joint, const AdjustmentScales& scales,
                             const RigEstimate& estimate, int left_out_view = -1);

/// Sets the joints of a frame by TriangulateJoint(), given the cameras of a static rig. A joint that only one view sees
/// is placed at its bone's length from its parent, in the direction that the start's poses give; one that two views see
/// from opposite sides is drawn to there in the direction in which they look; one that no view sees becomes NaN.
/// `mirrored` as above.
void TriangulateFrame(const CaptureObservations& capture, int frame, const AdjustmentScales& scales, bool mirrored,
                      RigEstimate& estimate);

/// Sets each subject's bone lengths to their medians over `frames`. Bones without a length in any frame are left alone.
void MeasureBones(const CaptureObservations& capture, std::span<const int> frames, RigEstimate& estimate);

}  // namespace canonpose
