// What a simulated detector's errors are like, in the figures that are known of real ones.
#pragma once

#include <string>
#include <vector>

#include "canonpose/simulate/detector.h"
#include "canonpose/simulate/landmarks.h"
#include "canonpose/simulate/rig.h"

namespace canonpose {

/// Collects errors over clips and cameras. Errors are in percent of the person's height in the image (stature times
/// focal length over distance).
class DetectorStatistics {
 public:
  explicit DetectorStatistics(const DetectorLayout& layout);
  void Add(const LandmarkTrack& track, const FilmingCamera& camera, const Detections& detections);

  /// Percentile 0..100 of the error of one joint, or of all where joint is -1.
  [[nodiscard]] double Percentile(int joint, double percent) const;
  /// Area under the ROC curve of low confidence as the sign of a large error (> 5 % of the height); NaN without any.
  [[nodiscard]] double ConfidenceAuc() const;
  /// Rank (Spearman) correlation of confidence and error.
  [[nodiscard]] double ConfidenceCorrelation() const;
  [[nodiscard]] double Share(ErrorKind kind) const;  ///< of joints, 0..1
  [[nodiscard]] double MissedFrameShare() const;     ///< of frames and cameras
  /// A table: percentiles 50, 75, 90, 95, 99 by joint, then the figures above.
  [[nodiscard]] std::string Describe() const;
};

}  // namespace canonpose
