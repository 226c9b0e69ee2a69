// The axis of a person's body: what says which way is up where people are upright.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include <Eigen/Core>

#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

struct BodyAxis {
  Eigen::Vector3d direction;
  bool stands = false;  ///< with legs and trunk nearly straight; then from ankles to shoulders, otherwise of the trunk
};

/// A person's hips, shoulders, knees and ankles. Refers to the poses.
class Body {
 public:
  explicit Body(const PoseSequence& person);
  /// Nothing where hips or shoulders are unknown.
  [[nodiscard]] std::optional<BodyAxis> AxisAt(int frame) const;

 private:
  [[nodiscard]] Eigen::Vector3d At(int frame, std::size_t part, std::size_t side) const;
  [[nodiscard]] Eigen::Vector3d Middle(int frame, std::size_t part) const;

  const PoseSequence* person_;
  std::array<std::array<std::optional<int>, 2>, 4> joints_;
};

}  // namespace canonpose
