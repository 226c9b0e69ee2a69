#include "canonpose/data/body_size.h"

#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/median.h"
#include "canonpose/skeleton/anthropometry.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {

BodySize::BodySize(const Skeleton& skeleton) : joint_count_(skeleton.joints.size()) {
  for (const BodySegment& segment : kBodySegments) {
    for (const char side : {'l', 'r'}) {
      const std::optional<int> from = FindPart(skeleton, side + std::string(segment.from));
      const std::optional<int> to = FindPart(skeleton, side + std::string(segment.to));
      if (from && to) segments_.push_back({{*from, *to}, segment.share});
    }
  }
}

void BodySize::Add(const std::vector<float>& poses) {
  for (std::size_t pose = 0; pose < poses.size(); pose += 3 * joint_count_) {
    std::vector<double> statures;
    for (const Segment& segment : segments_) {
      double squares = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double difference =
            static_cast<double>(poses[pose + 3 * static_cast<std::size_t>(segment.joints[0]) + axis]) -
            poses[pose + 3 * static_cast<std::size_t>(segment.joints[1]) + axis];
        squares += difference * difference;
      }
      if (std::isfinite(squares)) statures.push_back(std::sqrt(squares) / segment.share);
    }
    if (!statures.empty()) statures_.push_back(Median(std::move(statures)));
  }
}

std::optional<double> BodySize::Stature() const {
  if (statures_.empty()) return std::nullopt;
  return Median(statures_);
}

std::optional<StatureUnit> UnitOfStature(double stature) {
  for (const auto& [name, mm] : {std::pair("millimetres", 1.0), {"centimetres", 10.0}, {"metres", 1000.0}}) {
    if (stature * mm >= kMinStatureMm && stature * mm < kMaxStatureMm) return StatureUnit{name, mm};
  }
  return std::nullopt;
}

std::string DescribeLength(double mm) {
  return mm < 1000.0 ? fmt::format("{:.3g} mm", mm) : fmt::format("{:.3g} m", mm / 1000.0);
}

}  // namespace canonpose
