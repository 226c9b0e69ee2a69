// What is wrong with a view that does not fit the others: found by fitting its camera to the joints that the others
// see.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "canonpose/solve/observations.h"
#include "canonpose/solve/solution.h"
#include "canonpose/solve/view_correction.h"

namespace canonpose {

/// Joints over a clip as some views see them, against which another is compared.
class KnownMotion {
 public:
  /// Triangulates the clip's joints from the views of `capture` whose cameras `solution` knows. Joints that fewer than
  /// two views see are unknown.
  KnownMotion(const CaptureObservations& capture, const Solution& solution, int clip);

  [[nodiscard]] int frame_count() const { return frame_count_; }
  /// A joint at a time in frames of the clip, between frames by linear interpolation; NaN where unknown.
  [[nodiscard]] Eigen::Vector3d At(double time, int joint) const;

 private:
  int frame_count_ = 0;
  int joint_count_ = 0;
  std::vector<Eigen::Vector3d> joints_;  ///< (T, J)
};

struct ViewExamination {
  bool fits = false;    ///< under `reading`, in all frames outside of `bad`
  ViewReading reading;  ///< identity where nothing else fits clearly better
  std::vector<BadStretch> bad;
  double error = 0.0;  ///< median distance from the known motion where it fits, body units
};

/// The share of a view's frames in a clip that fit the motion without any correction.
double ShareThatFits(const CaptureObservations& capture, int clip, int view, const KnownMotion& motion,
                     double expected_log_focal, double scatter);

/// Examines a view in a clip against the motion that other views show. `expected_log_focal` is about its focal length,
/// `scatter` the usual error of keypoints in body units.
ViewExamination ExamineView(const CaptureObservations& capture, int clip, int view, const KnownMotion& motion,
                            double expected_log_focal, double scatter);

}  // namespace canonpose
