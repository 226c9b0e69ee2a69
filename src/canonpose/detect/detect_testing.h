// Shared by tests only: people made of a few numbers, and a detector that sees them.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "canonpose/detect/pose_network.h"

namespace canonpose::testing {

/// Where the joints of somebody standing are, relative to the middle of the hips; a trunk is 1 high.
inline DetectedPose StandingPerson(float x, float y, float trunk, float score = 0.8F) {
  static constexpr std::array<std::array<float, 2>, kPoseJoints> kPlaces{{{0.0F, -1.4F},
                                                                          {0.05F, -1.45F},
                                                                          {-0.05F, -1.45F},
                                                                          {0.1F, -1.4F},
                                                                          {-0.1F, -1.4F},
                                                                          {0.35F, -1.0F},
                                                                          {-0.35F, -1.0F},
                                                                          {0.45F, -0.5F},
                                                                          {-0.45F, -0.5F},
                                                                          {0.5F, 0.0F},
                                                                          {-0.5F, 0.0F},
                                                                          {0.2F, 0.0F},
                                                                          {-0.2F, 0.0F},
                                                                          {0.2F, 0.8F},
                                                                          {-0.2F, 0.8F},
                                                                          {0.2F, 1.6F},
                                                                          {-0.2F, 1.6F}}};
  DetectedPose pose;
  for (std::size_t j = 0; j < kPoseJoints; ++j) {
    pose.joints[j].position = {x + trunk * kPlaces[j][0], y + trunk * kPlaces[j][1]};
    pose.joints[j].score = score;
  }
  pose.score = score;
  return pose;
}

/// Somebody who walks through the image.
struct Walker {
  std::function<float(long)> x;  ///< in pixels, by frame
  float y = 300.0F;
  float trunk = 60.0F;
  Appearance appearance{};
  std::function<bool(long)> is_visible = [](long) { return true; };
};

/// Sees walkers as a real detector does: a crop shows whoever is nearest its middle, and of two people who hide each
/// other, only the one in front (the later in the list).
class WalkerNetwork final : public PoseNetwork {
 public:
  explicit WalkerNetwork(std::vector<Walker> walkers) : walkers_(std::move(walkers)) {}

  long frame = 0;    ///< to be set by the test
  int searches = 0;  ///< how often the whole image was searched
  int crops = 0;

  [[nodiscard]] DetectedPose PoseOf(std::size_t walker) const {
    const Walker& w = walkers_[walker];
    return StandingPerson(w.x(frame), w.y, w.trunk);
  }

  std::vector<DetectedPose> FindPeople(const cv::Mat&) override {
    ++searches;
    std::vector<DetectedPose> people;
    for (const std::size_t w : Visible()) people.push_back(PoseOf(w));
    return people;
  }

  DetectedPose PoseInCrop(const cv::Mat&, const Crop& crop) override {
    ++crops;
    const Eigen::Vector2f middle = crop.corner + Eigen::Vector2f::Constant(0.5F * crop.size);
    DetectedPose best = StandingPerson(middle.x(), middle.y(), 0.2F * crop.size, 0.05F);  // nobody
    float nearest = 0.5F * crop.size;
    for (const std::size_t w : Visible()) {
      const Eigen::Vector2f hips(walkers_[w].x(frame), walkers_[w].y);
      const float distance = (hips - middle).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      best = PoseOf(w);
    }
    return best;
  }

  Appearance AppearanceOf(const cv::Mat&, const DetectedPose& pose) override {
    Appearance appearance{};
    float nearest = 1e9F;
    for (const std::size_t w : Visible()) {
      const float distance = (CentreOf(PoseOf(w)) - CentreOf(pose)).norm();
      if (distance >= nearest) continue;
      nearest = distance;
      appearance = walkers_[w].appearance;
    }
    return appearance;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> Visible() const {
    std::vector<std::size_t> visible;
    for (std::size_t w = 0; w < walkers_.size(); ++w) {
      bool is_hidden = !walkers_[w].is_visible(frame);
      for (std::size_t other = w + 1; other < walkers_.size(); ++other) {
        is_hidden = is_hidden || (walkers_[other].is_visible(frame) &&
                                  std::abs(walkers_[other].x(frame) - walkers_[w].x(frame)) < 0.4F * walkers_[w].trunk);
      }
      if (!is_hidden) visible.push_back(w);
    }
    return visible;
  }

  std::vector<Walker> walkers_;
};

}  // namespace canonpose::testing
