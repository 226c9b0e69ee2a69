// Whether a lifter that was trained without labels has settled in a solution that is none: poses too deep, seen under
// rotations too small, or poses of which some are right and others mirrored.
//
// Two weak-perspective views of a body do not tell twice the depth from half the angle between the cameras (the
// bas-relief ambiguity); only many poses and views together do, and view mixing alone may stay with the wrong answer.
// No truth is needed to notice: people seen from all around are as deep as they are wide, and cameras stand still or
// turn slowly, whatever people do.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <torch/torch.h>

#include "canonpose/model/lifter.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// What can be seen without truth. How it was judged, and what the figures are of good runs and of trapped ones:
/// docs/results.md. The loss of view mixing is no sign: it was 3.9 to 6.2 times that of reprojection in runs of both
/// kinds.
struct TrapSigns {
  /// RMS depth of the poses over their RMS width, both relative to the root; width is the lesser principal axis in the
  /// image, depth the lesser one in the plane of the other and the optical axis, so that cameras that look down on
  /// upright people do not count as depth. Near 1 where people are seen from all around; NaN without poses.
  double depth_ratio = 0.0;
  double angle_deg = 0.0;  ///< median angle between the rotations of two views of a frame, over all pairs
  /// Median angle between the relative rotation of two cameras in a frame and its mean over the clip or, where cameras
  /// stand still, over the capture. NaN where no two frames can be compared.
  double scatter_deg = 0.0;

  /// "poses 1.93 times as deep as wide, views 34 degrees apart, scattered by 34"
  [[nodiscard]] std::string Describe() const;
};

enum class TrapVerdict {
  kRight,       ///< the solution or its depth mirror (train/mirror.h)
  kSuspicious,  ///< between the two, or too little to judge by
  kTrapped,     ///< neither
};

/// Trapped where poses are more than 1.5 times as deep as wide, or where relative rotations scatter by more than 0.6 of
/// their own size. Suspicious from 1.25 and 0.4, where depth is less than half of width, and where views are less than
/// 10 degrees apart.
TrapVerdict JudgeTrap(const TrapSigns& signs);

class TrapStatistics {
 public:
  /// A pose in the frame in which the lifter tells its depth, that of its camera or of the camera turned onto the root,
  /// centred on the root; (3, J).
  void AddPose(int clip, int camera, const Eigen::Matrix3Xd& pose_in_camera);
  /// The rotation from camera a to camera b, neither of them turned, as the lifter sees it in one frame. `group`: what
  /// shares its cameras' rotations, a capture or a clip.
  void AddRotation(int group, int camera_a, int camera_b, const Eigen::Matrix3d& b_from_a);
  [[nodiscard]] TrapSigns Finish() const;

 private:
  std::map<std::pair<int, int>, Eigen::Matrix3d> moments_;  // sums of x x^T, by clip and camera
  std::map<std::tuple<int, int, int>, std::vector<Eigen::Matrix3d>> rotations_;
};

/// The signs of a lifter on every n-th clip of a training set.
TrapSigns MeasureTrapSigns(LiftingNetwork& lifter, const TrainingSet& set, int root, torch::Device device);

/// Tells the user, with what to do about it for a lifter of that input, and gives what the model file records.
TrapFinding ReportTrap(const TrapSigns& signs, const InputForm& input = {});

}  // namespace canonpose
