// The error of detected joints, learnt from the recording: by joint and by the detector's confidence.
#pragma once

#include <vector>

namespace canonpose {

/// The error of a keypoint, and what may predict its size.
struct KeypointError {
  int joint = 0;
  double confidence = 0.0;
  double length = 0.0;  ///< body units
};

/// The scatter of keypoints (standard deviation along an axis, as if errors were normal): a factor for the joint times
/// a piecewise linear function of the confidence.
class NoiseModel {
 public:
  NoiseModel() = default;
  /// Before anything has been measured: `scatter` / confidence.
  explicit NoiseModel(double scatter) : scatter_(scatter) {}
  /// From medians of errors, which are robust against outliers. The errors are sorted by confidence and divided into up
  /// to ten equal groups; a group's scatter is at most that of the group before, and at least `min_factor` times the
  /// typical one. Then each joint's factor is measured.
  NoiseModel(std::vector<KeypointError> errors, int joint_count, double min_factor = 0.1);

  [[nodiscard]] double Scatter(int joint, double confidence) const;
  /// The scatter of a typical keypoint.
  [[nodiscard]] double Typical() const { return scatter_; }

 private:
  double scatter_ = 0.006;
  std::vector<double> joint_factors_;  ///< empty: scatter / confidence
  std::vector<double> confidences_;    ///< ascending
  std::vector<double> factors_;        ///< at these confidences
};

}  // namespace canonpose
