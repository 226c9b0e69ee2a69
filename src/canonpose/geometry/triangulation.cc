#include "canonpose/geometry/triangulation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace canonpose {
namespace {

using Equations = Eigen::Matrix<double, Eigen::Dynamic, 4>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double LargestAngle(const std::vector<Eigen::Vector3d>& directions) {
  double largest = 0.0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = i + 1; j < directions.size(); ++j) {
      // atan2 keeps its precision where acos(dot) has lost it.
      const double angle = std::atan2(directions[i].cross(directions[j]).norm(), directions[i].dot(directions[j]));
      largest = std::max(largest, angle);
    }
  }
  return largest;
}

}  // namespace

TriangulatedPoint Triangulate(std::span<const PointObservation> observations) {
  TriangulatedPoint result;
  result.point_in_world_mm.setConstant(kNaN);
  result.reprojection_error_px = kNaN;

  std::vector<const PointObservation*> seen;
  std::vector<Eigen::Vector3d> directions;
  Equations equations(2 * static_cast<Eigen::Index>(observations.size()), 4);
  Eigen::Index row = 0;
  for (const PointObservation& observation : observations) {
    if (!(observation.confidence > 0.0) || !observation.pixel.allFinite()) continue;
    const Eigen::Vector2d ray = observation.camera->Undistort(observation.pixel);
    if (!ray.allFinite()) continue;
    const Eigen::Matrix3d& R = observation.camera->camera_from_world_rotation;
    Eigen::Matrix<double, 3, 4> projection;
    projection << R, observation.camera->camera_from_world_translation;
    const double weight = observation.confidence * observation.confidence;
    equations.row(row++) = weight * (ray.x() * projection.row(2) - projection.row(0));
    equations.row(row++) = weight * (ray.y() * projection.row(2) - projection.row(1));
    seen.push_back(&observation);
    directions.emplace_back((R.transpose() * ray.homogeneous()).normalized());
  }
  result.view_count = static_cast<int>(seen.size());
  result.largest_ray_angle_rad = LargestAngle(directions);
  constexpr double kParallelRad = 1e-6;
  if (result.view_count < 2 || result.largest_ray_angle_rad < kParallelRad) return result;

  const Eigen::JacobiSVD<Equations> svd(equations.topRows(row), Eigen::ComputeFullV);
  const Eigen::Vector3d point = svd.matrixV().col(3).hnormalized();
  if (!point.allFinite()) return result;
  result.point_in_world_mm = point;

  result.in_front_of_all_cameras = true;
  double sum_px = 0.0;
  for (const PointObservation* observation : seen) {
    const Eigen::Vector2d projected = observation->camera->Project(result.point_in_world_mm);
    if (!projected.allFinite()) result.in_front_of_all_cameras = false;
    sum_px += (projected - observation->pixel).norm();
  }
  result.reprojection_error_px = sum_px / result.view_count;
  return result;
}

RobustPoint TriangulateRobustly(std::span<const PointRay> rays) {
  constexpr int kRounds = 5;
  constexpr double kWideLossScale = 3.0;
  RobustPoint result;
  std::vector<double> weights(rays.size(), 1.0);
  for (int round = 0; rays.size() >= 2 && round < kRounds; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const PointRay& ray = rays[i];
      const Eigen::Matrix3d& R = ray.camera_from_world_rotation;
      const Eigen::Vector3d& t = ray.camera_from_world_translation;
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector3d row = (R.row(axis) - ray.direction[axis] * R.row(2)).transpose();
        const double weight = weights[i] / (ray.scatter * ray.scatter);
        normal += weight * row * row.transpose();
        right += weight * row * (ray.direction[axis] * t.z() - t[axis]);
      }
    }
    result.point = normal.ldlt().solve(right);
    result.information = normal;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const PointRay& ray = rays[i];
      const Eigen::Vector3d p = ray.camera_from_world_rotation * result.point + ray.camera_from_world_translation;
      // At the point's depth, in the world's unit; the rows above are of that size.
      const double error = (p.head<2>() - ray.direction * p.z()).norm() / ray.scatter;
      weights[i] = 1.0 / (1.0 + std::pow(error / kWideLossScale, 2));
    }
  }
  return result;
}

}  // namespace canonpose
