#include "canonpose/simulate/statistics.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

constexpr double kBinPercent = 0.02;
constexpr std::size_t kErrorBins = 5000;  ///< to 100 %
constexpr double kLargePercent = 5.0;
constexpr std::size_t kConfidenceBins = 1000;
/// Bins of the rank correlation: confidence in equal steps, error in equal steps of its logarithm from 0.01 to 100 %.
constexpr std::size_t kRankBins = 400;
constexpr std::array<double, 5> kPercents = {50, 75, 90, 95, 99};

std::size_t Bin(double share, std::size_t bins) {
  return static_cast<std::size_t>(std::clamp(share * static_cast<double>(bins), 0.0, static_cast<double>(bins) - 1.0));
}

double Ratio(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

std::uint64_t Sum(const std::vector<std::uint64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

void AddTo(std::vector<std::uint64_t>& counts, const std::vector<std::uint64_t>& other) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other[i];
}

/// The mean rank of each bin's members, minus the mean rank of all.
std::vector<double> CentredRanks(const std::vector<std::uint64_t>& counts) {
  const auto total = static_cast<double>(Sum(counts));
  std::vector<double> ranks;
  double below = 0.0;
  for (const std::uint64_t count : counts) {
    ranks.push_back(below + static_cast<double>(count) / 2.0 - total / 2.0);
    below += static_cast<double>(count);
  }
  return ranks;
}

/// A figure of a table; a dash if it could not be measured.
std::string Cell(double value) {
  return std::isnan(value) ? fmt::format("{:>8}", "-") : fmt::format("{:>8.2f}", value);
}

}  // namespace

DetectorStatistics::DetectorStatistics(const DetectorLayout& layout)
    : layout_(layout),
      errors_(layout.from_landmarks.joints.size(), std::vector<std::uint64_t>(kErrorBins)),
      hidden_errors_(kErrorBins),
      large_(kConfidenceBins),
      small_(kConfidenceBins),
      ranks_(kRankBins * kRankBins) {}

void DetectorStatistics::Add(const LandmarkTrack& track, const FilmingCamera& camera, const Detections& detections) {
  const std::size_t count = errors_.size();
  const std::vector<Eigen::Vector3d> positions = JointPositions(track, layout_);
  CANONPOSE_CHECK(detections.confidence.size() == positions.size(), "{} detections of {} joints",
                  detections.confidence.size(), positions.size());
  for (int t = 0; t < track.frame_count(); ++t) {
    const std::size_t first = static_cast<std::size_t>(t) * count;
    const auto is_found = [](float confidence) { return confidence > 0.0F; };
    const bool is_any = std::any_of(&detections.confidence[first], &detections.confidence[first] + count, is_found);
    const bool is_inside = std::any_of(&detections.errors[first], &detections.errors[first] + count,
                                       [](std::uint8_t errors) { return (errors & kOutsideImage) == 0; });
    if (is_inside) ++frames_;
    if (!is_any) {
      if (is_inside) ++missed_frames_;
      continue;
    }
    const Camera& now = camera.cameras[camera.cameras.size() == 1 ? 0 : static_cast<std::size_t>(t)];
    const double height_px = ImageHeightPx(now, &track.At(t, 0));
    for (std::size_t j = 0; j < count; ++j) {
      const std::size_t at = first + j;
      ++joints_;
      for (std::size_t bit = 0; bit < kinds_.size(); ++bit) kinds_[bit] += (detections.errors[at] >> bit) & 1U;
      if (!is_found(detections.confidence[at])) continue;
      const Eigen::Vector2d found(detections.keypoints[2 * at], detections.keypoints[2 * at + 1]);
      const double error = 100.0 * (found - now.Project(positions[at])).norm() / height_px;
      if (std::isfinite(error))
        AddJoint(j, error, static_cast<double>(detections.confidence[at]), detections.errors[at]);
    }
  }
}

void DetectorStatistics::AddJoint(std::size_t joint, double error_percent, double confidence, std::uint8_t errors) {
  const std::size_t bin = Bin(error_percent / 100.0, kErrorBins);
  ++errors_[joint][bin];
  if ((errors & kOccluded) != 0) ++hidden_errors_[bin];
  ++(error_percent > kLargePercent ? large_ : small_)[Bin(confidence, kConfidenceBins)];
  const double log_error = (std::log10(std::max(error_percent, 1e-9)) + 2.0) / 4.0;
  ++ranks_[Bin(log_error, kRankBins) * kRankBins + Bin(confidence, kRankBins)];
}

void DetectorStatistics::Merge(const DetectorStatistics& other) {
  CANONPOSE_CHECK(errors_.size() == other.errors_.size(), "{} and {} joints", errors_.size(), other.errors_.size());
  for (std::size_t j = 0; j < errors_.size(); ++j) AddTo(errors_[j], other.errors_[j]);
  AddTo(hidden_errors_, other.hidden_errors_);
  AddTo(large_, other.large_);
  AddTo(small_, other.small_);
  AddTo(ranks_, other.ranks_);
  for (std::size_t bit = 0; bit < kinds_.size(); ++bit) kinds_[bit] += other.kinds_[bit];
  joints_ += other.joints_;
  frames_ += other.frames_;
  missed_frames_ += other.missed_frames_;
}

