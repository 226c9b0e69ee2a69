// Static cameras that are known, and joints from the rays of some of their keypoints: small and quick, for finding out
// which keypoints belong together. What solves poses is in initialisation.h and adjustment.h.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/rig_estimate.h"

namespace canonpose {

/// What a view shows of one person in a frame of a capture.
struct ViewSighting {
  int view = 0;
  int frame = 0;  ///< of the capture
};

/// Joints in the world (J); NaN where unknown.
using JointPositions = std::vector<Eigen::Vector3d>;

/// The mean of the known joints, where somebody is; NaN where none is known.
Eigen::Vector3d Middle(const JointPositions& joints);

class CameraRays {
 public:
  /// `capture` must outlive this; `cameras` (V) are static.
  CameraRays(const CaptureObservations& capture, std::span<const CameraEstimate> cameras);

  [[nodiscard]] bool IsKnown(int view) const { return views_[static_cast<std::size_t>(view)].has_value(); }
  /// The joints that lie nearest to the rays of the sightings. Joints that fewer than two show become NaN; with `prior`
  /// they are drawn a little to it, which matters where rays are nearly parallel.
  [[nodiscard]] JointPositions Triangulate(std::span<const ViewSighting> sightings,
                                           const JointPositions* prior = nullptr) const;
  /// The mean distance of a sighting's keypoints from joints, weighted by confidence; each in units of `unit` (body
  /// units at the joint's depth) and 1 at most. 1 where fewer than three joints are known in both.
  [[nodiscard]] double Distance(const ViewSighting& sighting, const JointPositions& joints, double unit) const;
  /// How far joints would have to move, parallel to the image, to lie on the keypoints, in the mean.
  [[nodiscard]] Eigen::Vector3d ShiftTo(const ViewSighting& sighting, const JointPositions& joints) const;
  /// The cosine of the angle between two views' rays to a point.
  [[nodiscard]] double RayCosine(int view, int other, const Eigen::Vector3d& point) const;
  [[nodiscard]] const Eigen::Matrix3d& Rotation(int view) const {
    return views_[static_cast<std::size_t>(view)]->rotation;
  }

 private:
  struct View {
    Eigen::Matrix3d rotation;
    Eigen::Vector3d translation;
    Eigen::Vector3d centre;
    double focal;
  };

  const CaptureObservations& capture_;
  std::vector<std::optional<View>> views_;
};

}  // namespace canonpose
