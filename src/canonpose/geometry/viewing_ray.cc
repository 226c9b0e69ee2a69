#include "canonpose/geometry/viewing_ray.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace canonpose {

Pinhole Pinhole::Guess(const std::array<int, 2>& image_size) {
  const Eigen::Vector2d size(image_size[0], image_size[1]);
  if (size.minCoeff() <= 0.0) return {};
  return {Eigen::Vector2d::Constant(size.norm()), size / 2.0};
}

Pinhole Pinhole::FromK(const Eigen::Matrix3d& K) { return {K.diagonal().head<2>(), K.col(2).head<2>()}; }

Eigen::Matrix3d RotationOntoAxis(const Eigen::Vector3d& ray) {
  const Eigen::Vector3d unit = ray.normalized();
  // With v = unit x axis: R = I + [v] + [v]^2 / (1 + cos).
  Eigen::Matrix3d cross;
  cross << 0.0, 0.0, -unit.x(), 0.0, 0.0, -unit.y(), unit.x(), unit.y(), 0.0;
  return Eigen::Matrix3d::Identity() + cross + cross * cross / (1.0 + unit.z());
}

bool NormalisePoseOnAxis(const float* keypoints, const float* confidence, int joint_count, int root,
                         const Pinhole& pinhole, NormalisedPose& pose, Eigen::Matrix3d& turned_from_camera) {
  turned_from_camera.setIdentity();
  const auto ray_of = [&](int joint) {
    const Eigen::Vector2d pixel(keypoints[2 * joint], keypoints[2 * joint + 1]);
    return Eigen::Vector3d((pixel - pinhole.principal_point_px).cwiseQuotient(pinhole.focal_px).homogeneous());
  };
  const bool has_root = confidence[root] > 0.0F && std::isfinite(keypoints[2 * root] + keypoints[2 * root + 1]);
  if (!pinhole.is_known() || !has_root) {
    return NormalisePose(keypoints, confidence, joint_count, root, pose);
  }
  turned_from_camera = RotationOntoAxis(ray_of(root));
  thread_local std::vector<float> turned_px;
  turned_px.assign(2 * static_cast<std::size_t>(joint_count), std::numeric_limits<float>::quiet_NaN());
  for (int j = 0; j < joint_count; ++j) {
    const Eigen::Vector3d ray = turned_from_camera * ray_of(j);
    if (!(ray.z() > 0.0)) continue;
    turned_px[2 * static_cast<std::size_t>(j)] = static_cast<float>(pinhole.focal_px.x() * ray.x() / ray.z());
    turned_px[2 * static_cast<std::size_t>(j) + 1] = static_cast<float>(pinhole.focal_px.y() * ray.y() / ray.z());
  }
  return NormalisePose(turned_px.data(), confidence, joint_count, root, pose);
}

}  // namespace canonpose
