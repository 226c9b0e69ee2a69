// Statistics of a simulated detector's errors, which can be compared with those of real detectors.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/motion/landmarks.h"
#include "canonpose/simulate/detector.h"
#include "canonpose/simulate/rig.h"

namespace canonpose {

/// Collects the errors of detected joints over clips and cameras, in constant memory. Errors are in percent of the
/// person's height in the image (stature times focal length over distance).
class DetectorStatistics {
 public:
  explicit DetectorStatistics(const DetectorLayout& layout);
  void Add(const LandmarkTrack& track, const FilmingCamera& camera, const Detections& detections);
  /// Adds the statistics that another object has collected for the same layout.
  void Merge(const DetectorStatistics& other);

  /// Percentile 0..100 of the error of one joint, or of all joints if `joint` is -1; accurate to 0.02 and at most 100.
  /// NaN without detections.
  [[nodiscard]] double Percentile(int joint, double percent) const;
  /// The same for joints that are hidden by the body.
  [[nodiscard]] double HiddenPercentile(double percent) const;
  /// Percentile 0..100 of the confidences.
  [[nodiscard]] double ConfidencePercentile(double percent) const;
  /// Area under the ROC curve of low confidence as a predictor of a large error (> 5 % of the height); NaN without
  /// large errors.
  [[nodiscard]] double ConfidenceAuc() const;
  /// Rank (Spearman) correlation of confidence and error; NaN where either is constant.
  [[nodiscard]] double ConfidenceCorrelation() const;
  /// Fraction of the joints, 0..1, in frames in which anything was detected.
  [[nodiscard]] double Share(DetectionErrorKind kind) const;
  /// Fraction of frames and cameras, 0..1, that have the person in the image but no detection at all.
  [[nodiscard]] double MissedFrameShare() const;
  /// A table with percentiles 50, 75, 90, 95, 99 by joint, then the figures above.
  [[nodiscard]] std::string Describe() const;

 private:
  /// Percentile from counts by bin of the error.
  [[nodiscard]] double PercentileOf(const std::vector<std::uint64_t>& bins, double percent) const;
  void AddJoint(std::size_t joint, double error_percent, double confidence, std::uint8_t errors);

  DetectorLayout layout_;
  std::vector<std::vector<std::uint64_t>> errors_;  ///< per joint, by error
  std::vector<std::uint64_t> hidden_errors_;        ///< of hidden joints, by error
  std::vector<std::uint64_t> large_, small_;        ///< large and small errors by confidence
  std::vector<std::uint64_t> ranks_;                ///< confidence by error, for the rank correlation
  std::array<std::uint64_t, 8> kinds_{};            ///< joints by bit of DetectionErrorKind
  std::uint64_t joints_ = 0;                        ///< in frames with a detection
  std::uint64_t frames_ = 0;
  std::uint64_t missed_frames_ = 0;
};

}  // namespace canonpose
