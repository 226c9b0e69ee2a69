// Measures whether a lifter's canonical pose is canonical: the same from every view, and oriented the same way in every
// frame, so that the hips of a moving body stay in place. Wandt et al. (CanonPose, CVPR 2021) report standard
// deviations of 7.9 and 7.7 mm for their hips; we do not know whether in 3D or for single coordinates.
//
// A deviation here is the root mean square distance in 3D from the mean position (divide by sqrt(3) for that of a
// single coordinate):
//
//   std     of a joint's position over all poses (frames and views)
//   views   over the views of one frame, from their mean; averaged over the frames that at least two views saw
//   frames  over frames, of the mean over a frame's views
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/evaluate/metrics.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

struct CanonicalDeviations {
  double std_mm = 0.0;
  double views_mm = 0.0;  ///< NaN if no frame was seen in two views
  double frames_mm = 0.0;
};

struct CanonicalReport {
  std::int64_t poses = 0;
  std::int64_t left_out = 0;  ///< poses that point away from their truth and thus have no scale
  std::optional<double> right_hip_std_mm;
  std::optional<double> left_hip_std_mm;  ///< both are empty if the skeleton has no hips
  CanonicalDeviations all;                ///< mean over joints
  std::vector<std::pair<std::string, CanonicalDeviations>> per_joint;
};

/// Collects canonical poses frame by frame.
class CanonicalSpread {
 public:
  explicit CanonicalSpread(Skeleton skeleton);

  /// Adds one view's pose (J, 3) in the lifter's unit if the outcome of its `errors` is kEvaluated. It is scaled to
  /// millimetres by the scale of N-MPJPE.
  void AddView(const float* canonical, const PoseErrors& errors);
  /// Ends the frame to which views were added.
  void EndFrame();

  /// Nothing if no pose could be used: every one points away from its truth.
  [[nodiscard]] std::optional<CanonicalReport> Finish() const;

 private:
  /// Sums for the deviation of positions from their mean.
  struct Moments {
    double sum[3] = {0.0, 0.0, 0.0};
    double squares = 0.0;
    std::int64_t count = 0;
    void Add(const double* position);
    [[nodiscard]] double Deviation() const;
  };

  Skeleton skeleton_;
  std::int64_t poses_ = 0;
  std::int64_t left_out_ = 0;
  std::vector<Moments> of_poses_;   // (J)
  std::vector<Moments> of_frame_;   // (J) of the current frame
  std::vector<Moments> of_frames_;  // (J) means of frames
  std::vector<double> views_mm_;    // (J) sums over frames
  std::int64_t frames_in_views_ = 0;
};

}  // namespace canonpose
