// A point in 3D from its pixels in several calibrated views.
#pragma once

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
  bool in_front_of_all_cameras = false;  ///< a point behind a camera that sees it is no point at all

  [[nodiscard]] bool valid() const { return point_in_world_mm.allFinite(); }
};

/// Linear triangulation (DLT; Hartley and Zisserman, section 12.2) in normalised image coordinates, the distortion
/// undone: the homogeneous X of norm 1, in millimetres, that makes the sum of squares of these least over all views,
///
///   c^2 * (x * p3 - p1) * X        c = confidence, p = rows of [R | t]
///   c^2 * (y * p3 - p2) * X
///
/// Views with confidence 0 or a NaN pixel take no part. Weights c^2 and the homogeneous form are those of the reference
/// that the project's real recording came with, so that figures against it can be compared.
TriangulatedPoint Triangulate(std::span<const PointObservation> observations);

}  // namespace canonpose
