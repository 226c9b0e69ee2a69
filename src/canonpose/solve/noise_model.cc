#include "canonpose/solve/noise_model.h"

#include <algorithm>
#include <cmath>

namespace canonpose {
namespace {

constexpr double kMinScatter = 1e-5;
/// The median length of a 2-vector of normal errors of scatter 1.
constexpr double kMedianLength = 1.1774;
constexpr int kMaxGroups = 10;
constexpr std::size_t kMinErrorsPerGroup = 50;

template <typename Value>
double MedianOf(std::vector<KeypointError>::const_iterator first, std::vector<KeypointError>::const_iterator last,
                Value&& value) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(last - first));
  for (auto error = first; error != last; ++error) values.push_back(value(*error));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

NoiseModel::NoiseModel(std::vector<KeypointError> errors, int joint_count, double min_factor) {
  if (errors.empty()) return;
  std::stable_sort(errors.begin(), errors.end(),
                   [](const KeypointError& a, const KeypointError& b) { return a.confidence < b.confidence; });
  const auto length = [](const KeypointError& error) { return error.length / kMedianLength; };
  scatter_ = std::max(kMinScatter, MedianOf(errors.begin(), errors.end(), length));
  const std::size_t groups =
      std::clamp<std::size_t>(errors.size() / kMinErrorsPerGroup, 1, static_cast<std::size_t>(kMaxGroups));
  for (std::size_t g = 0; g < groups; ++g) {
    const auto first = errors.begin() + static_cast<std::ptrdiff_t>(g * errors.size() / groups);
    const auto last = errors.begin() + static_cast<std::ptrdiff_t>((g + 1) * errors.size() / groups);
    const double confidence = MedianOf(first, last, [](const KeypointError& error) { return error.confidence; });
    double factor = MedianOf(first, last, length) / scatter_;
    if (!factors_.empty()) factor = std::min(factor, factors_.back());
    confidences_.push_back(confidence);
    factors_.push_back(std::max(factor, min_factor));
  }
  std::vector<std::vector<double>> relative(static_cast<std::size_t>(joint_count));
  joint_factors_.assign(static_cast<std::size_t>(joint_count), 1.0);
  for (const KeypointError& error : errors) {
    relative[static_cast<std::size_t>(error.joint)].push_back(length(error) / Scatter(error.joint, error.confidence));
  }
  for (std::size_t j = 0; j < relative.size(); ++j) {
    if (relative[j].size() < kMinErrorsPerGroup) continue;
    const auto middle = relative[j].begin() + static_cast<std::ptrdiff_t>(relative[j].size() / 2);
    std::nth_element(relative[j].begin(), middle, relative[j].end());
    joint_factors_[j] = std::clamp(*middle, 0.25, 4.0);
  }
}

double NoiseModel::Scatter(int joint, double confidence) const {
  if (joint_factors_.empty()) return scatter_ / std::max(confidence, 1e-3);
  const auto above = std::lower_bound(confidences_.begin(), confidences_.end(), confidence);
  const auto i = static_cast<std::size_t>(above - confidences_.begin());
  double factor;
  if (i == 0) {
    factor = factors_.front();
  } else if (i == confidences_.size()) {
    factor = factors_.back();
  } else {
    const double position = (confidence - confidences_[i - 1]) / (confidences_[i] - confidences_[i - 1]);
    factor = factors_[i - 1] + position * (factors_[i] - factors_[i - 1]);
  }
  return scatter_ * joint_factors_[static_cast<std::size_t>(joint)] * factor;
}

}  // namespace canonpose
