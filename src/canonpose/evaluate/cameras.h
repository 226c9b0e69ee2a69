// How far solved cameras are from calibrated ones.
#pragma once

#include <optional>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Medians over frames (of moving cameras) and pairs of cameras, or cameras.
struct CameraErrors {
  double relative_rotation_deg = 0.0;  ///< angle between the solved and the true rotation from one camera to another
  /// The same, the true cameras turned to look along the ray that the solved ones take for their optical axis: a lens
  /// that sits a little beside the image's middle looks just like a camera that is turned a little.
  double centred_rotation_deg = 0.0;
  double focal_percent = 0.0;  ///< of the focal length
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
  std::vector<double> centred_deg_;
  std::vector<double> focals_percent_;
};

}  // namespace canonpose
