// Whether a lifter that was trained without labels has settled in a degenerate solution, "the trap": poses that are too
// deep, with rotations that are too small, or poses of which some are right and others mirrored.
//
// Two weak-perspective views of a body do not distinguish twice the depth from half the angle between the cameras (the
// bas-relief ambiguity). Only many poses and views together determine it, and view consistency alone may settle on
// the wrong answer. That shows without truth: people seen from all around are as deep as they are wide, and cameras are
// static or rotate slowly, whatever people do.
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

/// The signs of the trap that can be measured without truth. docs/results.md has their values in good and in trapped
/// runs. The loss of view consistency is not a sign: it was 3.9 to 6.2 times that of reprojection in runs of both
/// kinds.
struct TrapSigns {
  /// RMS depth of the poses over their RMS width, both relative to the root. Width is the smaller principal axis in the
  /// image; depth is the smaller one in the plane of the larger and the optical axis, so that the height of people does
  /// not count as depth where cameras look down on them. Near 1 for people seen from all around; NaN without poses.
  double depth_ratio = 0.0;
  double angle_deg = 0.0;  ///< median angle between the rotations of two views of a frame, over all pairs
  /// Median angle between the relative rotation of two cameras in a frame and its mean over the clip or, with static
  /// cameras, over the capture. NaN where no two frames can be compared.
  double scatter_deg = 0.0;

  /// "poses are 1.93 times as deep as wide; two views are 34 degrees apart, give or take 34"
  [[nodiscard]] std::string Describe() const;
};

enum class TrapVerdict {
  kRight,       ///< the solution or its mirror image (train/mirror.h)
  kSuspicious,  ///< between the two, or too little data to judge
  kTrapped,
};

/// Trapped if poses are more than 1.5 times as deep as wide, or if relative rotations scatter by more than 0.6 of their
/// own angle. Suspicious above 1.25 and 0.4, and if poses are less than half as deep as wide or views less than 10
/// degrees apart.
TrapVerdict JudgeTrap(const TrapSigns& signs);

class TrapStatistics {
 public:
  /// A pose (3, J), centred on the root, in the frame in which the lifter estimates its depth: that of its camera, or
  /// of the camera rotated onto the root.
  void AddPose(int clip, int camera, const Eigen::Matrix3Xd& pose_in_camera);
  /// The lifter's rotation from camera a to camera b in one frame, without any rotation onto the root. `group`: the
  /// capture or clip over which it should be the same.
  void AddRotation(int group, int camera_a, int camera_b, const Eigen::Matrix3d& b_from_a);
  [[nodiscard]] TrapSigns Finish() const;

 private:
  std::map<std::pair<int, int>, Eigen::Matrix3d> moments_;  // sums of x x^T, by clip and camera
  std::map<std::tuple<int, int, int>, std::vector<Eigen::Matrix3d>> rotations_;
};

/// The signs of a lifter, on every n-th clip of a training set.
TrapSigns MeasureTrapSigns(LiftingNetwork& lifter, const TrainingSet& set, int root, torch::Device device);

/// Reports the verdict with what to do about it, which depends on the lifter's input. Returns what the model file
/// records.
TrapFinding ReportTrap(const TrapSigns& signs, const InputForm& input = {});

}  // namespace canonpose
