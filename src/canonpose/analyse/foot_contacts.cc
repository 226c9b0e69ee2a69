#include "canonpose/analyse/foot_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "canonpose/analyse/filter.h"
#include "canonpose/base/median.h"

namespace canonpose {
namespace {

// In lengths of the leg.
constexpr double kNear = 0.1;
constexpr double kSlowPerSecond = 0.6;
constexpr double kHighestFloor = 0.5;

constexpr double kShortestContactSeconds = 0.1;
constexpr double kLongestInterruptionSeconds = 0.08;
constexpr double kCutoffHz = 6.0;

/// The median length of thigh and shank; NaN where no leg is known.
double LegLength(const PoseSequence& person, const BodyJoints& joints) {
  std::vector<double> lengths;
  for (const Side side : kSides) {
    const LimbJoints& leg = joints.Of(side);
    for (int t = 0; t < person.frame_count(); ++t) {
      const Eigen::Vector3d knee = PositionOf(person, t, leg.knee);
      const double length =
          (PositionOf(person, t, leg.hip) - knee).norm() + (knee - PositionOf(person, t, leg.ankle)).norm();
      if (std::isfinite(length)) lengths.push_back(length);
    }
  }
  return Median(lengths);
}

/// The height below which a point is in one frame of twenty.
double LowestHeight(const PoseSequence& person, int joint) {
  std::vector<double> heights;
  for (int t = 0; t < person.frame_count(); ++t) {
    if (person.IsKnown(t, joint)) heights.push_back(person.PoseAt(t)(joint, 2));
  }
  if (heights.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 20);
  std::nth_element(heights.begin(), low, heights.end());
  return *low;
}

/// The speed in a frame, from its neighbours; at an end, and next to a gap, from one neighbour. NaN without any.
double SpeedAt(const PoseSequence& person, int joint, int frame) {
  int before = frame;
  int after = frame;
  if (frame > 0 && person.IsKnown(frame - 1, joint)) --before;
  if (frame + 1 < person.frame_count() && person.IsKnown(frame + 1, joint)) ++after;
  if (before == after) return std::numeric_limits<double>::quiet_NaN();
  const double seconds = person.TimeOf(after) - person.TimeOf(before);
  return (PositionOf(person, after, joint) - PositionOf(person, before, joint)).norm() / seconds;
}

/// (T) whether one of the foot's points stands.
std::vector<bool> Stands(const PoseSequence& person, const LimbJoints& limbs, double leg_length) {
  std::vector<int> points;
  for (const int joint : {limbs.heel, limbs.big_toe}) {
    if (joint >= 0) points.push_back(joint);
  }
  if (points.empty() && limbs.ankle >= 0) points.push_back(limbs.ankle);
  std::vector<bool> stands(static_cast<std::size_t>(person.frame_count()), false);
  for (const int joint : points) {
    const double floor = LowestHeight(person, joint);
    if (!(floor < kHighestFloor * leg_length)) continue;
    for (int t = 0; t < person.frame_count(); ++t) {
      if (!person.IsKnown(t, joint) || person.PoseAt(t)(joint, 2) > floor + kNear * leg_length) continue;
      if (SpeedAt(person, joint, t) < kSlowPerSecond * leg_length) stands[static_cast<std::size_t>(t)] = true;
    }
  }
  return stands;
}

}  // namespace

std::vector<FootContact> FindFootContacts(const PoseSequence& person, const BodyJoints& joints) {
  const double leg_length = LegLength(person, joints);
  const double fps = FrameRateOf(person);
  if (!std::isfinite(leg_length) || !(fps > 0.0)) return {};
  PoseSequence smooth = person;
  if (kCutoffHz < fps / 2.0) LowPass(smooth, kCutoffHz);
  std::vector<FootContact> contacts;
  for (const Side side : kSides) {
    const std::vector<bool> stands = Stands(smooth, joints.Of(side), leg_length);
    std::vector<FootContact> found;
    for (int t = 0; t < person.frame_count(); ++t) {
      if (!stands[static_cast<std::size_t>(t)]) continue;
      if (!found.empty() && t - found.back().last_frame - 1 < kLongestInterruptionSeconds * fps) {
        found.back().last_frame = t;
      } else {
        found.push_back({side == Side::kLeft, t, t});
      }
    }
    std::erase_if(found, [&](const FootContact& contact) {
      return contact.last_frame - contact.first_frame + 1 < kShortestContactSeconds * fps;
    });
    contacts.insert(contacts.end(), found.begin(), found.end());
  }
  std::stable_sort(contacts.begin(), contacts.end(),
                   [](const FootContact& a, const FootContact& b) { return a.first_frame < b.first_frame; });
  return contacts;
}

}  // namespace canonpose
