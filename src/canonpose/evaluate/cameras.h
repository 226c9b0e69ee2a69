// How far solved cameras are from calibrated ones.
#pragma once

#include <optional>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Medians over frames (of moving cameras) and pairs of cameras, or cameras.
struct CameraErrors {
  double relative_rotation_deg = 0.0;  ///< angle between the solved and the true rotation from one camera to another
  double focal_percent = 0.0;          ///< of the focal length
};

/// Gathers what datasets have of cameras that are both solved and calibrated.
class CameraComparison {
 public:
  void Add(const Dataset& dataset);
  /// Nothing where no camera was both.
  [[nodiscard]] std::optional<CameraErrors> Medians() const;

 private:
  void AddFrame(const Sequence& sequence, int frame);

  std::vector<double> rotations_deg_;
  std::vector<double> focals_percent_;
};

}  // namespace canonpose
