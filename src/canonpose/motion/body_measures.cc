#include "canonpose/motion/body_measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/skeleton/mapping.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;

// Evidence that outweighs the calm of twists by far, since it comes from points that are well apart.
constexpr double kSure = 1000.0;
/// Feet show the twist of straight legs, roughly.
constexpr double kRough = 0.1;
constexpr double kSpineOfTrunk = 0.475;  // of the distance from hips to thorax, as in Human3.6M's skeleton
constexpr double kSkullOfHead = 0.45;    // of the distance from thorax to crown
constexpr double kSkullToFace = 0.6;  // of the distance from thorax to the middle of the ears, the eyes or to the nose

Vector3d Unknown() { return Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()); }

std::optional<int> FindKeypoint(const Skeleton& skeleton, const std::string& part) {
  if (part.empty()) return std::nullopt;
  if (part == "upperneck") return skeleton.Find("UpperNeck");
  const std::optional<int> found = FindPart(skeleton, part);
  if (!found && part == "thorax") return skeleton.Find("Neck");
  return found;
}

/// An unknown or vanishing direction gives no evidence.
void AddHint(const Vector3d& in_joint, const Vector3d& direction, double weight, Aim& aim) {
  if (direction.allFinite() && direction.norm() > 1e-9 && weight > 0.0)
    aim.hints.push_back({in_joint.normalized(), direction.normalized(), weight});
}

Aim AimAlong(const Vector3d& direction) {
  Aim aim;
  aim.is_known = direction.allFinite() && direction.norm() > 1e-9;
  if (aim.is_known) aim.direction = direction.normalized();
  return aim;
}

}  // namespace

BodyMeasures::BodyMeasures(const PoseSequence& person) : frames_(person.frame_count()) {
  FindKeypoints(person);
  ReadPositions(person);
  DeriveJoints();
  EstimateStature(person);
}

void BodyMeasures::FindKeypoints(const PoseSequence& person) {
  for (std::size_t j = 0; j < kFittedJointCount; ++j)
    keypoints_[j] = FindKeypoint(person.skeleton(), HierarchyTemplate()[j].part).value_or(-1);
  for (const FittedJoint joint : {kFLHip, kFRHip, kFLShoulder, kFRShoulder}) {
    if (KeypointOf(joint) >= 0) continue;
    ThrowBadInput({person.name.empty() ? "a person" : person.name, "skeleton", "hips and shoulders",
                   fmt::format("no {}", NameOf(joint, JointNames::kOurs)), "a hierarchy can be fitted to people only"});
  }
}

void BodyMeasures::ReadPositions(const PoseSequence& person) {
  positions_.assign(static_cast<std::size_t>(frames_) * kFittedJointCount, Unknown());
  is_seen_.assign(positions_.size(), 0);
  for (int t = 0; t < frames_; ++t) {
    for (int j = 0; j < kFittedJointCount; ++j) {
      if (KeypointOf(j) < 0 || !person.IsKnown(t, KeypointOf(j))) continue;
      positions_[Index(t, j)] = person.PoseAt(t).row(KeypointOf(j)).transpose().cast<double>();
      is_seen_[Index(t, j)] = 1;
      is_ever_seen_[static_cast<std::size_t>(j)] = true;
    }
  }
  if (IsEverSeen(kFCrown)) {
    head_ = HeadKind::kCrown;
  } else if ((IsEverSeen(kFLEar) && IsEverSeen(kFREar)) || (IsEverSeen(kFLEye) && IsEverSeen(kFREye))) {
    head_ = HeadKind::kSides;
  } else if (IsEverSeen(kFNose)) {
    head_ = HeadKind::kNose;
  }
  for (int side = 0; side < 2; ++side) {
    if (!IsEverSeen(OnSide(kFLAnkle, side)) || !IsEverSeen(OnSide(kFLBigToe, side))) continue;
    const bool has_heel = IsEverSeen(OnSide(kFLHeel, side));
    feet_[static_cast<std::size_t>(side)] = has_heel ? FootKind::kHeelAndToes : FootKind::kAnkleAndToes;
  }
}

