// What the keypoints of a person show of the hierarchy's joints: positions, lengths of bones, directions of segments.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "canonpose/motion/calm_rotations.h"
#include "canonpose/motion/hierarchy_template.h"
#include "canonpose/scene/pose_sequence.h"

namespace canonpose {

/// The same joint of the limb on the right (side 1), or the left's (side 0).
inline FittedJoint OnSide(FittedJoint left, int side) {
  const int step = left < kFLHip ? kFRClavicle - kFLClavicle : kFRHip - kFLHip;
  return static_cast<FittedJoint>(left + side * step);
}
/// +1 to the left, -1 to the right.
inline double LeftSign(int side) { return side == 0 ? 1.0 : -1.0; }

/// Joints that were seen, and those in between that follow from them.
class BodyMeasures {
 public:
  /// Throws Error(kBadInput) as FitHierarchy() does.
  explicit BodyMeasures(const PoseSequence& person);

  [[nodiscard]] int frame_count() const { return frames_; }
  [[nodiscard]] double stature_mm() const { return stature_mm_; }
  [[nodiscard]] int KeypointOf(int joint) const { return keypoints_[static_cast<std::size_t>(joint)]; }

  /// mm; NaN where it is neither seen nor follows from others.
  [[nodiscard]] const Eigen::Vector3d& At(int frame, int joint) const {
    return positions_[static_cast<std::size_t>(frame) * kFittedJointCount + static_cast<std::size_t>(joint)];
  }
  [[nodiscard]] bool IsKnown(int frame, int joint) const { return At(frame, joint).allFinite(); }
  /// Whether the position is a keypoint's.
  [[nodiscard]] bool IsSeen(int frame, int joint) const { return is_seen_[Index(frame, joint)] != 0; }
  [[nodiscard]] bool IsEverSeen(int joint) const { return is_ever_seen_[static_cast<std::size_t>(joint)]; }

  /// The median distance of two joints over the frames in which both are known; 0 where there are none.
  [[nodiscard]] double MedianDistance(int from, int to) const;

  /// Where a segment points in the world: its axis, and hints of its twist, if the frame shows it. `base` is the
  /// position of the joint where it begins. The axes in the segment's own frame are those of AxisOf().
  [[nodiscard]] Aim AimOf(FittedJoint joint, int frame, const Eigen::Vector3d& base) const;
  /// The axis of the segment that begins at a joint, in the rest pose.
  [[nodiscard]] Eigen::Vector3d AxisOf(FittedJoint joint) const;

  /// The position of `joint` in the frame of the segment that begins at `segment`, from that joint: the median over the
  /// frames that show both. NaN where there are none.
  [[nodiscard]] Eigen::Vector3d MedianInSegment(FittedJoint segment, FittedJoint joint) const;

 private:
  [[nodiscard]] static std::size_t Index(int frame, int joint) {
    return static_cast<std::size_t>(frame) * kFittedJointCount + static_cast<std::size_t>(joint);
  }
  void FindKeypoints(const PoseSequence& person);
  void ReadPositions(const PoseSequence& person);
  void DeriveJoints();
  void EstimateStature(const PoseSequence& person);

  [[nodiscard]] Eigen::Vector3d Between(int frame, int from, int to) const { return At(frame, to) - At(frame, from); }
  [[nodiscard]] Aim AimOfTrunk(FittedJoint joint, int frame, const Eigen::Vector3d& base) const;
  [[nodiscard]] Aim AimOfHead(int frame, const Eigen::Vector3d& base) const;
  [[nodiscard]] Aim AimOfLimb(FittedJoint joint, int frame, const Eigen::Vector3d& base) const;
  [[nodiscard]] Aim AimOfFoot(int side, int frame, const Eigen::Vector3d& base) const;
  [[nodiscard]] Eigen::Vector3d ToeTip(int frame, int side) const;

  enum class HeadKind { kCrown, kSides, kNose, kNothing };
  enum class FootKind { kHeelAndToes, kAnkleAndToes, kNothing };

  int frames_ = 0;
  double stature_mm_ = 0.0;
  std::array<int, kFittedJointCount> keypoints_{};
  std::array<bool, kFittedJointCount> is_ever_seen_{};
  HeadKind head_ = HeadKind::kNothing;
  std::array<FootKind, 2> feet_{FootKind::kNothing, FootKind::kNothing};
  std::vector<Eigen::Vector3d> positions_;  // (T, kFittedJointCount)
  std::vector<char> is_seen_;               // (T, kFittedJointCount)
};

}  // namespace canonpose
