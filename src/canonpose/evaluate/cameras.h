// Compares solved cameras with calibrated ones.
#pragma once

#include <optional>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// The first three are medians over frames (of moving cameras) and pairs of cameras, or cameras. The others are means,
/// as Mueller et al. (HSfM, CVPR 2025) and Javerliat et al. (Kineo, 2025) define them.
struct CameraErrors {
  double relative_rotation_deg = 0.0;  ///< angle between the solved and the true rotation from one camera to another
  /// The same, after rotating the true cameras to look along the ray that the solved cameras use as their optical axis.
  /// A lens whose centre is a little off looks just like a camera that is rotated a little.
  double centred_rotation_deg = 0.0;
  double focal_percent = 0.0;  ///< of the focal length
  /// AE: as relative_rotation_deg, the mean over pairs.
  double angle_deg = 0.0;
  /// The mean difference of the vertical fields of view, through lenses as they distort.
  double vertical_fov_deg = 0.0;
  /// TE: the distance of the camera centres, after the rotation and translation that take the solved ones best to the
  /// true ones (of each frame, where cameras move). Nothing where the solved unit is not millimetres.
  std::optional<double> translation_mm;
  /// s-TE: the same after a similarity. Nothing with fewer than three cameras, which it fits whatever they are.
  std::optional<double> scaled_translation_mm;
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
  std::vector<double> fovs_deg_;
  std::vector<double> translations_mm_;         ///< means over the cameras of a frame
  std::vector<double> scaled_translations_mm_;  ///< the same
};

}  // namespace canonpose
