#include "canonpose/detect/appearance.h"

#include <cmath>
#include <initializer_list>
#include <limits>

namespace canonpose {
namespace {

constexpr int kSamples = 8;
constexpr float kNoColour = std::numeric_limits<float>::quiet_NaN();

/// The mean of colours, sampled one by one.
class MeanColour {
 public:
  explicit MeanColour(const cv::Mat& image) : image_(image) {}

  void Add(const Eigen::Vector2f& position) {
    const int x = static_cast<int>(std::lround(position.x()));
    const int y = static_cast<int>(std::lround(position.y()));
    if (x < 0 || y < 0 || x >= image_.cols || y >= image_.rows) return;
    const auto* pixel = image_.ptr<unsigned char>(y) + static_cast<std::ptrdiff_t>(3) * x;
    for (std::size_t c = 0; c < 3; ++c) sum_[c] += static_cast<float>(pixel[2 - c]) / 255.0F;
    ++count_;
  }

  [[nodiscard]] float operator[](std::size_t channel) const {
    return count_ > 0 ? sum_[channel] / static_cast<float>(count_) : kNoColour;
  }

 private:
  const cv::Mat& image_;
  std::array<float, 3> sum_{};
  int count_ = 0;
};

float Fraction(int i) { return (static_cast<float>(i) + 0.5F) / static_cast<float>(kSamples); }

bool AreSeen(const DetectedPose& pose, std::initializer_list<PoseJoint> joints) {
  for (const PoseJoint joint : joints) {
    if (!IsSeen(pose.joints[joint])) return false;
  }
  return true;
}

void AddTrunk(const DetectedPose& pose, MeanColour& colour) {
  if (!AreSeen(pose, {kLShoulder, kRShoulder, kLHip, kRHip})) return;
  for (int row = 0; row < kSamples; ++row) {
    const float down = Fraction(row);
    const Eigen::Vector2f left = (1.0F - down) * pose.joints[kLShoulder].position + down * pose.joints[kLHip].position;
    const Eigen::Vector2f right = (1.0F - down) * pose.joints[kRShoulder].position + down * pose.joints[kRHip].position;
    for (int column = 0; column < kSamples; ++column) {
      colour.Add((1.0F - Fraction(column)) * left + Fraction(column) * right);
    }
  }
}

void AddThigh(const DetectedPose& pose, PoseJoint hip, PoseJoint knee, MeanColour& colour) {
  if (!AreSeen(pose, {hip, knee})) return;
  for (int i = 0; i < kSamples; ++i) {
    colour.Add((1.0F - Fraction(i)) * pose.joints[hip].position + Fraction(i) * pose.joints[knee].position);
  }
}

}  // namespace

Appearance MeasureAppearance(const cv::Mat& image, const DetectedPose& pose) {
  MeanColour trunk(image);
  AddTrunk(pose, trunk);
  MeanColour thighs(image);
  AddThigh(pose, kLHip, kLKnee, thighs);
  AddThigh(pose, kRHip, kRKnee, thighs);
  return {trunk[0], trunk[1], trunk[2], thighs[0], thighs[1], thighs[2]};
}

float AppearanceDistance(const Appearance& a, const Appearance& b, float unknown) {
  float sum = 0.0F;
  int count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) || std::isnan(b[i])) continue;
    sum += std::abs(a[i] - b[i]);
    ++count;
  }
  return count > 0 ? sum / static_cast<float>(count) : unknown;
}

void UpdateAppearance(Appearance& mean, const Appearance& seen, float share) {
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (std::isnan(seen[i])) continue;
    mean[i] = std::isnan(mean[i]) ? seen[i] : (1.0F - share) * mean[i] + share * seen[i];
  }
}

}  // namespace canonpose
