// How far off detected joints are, learnt from the recording: by joint, and by the detector's confidence.
#pragma once

#include <vector>

namespace canonpose {

/// An error of a keypoint that was found, in body units, with what may have told how large it would be.
struct KeypointError {
  int joint = 0;
  double confidence = 0.0;
  double length = 0.0;
};

/// The scatter (standard deviation along an axis, were errors normal) of keypoints: factor of the joint times a
/// piecewise linear function of the confidence.
class NoiseModel {
 public:
  NoiseModel() = default;
  /// Before anything was measured: `scatter` / confidence.
  explicit NoiseModel(double scatter) : scatter_(scatter) {}
  /// From medians of errors, which outliers do not move: for each of up to ten equal shares of the errors in the order
  /// of confidence, made to fall with confidence, and for each joint.
  NoiseModel(std::vector<KeypointError> errors, int joint_count);

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
