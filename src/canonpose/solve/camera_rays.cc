#include "canonpose/solve/camera_rays.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "canonpose/solve/fit.h"

namespace canonpose {
namespace {

/// Of a joint's prior, relative to a keypoint of full confidence.
constexpr double kPriorWeight = 0.02;
/// Distances from which on keypoints count less, in body units.
constexpr double kRobustUnit = 0.03;
constexpr int kMinCommonJoints = 3;

}  // namespace

Eigen::Vector3d Middle(const JointPositions& joints) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (const Eigen::Vector3d& joint : joints) {
    if (!joint.allFinite()) continue;
    sum += joint;
    ++count;
  }
  return count > 0 ? Eigen::Vector3d(sum / count) : Eigen::Vector3d::Constant(std::nan(""));
}

CameraRays::CameraRays(const CaptureObservations& capture, std::span<const CameraEstimate> cameras)
    : capture_(capture), views_(cameras.size()) {
  for (std::size_t v = 0; v < cameras.size(); ++v) {
    if (!cameras[v].valid) continue;
    const Eigen::Matrix3d rotation = cameras[v].Rotation();
    const Eigen::Vector3d translation = Eigen::Vector3d::Map(cameras[v].placement.data());
    views_[v] = View{rotation, translation, -rotation.transpose() * translation, cameras[v].Focal()};
  }
}

JointPositions CameraRays::Triangulate(std::span<const ViewSighting> sightings, const JointPositions* prior) const {
  const int joints = capture_.joint_count();
  JointPositions points(static_cast<std::size_t>(joints), Eigen::Vector3d::Constant(std::nan("")));
  for (int j = 0; j < joints; ++j) {
    Eigen::Vector3d& point = points[static_cast<std::size_t>(j)];
    const bool has_prior = prior != nullptr && (*prior)[static_cast<std::size_t>(j)].allFinite();
    // Once as they are, once with little weight for what is far off.
    for (int round = 0; round < 2; ++round) {
      Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
      Eigen::Vector3d right = Eigen::Vector3d::Zero();
      int count = 0;
      for (const ViewSighting& sighting : sightings) {
        const std::optional<View>& view = views_[static_cast<std::size_t>(sighting.view)];
        if (!view || !capture_.Sees(sighting.frame, sighting.view, j)) continue;
        ++count;
        // (x, y)_in_camera - direction z_in_camera, linear in the point.
        const Eigen::Vector2d direction = capture_.At(sighting.frame, sighting.view, j) / view->focal;
        const Eigen::Matrix<double, 2, 3> rows = view->rotation.topRows<2>() - direction * view->rotation.row(2);
        const Eigen::Vector2d offset = view->translation.head<2>() - direction * view->translation.z();
        double weight = std::pow(capture_.confidence[capture_.Index(sighting.frame, sighting.view, j)], 2);
        if (round > 0) weight /= 1.0 + (rows * point + offset).squaredNorm() / (kRobustUnit * kRobustUnit);
        normal += weight * rows.transpose() * rows;
        right -= weight * rows.transpose() * offset;
      }
      if (count < 2) break;
      if (has_prior) {
        normal += kPriorWeight * Eigen::Matrix3d::Identity();
        right += kPriorWeight * (*prior)[static_cast<std::size_t>(j)];
      }
      point = normal.inverse() * right;
    }
  }
  return points;
}

double CameraRays::Distance(const ViewSighting& sighting, const JointPositions& joints, double unit) const {
  const std::optional<View>& view = views_[static_cast<std::size_t>(sighting.view)];
  if (!view) return 1.0;
  double sum = 0.0;
  double weights = 0.0;
  int count = 0;
  for (int j = 0; j < capture_.joint_count(); ++j) {
    const Eigen::Vector3d& joint = joints[static_cast<std::size_t>(j)];
    if (!joint.allFinite() || !capture_.Sees(sighting.frame, sighting.view, j)) continue;
    const double weight = capture_.confidence[capture_.Index(sighting.frame, sighting.view, j)];
    const double distance = DistanceInFront(view->rotation * joint + view->translation, view->focal,
                                            capture_.At(sighting.frame, sighting.view, j));
    sum += weight * (std::isfinite(distance) ? std::min(1.0, distance / unit) : 1.0);
    weights += weight;
    ++count;
  }
  return count < kMinCommonJoints ? 1.0 : sum / weights;
}

Eigen::Vector3d CameraRays::ShiftTo(const ViewSighting& sighting, const JointPositions& joints) const {
  const std::optional<View>& view = views_[static_cast<std::size_t>(sighting.view)];
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int j = 0; view && j < capture_.joint_count(); ++j) {
    const Eigen::Vector3d& joint = joints[static_cast<std::size_t>(j)];
    if (!joint.allFinite() || !capture_.Sees(sighting.frame, sighting.view, j)) continue;
    sum -= DisplacementAtDepth(view->rotation * joint + view->translation, view->focal,
                               capture_.At(sighting.frame, sighting.view, j));
    ++count;
  }
  if (count == 0) return Eigen::Vector3d::Zero();
  return view->rotation.topRows<2>().transpose() * (sum / count);
}

double CameraRays::RayCosine(int view, int other, const Eigen::Vector3d& point) const {
  const Eigen::Vector3d a = (point - views_[static_cast<std::size_t>(view)]->centre).normalized();
  const Eigen::Vector3d b = (point - views_[static_cast<std::size_t>(other)]->centre).normalized();
  return a.dot(b);
}

}  // namespace canonpose