double DetectorStatistics::PercentileOf(const std::vector<std::uint64_t>& bins, double percent) const {
  const auto total = static_cast<double>(Sum(bins));
  if (total == 0.0) return std::numeric_limits<double>::quiet_NaN();
  const double wanted = std::clamp(percent / 100.0, 0.0, 1.0) * total;
  const double width = 1.0 / static_cast<double>(bins.size());
  double below = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const auto count = static_cast<double>(bins[i]);
    if (count > 0.0 && below + count >= wanted) {
      return (static_cast<double>(i) + (wanted - below) / count) * width;
    }
    below += count;
  }
  return 1.0;
}

double DetectorStatistics::Percentile(int joint, double percent) const {
  if (joint >= 0) return 100.0 * PercentileOf(errors_.at(static_cast<std::size_t>(joint)), percent);
  std::vector<std::uint64_t> all(kErrorBins);
  for (const std::vector<std::uint64_t>& bins : errors_) AddTo(all, bins);
  return 100.0 * PercentileOf(all, percent);
}

double DetectorStatistics::HiddenPercentile(double percent) const {
  return 100.0 * PercentileOf(hidden_errors_, percent);
}

double DetectorStatistics::ConfidencePercentile(double percent) const {
  std::vector<std::uint64_t> all = large_;
  AddTo(all, small_);
  return PercentileOf(all, percent);
}

double DetectorStatistics::ConfidenceAuc() const {
  // The probability that the confidence of a large error is lower than that of a small error; ties count half.
  double below = 0.0;
  double larges = 0.0;
  for (std::size_t i = 0; i < kConfidenceBins; ++i) {
    below += static_cast<double>(small_[i]) * (larges + 0.5 * static_cast<double>(large_[i]));
    larges += static_cast<double>(large_[i]);
  }
  const auto smalls = static_cast<double>(Sum(small_));
  return larges > 0.0 && smalls > 0.0 ? below / (larges * smalls) : std::numeric_limits<double>::quiet_NaN();
}

double DetectorStatistics::ConfidenceCorrelation() const {
  std::vector<std::uint64_t> by_error(kRankBins);
  std::vector<std::uint64_t> by_confidence(kRankBins);
  for (std::size_t e = 0; e < kRankBins; ++e) {
    for (std::size_t c = 0; c < kRankBins; ++c) {
      by_error[e] += ranks_[e * kRankBins + c];
      by_confidence[c] += ranks_[e * kRankBins + c];
    }
  }
  const std::vector<double> error_ranks = CentredRanks(by_error);
  const std::vector<double> confidence_ranks = CentredRanks(by_confidence);
  double together = 0.0;
  double of_error = 0.0;
  double of_confidence = 0.0;
  for (std::size_t e = 0; e < kRankBins; ++e) {
    of_error += static_cast<double>(by_error[e]) * error_ranks[e] * error_ranks[e];
    of_confidence += static_cast<double>(by_confidence[e]) * confidence_ranks[e] * confidence_ranks[e];
    for (std::size_t c = 0; c < kRankBins; ++c) {
      together += static_cast<double>(ranks_[e * kRankBins + c]) * error_ranks[e] * confidence_ranks[c];
    }
  }
  const double both = std::sqrt(of_error * of_confidence);
  return both > 0.0 ? together / both : std::numeric_limits<double>::quiet_NaN();
}

double DetectorStatistics::Share(DetectionErrorKind kind) const {
  return Ratio(kinds_[static_cast<std::size_t>(std::countr_zero(static_cast<unsigned>(kind)))], joints_);
}

double DetectorStatistics::MissedFrameShare() const { return Ratio(missed_frames_, frames_); }

std::string DetectorStatistics::Describe() const {
  std::string text = "error, % of the person's height in the image\n";
  const auto line = [&](const std::string& name, auto&& percentile) {
    text += fmt::format("{:<12}", name);
    for (const double percent : kPercents) text += Cell(percentile(percent));
    text += '\n';
  };
  text += fmt::format("{:<12}", "percentile");
  for (const double percent : kPercents) text += fmt::format("{:>8}", percent);
  text += '\n';
  for (std::size_t j = 0; j < errors_.size(); ++j) {
    line(layout_.from_landmarks.target.joints[j], [&](double p) { return Percentile(static_cast<int>(j), p); });
  }
  line("all", [&](double p) { return Percentile(-1, p); });
  if (Sum(hidden_errors_) > 0) line("all hidden", [&](double p) { return HiddenPercentile(p); });
  const auto share = [&](const char* name, double value) {
    text += fmt::format("{:<28}{:>8.2f} %\n", name, 100 * value);
  };
  share("joints hidden by the body", Share(kOccluded));
  share("joints with left-right swap", Share(kSwapped));
  share("joints in a wrong place", Share(kOutlier));
  share("joints missed", Share(kMissed));
  share("joints outside the image", Share(kOutsideImage));
  share("frames missed", MissedFrameShare());
  text += fmt::format("{:<28}{:>8.2f}, median {:.2f}, 95th {:.2f}\n", "confidence, 5th percentile",
                      ConfidencePercentile(5), ConfidencePercentile(50), ConfidencePercentile(95));
  text += fmt::format("{:<28}{}  (low confidence as predictor of an error above {:g} %)\n", "confidence AUC",
                      Cell(ConfidenceAuc()), kLargePercent);
  text += fmt::format("{:<28}{}  (Spearman)\n", "confidence and error", Cell(ConfidenceCorrelation()));
  return text;
}

}  // namespace canonpose
