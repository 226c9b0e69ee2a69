// Compares solved cameras with calibrated ones.
#pragma once

#include <optional>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Medians over frames (of moving cameras) and pairs of cameras, or cameras.
struct CameraErrors {
  double relative_rotation_deg = 0.0;  ///< angle between the solved and the true rotation from one camera to another
  /// The same, after rotating the true cameras to look along the ray that the solved cameras use as their optical axis.
  /// A lens whose centre is a little off looks just like a camera that is rotated a little.
  double centred_rotation_deg = 0.0;
  double focal_percent = 0.0;  ///< of the focal length
};

/// Collects the errors of all cameras of datasets that are both solved and calibrated.
class CameraComparison {
 public:
  void Add(const Dataset& dataset);
  /// Nothing if no camera was both.
  [[nodiscard]] std::optional<CameraErrors> Medians() const;

 private:
  void AddFrame(const Sequence& sequence, int frame);

  std::vector<double> rotations_deg_;
  std::vector<double> centred_deg_;
  std::vector<double> focals_percent_;
};

}  // namespace canonpose
