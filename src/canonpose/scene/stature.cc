#include "canonpose/scene/stature.h"

#include <cmath>
#include <string_view>
#include <vector>

#include "canonpose/base/median.h"
#include "canonpose/skeleton/anthropometry.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

std::optional<int> FindSided(const Skeleton& skeleton, char side, std::string_view part) {
  return FindPart(skeleton, side + std::string(part));
}

/// The median length of a segment over time and both sides; NaN where it is not known.
double SegmentLength(const PoseSequence& person, const BodySegment& segment) {
  std::vector<double> lengths;
  for (const char side : {'l', 'r'}) {
    const std::optional<int> from = FindSided(person.skeleton(), side, segment.from);
    const std::optional<int> to = FindSided(person.skeleton(), side, segment.to);
    if (!from || !to) continue;
    for (int t = 0; t < person.frame_count(); ++t) {
      const double length = (person.PoseAt(t).row(*from) - person.PoseAt(t).row(*to)).cast<double>().norm();
      if (std::isfinite(length)) lengths.push_back(length);
    }
  }
  return Median(std::move(lengths));
}

/// From the middle of the hips to the middle of the shoulders: the median; NaN where it is not known.
double TrunkLength(const PoseSequence& person) {
  const std::optional<int> joints[] = {
      FindSided(person.skeleton(), 'l', "hip"), FindSided(person.skeleton(), 'r', "hip"),
      FindSided(person.skeleton(), 'l', "shoulder"), FindSided(person.skeleton(), 'r', "shoulder")};
  for (const std::optional<int>& joint : joints) {
    if (!joint) return std::nan("");
  }
  std::vector<double> lengths;
  for (int t = 0; t < person.frame_count(); ++t) {
    const auto pose = person.PoseAt(t);
    const double length =
        0.5 * (pose.row(*joints[0]) + pose.row(*joints[1]) - pose.row(*joints[2]) - pose.row(*joints[3]))
                  .cast<double>()
                  .norm();
    if (std::isfinite(length)) lengths.push_back(length);
  }
  return Median(std::move(lengths));
}

}  // namespace

std::optional<StatureEstimate> EstimateStature(const PoseSequence& person) {
  struct Sum {
    double length = 0.0;
    double share = 0.0;
    void Add(double segment, double segment_share) {
      if (!std::isfinite(segment)) return;
      length += segment;
      share += segment_share;
    }
  };
  Sum legs;
  Sum trunk;
  Sum arms;
  for (const BodySegment& segment : kBodySegments) {
    if (segment.from == "shoulder" && segment.to == "hip") {
      trunk.Add(TrunkLength(person), segment.share);
    } else if (segment.from == "hip" || segment.from == "knee") {
      legs.Add(SegmentLength(person, segment), segment.share);
    } else {
      arms.Add(SegmentLength(person, segment), segment.share);
    }
  }
  // People of one height differ by about 3 % in the length of their legs and of their arms, and people with long legs
  // have a short trunk.
  if (legs.share > 0.4 && trunk.share > 0.0) {
    return StatureEstimate{(legs.length + trunk.length) / (legs.share + trunk.share), 2.0,
                           "the lengths of legs and trunk"};
  }
  if (legs.share > 0.4) return StatureEstimate{legs.length / legs.share, 3.5, "the lengths of the legs"};
  if (legs.share + trunk.share > 0.0) {
    return StatureEstimate{(legs.length + trunk.length) / (legs.share + trunk.share), 5.0,
                           "the lengths of legs and trunk, in part"};
  }
  if (arms.share > 0.0) return StatureEstimate{arms.length / arms.share, 5.0, "the lengths of the arms"};
  return std::nullopt;
}

}  // namespace canonpose
