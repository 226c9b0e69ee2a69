// The points of the body that detectors and skeletons name.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/articulated_motion.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// h36m-17's joints in its order, then REye, LEye, REar, LEar, UpperNeck, LBigToe, LSmallToe, LHeel, RBigToe,
/// RSmallToe, RHeel: 28 landmarks from which every built-in layout is made. Head is the top of the head; Nose its tip;
/// UpperNeck lies between Thorax (at shoulder height) and the chin.
const Skeleton& LandmarkSkeleton();

/// The landmarks' indices, so that geometry code need not look up names.
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

/// Length of the body from heel to crown along its bones, mm, of one pose (kLandmarkCount); a pose that crouches is as
/// tall as one that stands.
double StatureMm(const Eigen::Vector3d* landmarks);

}  // namespace canonpose
