// A point in 3D from what several views see of it.
//
// Two ways, for two purposes. Triangulate() takes pixels of calibrated cameras and is what reference poses are made
// with: one linear solution, defined so that figures can be compared with published ones. TriangulateRobustly() takes
// rays of any cameras, gives little weight to a view that contradicts the others, and says how certain its point is: it
// is what the solver uses.
#pragma once

#include <limits>
#include <span>

#include <Eigen/Core>

#include "canonpose/geometry/camera.h"

namespace canonpose {

/// What one view saw of the point.
struct PointObservation {
  const Camera* camera = nullptr;  ///< must outlive the call
  Eigen::Vector2d pixel;           ///< NaN where not seen
  double confidence = 0.0;         ///< 0 where not seen
};

struct TriangulatedPoint {
  Eigen::Vector3d point_in_world_mm;     ///< NaN where fewer than two views see the point or the rays are parallel
  int view_count = 0;                    ///< views that see it
  double reprojection_error_px = 0.0;    ///< mean distance over these views; NaN where there is no point
  double largest_ray_angle_rad = 0.0;    ///< between any two of the rays; near 0 the depth is a guess
  bool in_front_of_all_cameras = false;  ///< otherwise the point lies behind a camera that sees it, and is wrong

  [[nodiscard]] bool valid() const { return point_in_world_mm.allFinite(); }
};

/// Linear triangulation (DLT; Hartley and Zisserman, section 12.2) in undistorted, normalised image coordinates: the
/// homogeneous X of norm 1, in millimetres, that minimises the sum of squares of these over all views:
///
///   c^2 * (x * p3 - p1) * X        c = confidence, p = rows of [R | t]
///   c^2 * (y * p3 - p2) * X
///
/// Views with confidence 0 or a NaN pixel are ignored. The weights c^2 and the homogeneous form are those of the
/// reference poses that the project's real recording came with, so that figures can be compared with that reference.
TriangulatedPoint Triangulate(std::span<const PointObservation> observations);

/// What one view saw of the point, without pixels: x_in_camera = rotation * x_in_world + translation, in any one unit.
struct PointRay {
  Eigen::Matrix3d camera_from_world_rotation;
  Eigen::Vector3d camera_from_world_translation;
  Eigen::Vector2d direction;  ///< (x, y) / z of the point in the camera's frame, as observed
  double scatter = 1.0;       ///< standard deviation of the observation at the point's depth, in the world's unit
};

struct RobustPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());  ///< NaN: < 2 rays
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< inverse covariance, 1 / unit^2
};

/// Linear least squares over all rays of
///
///   ((x, y)_in_camera - direction * z_in_camera) / scatter,
///
/// iteratively reweighted with Cauchy weights 1 / (1 + (error / (3 scatter))^2), so that a bad view counts little.
RobustPoint TriangulateRobustly(std::span<const PointRay> rays);

}  // namespace canonpose
