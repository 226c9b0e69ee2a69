#include "canonpose/scene/body_axis.h"

#include <cmath>
#include <string>

#include "canonpose/geometry/angles.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {

Body::Body(const PoseSequence& person) : person_(&person) {
  constexpr const char* kBodyParts[] = {"hip", "shoulder", "knee", "ankle"};
  for (std::size_t part = 0; part < 4; ++part) {
    for (std::size_t side = 0; side < 2; ++side) {
      joints_[part][side] = FindPart(person.skeleton(), (side == 0 ? "l" : "r") + std::string(kBodyParts[part]));
    }
  }
}

std::optional<BodyAxis> Body::AxisAt(int frame) const {
  const Eigen::Vector3d hips = Middle(frame, 0);
  const Eigen::Vector3d shoulders = Middle(frame, 1);
  const Eigen::Vector3d ankles = Middle(frame, 3);
  const Eigen::Vector3d trunk = shoulders - hips;
  if (!(trunk.norm() > 0.0)) return std::nullopt;
  const Eigen::Vector3d legs = hips - ankles;
  double leg_length = 0.0;
  for (std::size_t side = 0; side < 2; ++side) {
    leg_length +=
        0.5 * ((At(frame, 0, side) - At(frame, 2, side)).norm() + (At(frame, 2, side) - At(frame, 3, side)).norm());
  }
  // Of a walking person's legs the middle is a little shorter, of a sitting person's much.
  constexpr double kStraight = 0.88;
  const double cosine_of_bend = trunk.dot(legs) / (trunk.norm() * legs.norm());
  const bool stands = legs.norm() > kStraight * leg_length && cosine_of_bend > std::cos(RadFromDeg(30.0));
  const Eigen::Vector3d axis = stands ? Eigen::Vector3d(shoulders - ankles) : trunk;
  return BodyAxis{axis.normalized(), stands};
}

Eigen::Vector3d Body::At(int frame, std::size_t part, std::size_t side) const {
  const std::optional<int>& joint = joints_[part][side];
  if (!joint) return Eigen::Vector3d::Constant(std::nan(""));
  return person_->PoseAt(frame).row(*joint).transpose().cast<double>();
}

Eigen::Vector3d Body::Middle(int frame, std::size_t part) const {
  return 0.5 * (At(frame, part, 0) + At(frame, part, 1));
}

}  // namespace canonpose