/// Joints between others, where they were not seen.
void BodyMeasures::DeriveJoints() {
  for (int t = 0; t < frames_; ++t) {
    const auto derive = [&](int joint, const Vector3d& position) {
      if (!IsKnown(t, joint)) positions_[Index(t, joint)] = position;
    };
    const auto middle = [&](int a, int b) { return Vector3d(0.5 * (At(t, a) + At(t, b))); };
    derive(kFHip, middle(kFLHip, kFRHip));
    derive(kFThorax, middle(kFLShoulder, kFRShoulder));
    derive(kFSpine, At(t, kFHip) + kSpineOfTrunk * Between(t, kFHip, kFThorax));
    const Vector3d& thorax = At(t, kFThorax);
    derive(kFSkull, thorax + kSkullOfHead * Between(t, kFThorax, kFCrown));
    derive(kFSkull, thorax + kSkullToFace * (middle(kFLEar, kFREar) - thorax));
    derive(kFSkull, thorax + kSkullToFace * (middle(kFLEye, kFREye) - thorax));
    derive(kFSkull, thorax + kSkullToFace * Between(t, kFThorax, kFNose));
  }
}

double BodyMeasures::MedianDistance(int from, int to) const {
  std::vector<double> lengths;
  for (int t = 0; t < frames_; ++t) {
    if (IsKnown(t, from) && IsKnown(t, to)) lengths.push_back(Between(t, from, to).norm());
  }
  return lengths.empty() ? 0.0 : Median(std::move(lengths));
}

void BodyMeasures::EstimateStature(const PoseSequence& person) {
  struct Segment {
    FittedJoint from;
    FittedJoint to;
    double share;  // of the stature (Winter, Biomechanics and Motor Control of Human Movement)
  };
  constexpr Segment kSegments[] = {{kFLHip, kFLKnee, 0.245},
                                   {kFLKnee, kFLAnkle, 0.246},
                                   {kFLShoulder, kFLElbow, 0.186},
                                   {kFLElbow, kFLWrist, 0.146}};
  std::vector<double> statures;
  for (const Segment& segment : kSegments) {
    for (int side = 0; side < 2; ++side) {
      const double length = MedianDistance(OnSide(segment.from, side), OnSide(segment.to, side));
      if (length > 0.0) statures.push_back(length / segment.share);
    }
  }
  if (const double trunk = MedianDistance(kFHip, kFThorax); trunk > 0.0) statures.push_back(trunk / 0.288);
  if (statures.empty()) {
    ThrowBadInput({person.name.empty() ? "a person" : person.name, "joints", "limbs or a trunk in some frames",
                   "none in any", "leave this person out"});
  }
  stature_mm_ = Median(std::move(statures));
}

Aim BodyMeasures::AimOf(FittedJoint joint, int frame, const Vector3d& base) const {
  switch (joint) {
    case kFHip:
    case kFLumbar:
    case kFSpine:
    case kFChest:
    case kFThorax:
      return AimOfTrunk(joint, frame, base);
    case kFSkull:
      return AimOfHead(frame, base);
    case kFLAnkle:
      return AimOfFoot(0, frame, base);
    case kFRAnkle:
      return AimOfFoot(1, frame, base);
    default:
      return AimOfLimb(joint, frame, base);
  }
}

