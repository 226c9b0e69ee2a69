// Whether a calibration can be that of the cameras that filmed: the cameras may be interchanged, or the unit be another
// than it seems. Both show in the keypoints.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "canonpose/data/body_size.h"
#include "canonpose/data/dataset.h"

namespace canonpose {

/// How well the calibration of a sequence fits its keypoints.
struct CalibrationFit {
  /// Median distance between the keypoints and their triangulation, over all joints that two calibrated cameras see.
  /// Infinite where most of them triangulate to a point behind a camera; NaN where no joint can be measured.
  double error_px = 0.0;
  /// The longer side of the images, by which error_px is judged; the median over cameras.
  double image_px = 0.0;
  /// Where another assignment of the calibrations to the cameras fits, and this one does not: each camera with the one
  /// whose calibration is its own. Empty otherwise.
  std::vector<std::pair<std::string, std::string>> interchanged;
  double corrected_px = 0.0;  ///< the error with that assignment

  /// A calibrated recording is off by about 0.5 % of the image, by up to 1 % with a poor detector or lens model.
  [[nodiscard]] bool fits() const;
};

/// Measures some frames of a sequence. Where the error is large, other assignments are tried: all of them for up to
/// five cameras, otherwise exchanges of two cameras, one after the other.
CalibrationFit MeasureCalibration(const Sequence& sequence, int joint_count);

/// "cam1 and cam2 are interchanged"; for more than two cameras "cam1 has that of cam2, cam2 that of cam3, ...".
std::string DescribeInterchange(const CalibrationFit& fit);

/// Checks the calibrations of all sequences before they are used for figures in millimetres. Throws Error(kBadInput)
/// naming `file` where cameras are interchanged, and where they fit but the person would have the size of nobody in any
/// unit. Where the translations are in centimetres or metres, they are converted, which is reported. False, with a
/// warning, where the calibration does not fit at all.
bool CheckCalibration(Dataset& dataset, const std::string& file);

/// The unit of true poses (T, J, 3): nothing where they are in millimetres, or the bodies are not people. Another unit
/// is reported. Throws Error(kBadInput) naming `file` where the person would have the size of nobody in any unit.
std::optional<StatureUnit> UnitOfTruth(const BodySize& truth, const std::string& file);

/// Converts truth in centimetres or metres to millimetres, as UnitOfTruth() finds.
void CheckUnitOfTruth(Dataset& dataset, const std::string& file);

}  // namespace canonpose
