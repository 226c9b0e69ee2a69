#include "canonpose/simulate/occlusion.h"

#include <algorithm>
#include <cmath>

namespace canonpose {
namespace {

/// Skin over a landmark at which no capsule begins or ends: eyes, ears and nose are on the surface.
constexpr double kSkinOfOthers = 0.005;

/// A limb as a capsule between two landmarks.
struct Capsule {
  Landmark from;
  Landmark to;
  double radius;  ///< as a fraction of the stature
};

/// The body's shape: limbs, trunk (capsules side by side from the hips to the shoulders) and head.
///
/// Radii from circumferences of the limbs of an average adult (thigh 56 cm, calf 37 cm, upper arm 30 cm, head 57 cm,
/// chest 98 cm as two capsules side by side) over a stature of 1.73 m, a little thinner at the ends of the limbs.
const std::vector<Capsule>& BodyCapsules() {
  static const std::vector<Capsule> capsules = {
      {kRHip, kRKnee, 0.042},    {kRKnee, kRFoot, 0.028},      {kRHeel, kRBigToe, 0.020},  {kLHip, kLKnee, 0.042},
      {kLKnee, kLFoot, 0.028},   {kLHeel, kLBigToe, 0.020},    {kRHip, kRShoulder, 0.050}, {kLHip, kLShoulder, 0.050},
      {kHip, kThorax, 0.055},    {kLShoulder, kLElbow, 0.025}, {kLElbow, kLWrist, 0.019},  {kRShoulder, kRElbow, 0.025},
      {kRElbow, kRWrist, 0.019}, {kThorax, kUpperNeck, 0.032}, {kUpperNeck, kHead, 0.045},
  };
  return capsules;
}

double PointDistanceSquared(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - a - s * along).squaredNorm();
}

}  // namespace

double SegmentDistanceSquared(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& q0,
                              const Eigen::Vector3d& q1) {
  // Ericson, Real-Time Collision Detection, 5.1.9: the closest points of the lines, clamped to the segments in turn.
  const Eigen::Vector3d d1 = p1 - p0;
  const Eigen::Vector3d d2 = q1 - q0;
  const Eigen::Vector3d r = p0 - q0;
  const double a = d1.squaredNorm();
  const double e = d2.squaredNorm();
  if (!(e > 0.0)) return PointDistanceSquared(q0, p0, p1);
  if (!(a > 0.0)) return PointDistanceSquared(p0, q0, q1);
  const double f = d2.dot(r);
  const double c = d1.dot(r);
  const double b = d1.dot(d2);
  const double denominator = a * e - b * b;
  double s = denominator > 1e-12 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.0;
  double t = (b * s + f) / e;
  if (t < 0.0) {
    t = 0.0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1.0) {
    t = 1.0;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
  return (r + s * d1 - t * d2).squaredNorm();
}

OcclusionTest::OcclusionTest(const LayoutMapping& from_landmarks) {
  const std::vector<Capsule>& capsules = BodyCapsules();
  for (const JointSource& source : from_landmarks.joints) {
    Joint joint;
    joint.skin = kSkinOfOthers;
    for (const Capsule& capsule : capsules) {
      const bool is_attached = std::any_of(source.sources.begin(), source.sources.end(),
                                           [&](int s) { return s == capsule.from || s == capsule.to; });
      joint.is_attached.push_back(is_attached ? 1 : 0);
      if (is_attached) joint.skin = std::max(joint.skin, capsule.radius);
    }
    joints_.push_back(std::move(joint));
  }
}

void OcclusionTest::Find(const Eigen::Vector3d* landmarks, const Eigen::Vector3d* joints,
                         const Eigen::Vector3d& camera_centre_mm, double stature_mm, std::uint8_t* hidden) const {
  const std::vector<Capsule>& capsules = BodyCapsules();
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    const Eigen::Vector3d to_camera = camera_centre_mm - joints[j];
    const double distance = to_camera.norm();
    const Eigen::Vector3d skin =
        joints[j] + to_camera * std::min(1.0, joint.skin * stature_mm / std::max(distance, 1e-9));
    hidden[j] = 0;
    for (std::size_t c = 0; c < capsules.size() && hidden[j] == 0; ++c) {
      if (joint.is_attached[c] != 0) continue;
      const Eigen::Vector3d& from = landmarks[capsules[c].from];
      const Eigen::Vector3d& to = landmarks[capsules[c].to];
      const double radius = capsules[c].radius * stature_mm;
      const double radius2 = radius * radius;
      if (SegmentDistanceSquared(skin, camera_centre_mm, from, to) >= radius2) continue;
      // Flesh that surrounds the joint or touches the skin over it does not hide it, since its surface is what one sees
      // there.
      if (PointDistanceSquared(skin, from, to) < radius2 || PointDistanceSquared(joints[j], from, to) < radius2)
        continue;
      hidden[j] = 1;
    }
  }
}

}  // namespace canonpose