Vector3d BodyMeasures::AxisOf(FittedJoint joint) const {
  switch (joint) {
    case kFHip:
    case kFLClavicle:
    case kFLShoulder:
    case kFLElbow:
      return Vector3d::UnitX();
    case kFRClavicle:
    case kFRShoulder:
    case kFRElbow:
      return -Vector3d::UnitX();
    case kFSkull:
      if (head_ == HeadKind::kSides) return Vector3d::UnitX();
      // The nose lies in front of and a little above the joint of the skull.
      return head_ == HeadKind::kNose ? Vector3d(0.0, -0.987, 0.16).normalized() : Vector3d(Vector3d::UnitZ());
    case kFLAnkle:
    case kFRAnkle: {
      const int side = joint == kFRAnkle ? 1 : 0;
      if (feet_[static_cast<std::size_t>(side)] != FootKind::kAnkleAndToes) return -Vector3d::UnitY();
      // Toes are as much lower than the ankle as those of an average foot.
      const double length = MedianDistance(joint, OnSide(kFLBigToe, side));
      const double down = std::min(0.6, 0.03 * stature_mm_ / length);
      return {0.0, -std::sqrt(1.0 - down * down), -down};
    }
    case kFLHip:
    case kFLKnee:
    case kFRHip:
    case kFRKnee:
      return -Vector3d::UnitZ();
    default:
      return Vector3d::UnitZ();
  }
}

/// The pelvis has the direction of the hips and, at right angles to it, that of the trunk. The twist of the trunk
/// between hips and shoulders is spread over its joints.
Aim BodyMeasures::AimOfTrunk(FittedJoint joint, int frame, const Vector3d& base) const {
  const Vector3d hips = Between(frame, kFRHip, kFLHip).normalized();
  const Vector3d shoulders = Between(frame, kFRShoulder, kFLShoulder).normalized();
  if (joint == kFHip) {
    Aim aim = AimAlong(hips);
    const Vector3d up = Between(frame, kFHip, kFSpine);
    // Without the trunk, the frame does not show which way the pelvis leans.
    aim.is_known = aim.is_known && up.allFinite();
    AddHint(Vector3d::UnitZ(), up, kSure, aim);
    return aim;
  }
  if (joint == kFThorax) return AimAlong(At(frame, kFSkull) - base);
  Aim aim = AimAlong(At(frame, joint == kFLumbar ? kFSpine : kFThorax) - base);
  const double share = joint == kFLumbar ? 1.0 / 3.0 : joint == kFSpine ? 2.0 / 3.0 : 1.0;
  if (share < 1.0) {
    AddHint(Vector3d::UnitX(), (1.0 - share) * hips + share * shoulders, kSure, aim);
  } else {
    AddHint(Vector3d::UnitX(), shoulders, kSure, aim);
  }
  return aim;
}

Aim BodyMeasures::AimOfHead(int frame, const Vector3d& base) const {
  const Vector3d ears = Between(frame, kFREar, kFLEar);
  const Vector3d eyes = Between(frame, kFREye, kFLEye);
  const Vector3d& nose = At(frame, kFNose);
  if (head_ == HeadKind::kNothing) return {};
  if (head_ == HeadKind::kNose) return AimAlong(nose - base);
  if (head_ == HeadKind::kCrown) {
    Aim aim = AimAlong(At(frame, kFCrown) - base);
    AddHint(Vector3d::UnitX(), ears, kSure, aim);
    AddHint(Vector3d::UnitX(), eyes, kSure, aim);
    AddHint(-Vector3d::UnitY(), nose - base, kSure, aim);
    return aim;
  }
  // The nose lies in front of the ears and a little lower, and in front of the eyes and as much lower (ANSUR II).
  const bool has_ears = ears.allFinite();
  Aim aim = AimAlong(has_ears ? ears : eyes);
  const Vector3d middle = has_ears ? Vector3d(0.5 * (At(frame, kFLEar) + At(frame, kFREar)))
                                   : Vector3d(0.5 * (At(frame, kFLEye) + At(frame, kFREye)));
  const Vector3d to_nose = has_ears ? Vector3d(0.0, -0.068, -0.014) : Vector3d(0.0, -0.023, -0.025);
  AddHint(to_nose, nose - middle, kSure, aim);
  if (!nose.allFinite()) AddHint(Vector3d::UnitZ(), middle - At(frame, kFThorax), kRough, aim);
  return aim;
}

