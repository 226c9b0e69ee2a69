// From rotations between cameras to a first estimate of everything, without iteration over unknowns of many frames.
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

/// The depth mirror of a rotation, F R F with F = diag(1, 1, -1).
Eigen::Matrix3d MirrorRotation(const Eigen::Matrix3d& rotation);

/// A frame as orthographic views with known rotations see it.
struct FrameShape {
  Points3d joints;             ///< (J, 3) in the world, centred on the root; the sum of the bone lengths is 1
  std::vector<double> scales;  ///< (V) normalised image coordinates a unit; 0 where the view has no part
  bool valid = false;          ///< two views at least were lifted and have a rotation
};

/// The joints that agree best with the views' keypoints under scaled orthographic projection, drawn a little towards
/// the mean of the lifter's poses, which fill in what is not seen. `mirrored`: the lifter's poses are depth-mirrored
/// first; rotations are then to be those of the mirrored poses.
FrameShape ShapeFromViews(const CaptureObservations& capture, int frame,
                          std::span<const Eigen::Matrix3d> camera_from_world, bool mirrored);

/// A first estimate from rotations (V) of static cameras at `frames`; other frames stay unknown. The root's distance
/// follows from its image scale and the focal length (one image diagonal), cameras' translations from the root's
/// trajectories as the cameras see them. Cameras without rotation, or without a common frame with the others, are
/// invalid.
RigEstimate InitialiseStatic(const CaptureObservations& capture, std::span<const int> frames,
                             std::span<const Eigen::Matrix3d> camera_from_world, bool mirrored);

/// The same for moving cameras; rotations (F, V) of all frames of the capture.
RigEstimate InitialiseMoving(const CaptureObservations& capture, std::span<const int> frames,
                             const std::vector<std::vector<Eigen::Matrix3d>>& camera_from_world, bool mirrored);

/// A joint from the views that see it (TriangulateRobustly()), in body units. `left_out_view` is ignored; -1: none is.
RobustPoint TriangulateJoint(const CaptureObservations& capture, int frame, int joint, const AdjustmentScales& scales,
                             const RigEstimate& estimate, int left_out_view = -1);

/// Sets the joints of a frame of a static rig whose cameras are known, by linear triangulation from all views that see
/// them, reweighted so that a bad view counts little. Joints seen by one view only are put beside their parent in the
/// direction that the lifter gives them; those that nobody sees become NaN. `mirrored` as above.
void TriangulateFrame(const CaptureObservations& capture, int frame, const AdjustmentScales& scales, bool mirrored,
                      RigEstimate& estimate);

/// Sets each subject's bone lengths to the medians over `frames`. Bones never seen keep NaN.
void MeasureBones(const CaptureObservations& capture, std::span<const int> frames, RigEstimate& estimate);

}  // namespace canonpose
