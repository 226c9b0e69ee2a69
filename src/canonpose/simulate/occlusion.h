// Which joints the body itself hides from a camera.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/landmarks.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {

/// A joint is hidden where the line of sight to the skin in front of it passes through a limb, the trunk or the head
/// that it is not a part of. Each of these is a capsule.
class OcclusionTest {
 public:
  explicit OcclusionTest(const LayoutMapping& from_landmarks);

  /// landmarks is (kLandmarkCount) and joints is (K), both in mm in the world, like the camera's centre. hidden, (K),
  /// is set to 1 where the joint is hidden and to 0 elsewhere.
  void Find(const Eigen::Vector3d* landmarks, const Eigen::Vector3d* joints, const Eigen::Vector3d& camera_centre_mm,
            double stature_mm, std::uint8_t* hidden) const;

 private:
  struct Joint {
    double skin = 0.0;                      ///< depth below the skin, as a fraction of the stature
    std::vector<std::uint8_t> is_attached;  ///< per capsule
  };
  std::vector<Joint> joints_;
};

/// Squared distance between the segments p0-p1 and q0-q1.
double SegmentDistanceSquared(const Eigen::Vector3d& p0, const Eigen::Vector3d& p1, const Eigen::Vector3d& q0,
                              const Eigen::Vector3d& q1);

}  // namespace canonpose
