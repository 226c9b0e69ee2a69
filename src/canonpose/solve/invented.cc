#include "canonpose/solve/invented.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "canonpose/base/median.h"
#include "canonpose/solve/fit.h"

namespace canonpose {
namespace {

/// In units of the median confidence.
constexpr double kLowConfidence = 0.5;
/// A keypoint is far from its joint at this distance in body units, 14 cm for an adult, or this many times the scatter
/// of a typical keypoint. Joints that the body hides scatter by up to 0.015.
constexpr double kFar = 0.03;
constexpr double kFarScatters = 6.0;
/// By how many the far keypoints must outnumber the near ones, or the near ones the far ones above a confidence.
constexpr int kMinMajority = 10;

double MedianConfidence(const CaptureObservations& capture) {
  std::vector<double> seen;
  for (const float confidence : capture.confidence) {
    if (confidence > 0.0F) seen.push_back(confidence);
  }
  return Median(std::move(seen));
}

struct Judged {
  double confidence;
  bool is_far;
};

/// The confidence up to which keypoints are invented: `low` unless clearly more of those above some confidence are
/// near; 0 where none are invented.
double LargestInvented(std::vector<Judged> keypoints, double low) {
  std::ranges::sort(keypoints, {}, &Judged::confidence);
  double largest = 0.0;
  int majority = 0;
  int best = kMinMajority - 1;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    majority += keypoints[i].is_far ? 1 : -1;
    // Keypoints of the same confidence are kept or removed together.
    const bool is_last = i + 1 == keypoints.size() || keypoints[i + 1].confidence > keypoints[i].confidence;
    if (!is_last || majority <= best) continue;
    best = majority;
    largest = keypoints[i].confidence;
  }
  return largest > 0.0 && best - majority < kMinMajority ? low : largest;
}

}  // namespace

int RemoveInvented(std::span<const int> frames, const Solution& solution, CaptureObservations& capture) {
  const double low = kLowConfidence * MedianConfidence(capture);
  const double far = std::max(kFar, kFarScatters * solution.scales.observation.Typical());
  std::vector<std::vector<Judged>> keypoints(capture.Index(1, 0, 0));  // (V, J)
  VisitErrors(capture, frames, solution.estimate, [&](int n, int v, int j, double error) {
    const double confidence = capture.confidence[capture.Index(n, v, j)];
    if (confidence <= low) keypoints[capture.Index(0, v, j)].push_back({confidence, error > far});
  });
  int removed = 0;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const double largest = LargestInvented(std::move(keypoints[i]), low);
    if (largest <= 0.0) continue;
    for (std::size_t k = i; k < capture.confidence.size(); k += keypoints.size()) {
      if (!(capture.confidence[k] > 0.0F) || capture.confidence[k] > largest) continue;
      capture.confidence[k] = 0.0F;
      capture.xy[2 * k] = capture.xy[2 * k + 1] = std::numeric_limits<float>::quiet_NaN();
      ++removed;
    }
  }
  return removed;
}

}  // namespace canonpose