/// Thighs and upper arms twist so that knee and elbow bend as hinges: the knee's axis points to the left, the elbow's
/// down on the left and up on the right, in a T with palms down.
Aim BodyMeasures::AimOfLimb(FittedJoint joint, int frame, const Vector3d& base) const {
  const int end = joint + 1;
  Aim aim = AimAlong(At(frame, end) - base);
  const auto add_hinge = [&](const Vector3d& hinge) {
    const Vector3d upper = Between(frame, joint, end).normalized();
    const Vector3d axis = upper.cross(Between(frame, end, end + 1).normalized());
    // Both evidence and trust in it grow with the sine of the bend.
    if (axis.allFinite()) aim.hints.push_back({hinge, axis, axis.norm()});
  };
  if (joint == kFLShoulder || joint == kFRShoulder) {
    add_hinge(-LeftSign(joint == kFRShoulder ? 1 : 0) * Vector3d::UnitZ());
  } else if (joint == kFLHip || joint == kFRHip) {
    add_hinge(Vector3d::UnitX());
    const int side = joint == kFRHip ? 1 : 0;
    AddHint(-Vector3d::UnitY(), ToeTip(frame, side) - At(frame, OnSide(kFLAnkle, side)), kRough, aim);
  }
  return aim;
}

Aim BodyMeasures::AimOfFoot(int side, int frame, const Vector3d& base) const {
  const FootKind kind = feet_[static_cast<std::size_t>(side)];
  if (kind == FootKind::kNothing) return {};
  const bool has_heel = kind == FootKind::kHeelAndToes;
  Aim aim = AimAlong(ToeTip(frame, side) - (has_heel ? At(frame, OnSide(kFLHeel, side)) : base));
  const Vector3d outwards = Between(frame, OnSide(kFLBigToe, side), OnSide(kFLSmallToe, side));
  AddHint(LeftSign(side) * Vector3d::UnitX(), outwards, 1.0, aim);
  if (has_heel) AddHint(Vector3d::UnitZ(), base - At(frame, OnSide(kFLHeel, side)), 1.0, aim);
  return aim;
}

/// The middle of the toes that the skeleton has.
Vector3d BodyMeasures::ToeTip(int frame, int side) const {
  const FittedJoint small = OnSide(kFLSmallToe, side);
  const Vector3d& big = At(frame, OnSide(kFLBigToe, side));
  if (KeypointOf(small) < 0 || !IsEverSeen(small)) return big;
  return 0.5 * (big + At(frame, small));
}

Vector3d BodyMeasures::MedianInSegment(FittedJoint segment, FittedJoint joint) const {
  const FittedJoint base = segment == kFChest ? kFThorax : segment;
  std::vector<Aim> aims;
  std::vector<int> frames;
  for (int t = 0; t < frames_; ++t) {
    if (!IsKnown(t, base) || !IsKnown(t, joint)) continue;
    // A keypoint's own position counts, not what would stand in for it.
    if (KeypointOf(joint) >= 0 && IsEverSeen(joint) && !IsSeen(t, joint)) continue;
    Aim aim = AimOf(segment, t, segment == kFChest ? At(t, kFSpine) : At(t, base));
    if (!aim.is_known || (aim.hints.empty() && segment != kFSkull)) continue;
    aims.push_back(aim);
    frames.push_back(t);
  }
  if (aims.empty()) return Unknown();
  const std::vector<Eigen::Quaterniond> rotations = CalmRotations(AxisOf(segment), aims, 0.0);
  std::array<std::vector<double>, 3> values;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vector3d local = rotations[i].conjugate() * Between(frames[i], base, joint);
    for (std::size_t axis = 0; axis < 3; ++axis) values[axis].push_back(local[static_cast<Eigen::Index>(axis)]);
  }
  return {Median(values[0]), Median(values[1]), Median(values[2])};
}

}  // namespace canonpose
