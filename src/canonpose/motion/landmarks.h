// The points of the body that detectors and skeletons have names for.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// The joints of h36m-17 in its order, then REye, LEye, REar, LEar, UpperNeck, LBigToe, LSmallToe, LHeel, RBigToe,
/// RSmallToe, RHeel: 28 landmarks from which every built-in layout can be made. Head is the top of the head, Nose its
/// tip; UpperNeck lies between Thorax (at shoulder height) and the chin.
const Skeleton& LandmarkSkeleton();

/// The landmarks' indices, so that code about bodies need not look up names.
enum Landmark : int {
  kHip,
  kRHip,
  kRKnee,
  kRFoot,
  kLHip,
  kLKnee,
  kLFoot,
  kSpine,
  kThorax,
  kNose,
  kHead,
  kLShoulder,
  kLElbow,
  kLWrist,
  kRShoulder,
  kRElbow,
  kRWrist,
  kREye,
  kLEye,
  kREar,
  kLEar,
  kUpperNeck,
  kLBigToe,
  kLSmallToe,
  kLHeel,
  kRBigToe,
  kRSmallToe,
  kRHeel,
  kLandmarkCount
};

/// Landmarks of a clip over time.
struct LandmarkTrack {
  std::string name;
  std::string subject;
  double fps = 0.0;
  std::vector<Eigen::Vector3d> positions_mm;  ///< (T, kLandmarkCount), world

  [[nodiscard]] int frame_count() const { return static_cast<int>(positions_mm.size()) / kLandmarkCount; }
  [[nodiscard]] const Eigen::Vector3d& At(int frame, int landmark) const {
    return positions_mm[static_cast<std::size_t>(frame) * kLandmarkCount + static_cast<std::size_t>(landmark)];
  }
};

/// The length of the body from heel to crown along its bones, mm, in one pose (kLandmarkCount). It does not depend on
/// the pose: a crouching person is as tall as a standing one.
double StatureMm(const Eigen::Vector3d* landmarks);

}  // namespace canonpose
