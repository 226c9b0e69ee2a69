// A static view, frame by frame, against the joints that the other views show at the same or at other times.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"

namespace canonpose {

/// Of one clip. Refers to the capture and the solution, which must outlive it. Joints are triangulated when they are
/// first needed.
class ViewComparison {
 public:
  ViewComparison(const CaptureObservations& capture, const Solution& solution, int clip, int view);

  /// The mean robust cost of the view's keypoints of `frame`, were `camera` to see what the others see `offset` frames
  /// later; NaN where nothing can be compared. Where the others hardly show where a joint is, its keypoint costs
  /// little.
  [[nodiscard]] double Cost(int frame, int offset, const CameraEstimate& camera);
  /// The view's camera, of the same focal length, as it fits some of these frames best at an offset. One that was
  /// estimated with the wrong offset partly compensates for it and would favour that offset.
  [[nodiscard]] CameraEstimate Refit(std::span<const int> frames, int offset);

 private:
  struct Joint {
    Eigen::Vector3d point;
    Eigen::Matrix3d covariance;
  };
  /// (J), triangulated without this view; empty outside of the clip.
  std::vector<Joint>& OthersAt(int frame);

  const CaptureObservations& capture_;
  const Solution& solution_;
  const ClipRange& clip_;
  int view_;
  std::vector<std::vector<Joint>> others_;  ///< by frame of the clip; empty until needed
  std::vector<Joint> none_;
};

}  // namespace canonpose
