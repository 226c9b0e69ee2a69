#include "canonpose/motion/hierarchy_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"
#include "canonpose/motion/body_measures.h"
#include "canonpose/motion/calm_rotations.h"
#include "canonpose/motion/refine_positions.h"

namespace canonpose {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kUsualFps = 30.0;
/// Certain evidence of a twist is averaged over about this time.
constexpr double kCalmSeconds = 0.05;
/// Well below the length of a limb.
constexpr double kResistanceMm = 30.0;
/// A spine that no keypoint shows must not fold, first to this side and then to that, because a trunk that bends is
/// shorter than its median length.
constexpr double kStiffMm = 300.0;
// Joints that follow from others guide the refinement, but do not compete with those that were seen.
constexpr double kWeightOfDerivedThorax = 0.05;
constexpr double kWeightOfDerivedJoint = 0.02;

// Where articulations without keypoints lie, as shares of the bone they divide, and unseen parts as shares of the
// stature (Drillis and Contini in Winter, Biomechanics and Motor Control of Human Movement; ANSUR II for the head).
constexpr double kLumbarShare = 0.25;
constexpr double kChestShare = 0.5;
constexpr double kClavicleShare = 0.15;
constexpr double kBallShare = 0.65;
constexpr double kTrunkShare = 0.288;
constexpr double kSkullAboveThorax = 0.082;
constexpr double kCrownAboveSkull = 0.1;
constexpr double kHandLength = 0.1;
constexpr double kHalfShoulders = 0.104;
constexpr double kHalfHips = 0.05;
constexpr double kBallBeforeAnkle = 0.075;
constexpr double kTipBeforeBall = 0.04;
constexpr double kToesBelowAnkle = 0.03;

/// Offsets of the joints from their parents in the rest pose.
class RestBuilder {
 public:
  explicit RestBuilder(const BodyMeasures& body) : body_(body), stature_(body.stature_mm()) {
    offsets_.fill(Vector3d::Zero());
    AddTrunk();
    AddHead();
    for (int side = 0; side < 2; ++side) {
      AddArm(side);
      AddLeg(side);
      AddFoot(side);
    }
  }

  [[nodiscard]] const std::array<Vector3d, kFittedJointCount>& offsets() const { return offsets_; }

 private:
  [[nodiscard]] Vector3d Seen(FittedJoint segment, FittedJoint joint, const Vector3d& otherwise) const {
    const Vector3d median = body_.MedianInSegment(segment, joint);
    return median.allFinite() ? median : otherwise;
  }
  /// The bone's own length, the other side's, or an average body's.
  [[nodiscard]] double Length(FittedJoint from, FittedJoint to, double share) const {
    const double length = body_.MedianDistance(from, to);
    return length > 0.0 ? length : share * stature_;
  }
  [[nodiscard]] double LimbLength(FittedJoint from, FittedJoint to, int side, double share) const {
    const double other = body_.MedianDistance(OnSide(from, 1 - side), OnSide(to, 1 - side));
    return Length(OnSide(from, side), OnSide(to, side), other > 0.0 ? other / stature_ : share);
  }

  void AddTrunk() {
    const double lower = Length(kFHip, kFSpine, 0.475 * kTrunkShare);
    const double upper = Length(kFSpine, kFThorax, 0.525 * kTrunkShare);
    offsets_[kFLumbar].z() = kLumbarShare * lower;
    offsets_[kFSpine].z() = (1.0 - kLumbarShare) * lower;
    offsets_[kFChest].z() = kChestShare * upper;
    offsets_[kFThorax].z() = (1.0 - kChestShare) * upper;
    offsets_[kFSkull].z() = Length(kFThorax, kFSkull, kSkullAboveThorax);
  }

  void AddHead() {
    for (const FittedJoint joint : {kFNose, kFLEye, kFREye, kFLEar, kFREar})
      offsets_[joint] = Seen(kFSkull, joint, Vector3d::Zero());
    Vector3d crown(0.0, 0.0, kCrownAboveSkull * stature_);
    // In the frame of the head: x left, -y forward.
    if (body_.IsEverSeen(kFLEar) && body_.IsEverSeen(kFREar)) {
      crown = 0.5 * (offsets_[kFLEar] + offsets_[kFREar]) + stature_ * Vector3d(0.0, 0.0, 0.075);
    } else if (body_.IsEverSeen(kFLEye) && body_.IsEverSeen(kFREye)) {
      crown = 0.5 * (offsets_[kFLEye] + offsets_[kFREye]) + stature_ * Vector3d(0.0, 0.045, 0.064);
    } else if (body_.IsEverSeen(kFNose)) {
      crown = offsets_[kFNose] + stature_ * Vector3d(0.0, 0.068, 0.089);
    }
    offsets_[kFCrown] = body_.IsEverSeen(kFCrown) ? Seen(kFSkull, kFCrown, crown) : crown;
  }

  void AddArm(int side) {
    const FittedJoint shoulder = OnSide(kFLShoulder, side);
    const Vector3d out = LeftSign(side) * Vector3d::UnitX();
    const Vector3d from_thorax = Seen(kFChest, shoulder, kHalfShoulders * stature_ * out);
    offsets_[OnSide(kFLClavicle, side)] = offsets_[kFThorax] + kClavicleShare * from_thorax;
    offsets_[shoulder] = (1.0 - kClavicleShare) * from_thorax;
    offsets_[OnSide(kFLElbow, side)] = LimbLength(kFLShoulder, kFLElbow, side, 0.186) * out;
    offsets_[OnSide(kFLWrist, side)] = LimbLength(kFLElbow, kFLWrist, side, 0.146) * out;
    offsets_[OnSide(kFLHandEnd, side)] = kHandLength * stature_ * out;
  }

  void AddLeg(int side) {
    const FittedJoint hip = OnSide(kFLHip, side);
    offsets_[hip] = Seen(kFHip, hip, kHalfHips * stature_ * LeftSign(side) * Vector3d::UnitX());
    offsets_[OnSide(kFLKnee, side)].z() = -LimbLength(kFLHip, kFLKnee, side, 0.245);
    offsets_[OnSide(kFLAnkle, side)].z() = -LimbLength(kFLKnee, kFLAnkle, side, 0.246);
  }

  void AddFoot(int side) {
    const FittedJoint ankle = OnSide(kFLAnkle, side);
    const FittedJoint toes = OnSide(kFLToes, side);
    const FittedJoint big = OnSide(kFLBigToe, side);
    const FittedJoint small = OnSide(kFLSmallToe, side);
    if (!body_.IsEverSeen(big) || !body_.IsEverSeen(ankle)) {
      offsets_[toes] = stature_ * Vector3d(0.0, -kBallBeforeAnkle, -kToesBelowAnkle);
      offsets_[big] = stature_ * Vector3d(0.0, -kTipBeforeBall, 0.0);
      return;
    }
    const Vector3d usual = stature_ * Vector3d(0.0, -kBallBeforeAnkle - kTipBeforeBall, -kToesBelowAnkle);
    const Vector3d big_from_ankle = Seen(ankle, big, usual);
    const Vector3d small_from_ankle = Seen(ankle, small, big_from_ankle);
    const Vector3d tip = 0.5 * (big_from_ankle + small_from_ankle);
    offsets_[toes] = {kBallShare * tip.x(), kBallShare * tip.y(), tip.z()};
    offsets_[big] = big_from_ankle - offsets_[toes];
    offsets_[small] = small_from_ankle - offsets_[toes];
    offsets_[OnSide(kFLHeel, side)] = Seen(ankle, OnSide(kFLHeel, side), Vector3d::Zero());
  }

  const BodyMeasures& body_;
  double stature_;
  std::array<Vector3d, kFittedJointCount> offsets_;
};

double FrameRate(const PoseSequence& person) {
  if (person.fps > 0.0) return person.fps;
  const std::vector<double>& times = person.time_seconds;
  if (times.size() < 2 || times.back() <= times.front()) return 0.0;
  return static_cast<double>(times.size() - 1) / (times.back() - times.front());
}

/// The whole template, with the rotations that follow trunk and limbs from the root outwards.
class RotationFitter {
 public:
  RotationFitter(const BodyMeasures& body, const PoseSequence& person) : body_(body), frames_(body.frame_count()) {
    const RestBuilder rest(body);
    motion_.name = motion_.subject = person.name;
    motion_.fps = FrameRate(person);
    for (std::size_t j = 0; j < kFittedJointCount; ++j) {
      const TemplateJoint& row = HierarchyTemplate()[j];
      motion_.joints.push_back({row.ours, row.parent, rest.offsets()[j]});
    }
    motion_.parent_from_joint.assign(static_cast<std::size_t>(frames_) * kFittedJointCount, Quaterniond::Identity());
    const double fps = motion_.fps > 0.0 ? motion_.fps : kUsualFps;
    calm_ = (kCalmSeconds * fps) * (kCalmSeconds * fps);
  }

  ArticulatedMotion Fit() {
    PlaceRoot();
    positions_.resize(static_cast<std::size_t>(frames_) * kFittedJointCount);
    rotations_.resize(positions_.size());
    for (int j = 0; j < kFittedJointCount; ++j) FitJoint(static_cast<FittedJoint>(j));
    Refine();
    MeasureRigidPoints();
    Refine();
    return std::move(motion_);
  }

 private:
  [[nodiscard]] static std::size_t Index(int frame, int joint) {
    return static_cast<std::size_t>(frame) * kFittedJointCount + static_cast<std::size_t>(joint);
  }

  /// Interpolates where the pelvis is unknown, and holds the first and the last known position.
  void PlaceRoot() {
    motion_.root_position_mm.assign(static_cast<std::size_t>(frames_), Vector3d::Zero());
    int before = -1;
    for (int t = 0; t < frames_; ++t) {
      if (!body_.IsKnown(t, kFHip)) continue;
      for (int gap = before + 1; gap <= t; ++gap) {
        const double share = before < 0 ? 1.0 : static_cast<double>(gap - before) / (t - before);
        const Vector3d& from = body_.At(before < 0 ? t : before, kFHip);
        motion_.root_position_mm[static_cast<std::size_t>(gap)] = from + share * (body_.At(t, kFHip) - from);
      }
      before = t;
    }
    for (int t = before + 1; t < frames_ && before >= 0; ++t)
      motion_.root_position_mm[static_cast<std::size_t>(t)] = body_.At(before, kFHip);
  }

  /// The axis of a joint's own frame that its aim is the direction of.
  [[nodiscard]] Vector3d AxisOf(FittedJoint joint) const {
    const bool is_clavicle = joint == kFLClavicle || joint == kFRClavicle;
    return is_clavicle ? motion_.joints[static_cast<std::size_t>(joint) + 1].offset_mm.normalized()
                       : body_.AxisOf(joint);
  }

  void FitJoint(FittedJoint joint) {
    const int parent = HierarchyTemplate()[joint].parent;
    std::vector<Aim> aims(static_cast<std::size_t>(frames_));
    for (int t = 0; t < frames_; ++t) {
      Vector3d& position = positions_[Index(t, joint)];
      position = motion_.root_position_mm[static_cast<std::size_t>(t)];
      if (parent >= 0) {
        position = positions_[Index(t, parent)] +
                   rotations_[Index(t, parent)] * motion_.joints[static_cast<std::size_t>(joint)].offset_mm;
      }
      if (HierarchyTemplate()[joint].rotates) {
        aims[static_cast<std::size_t>(t)] = InParent(body_.AimOf(joint, t, position), t, parent);
      }
    }
    const bool is_shown = std::any_of(aims.begin(), aims.end(), [](const Aim& aim) { return aim.is_known; });
    const bool is_spine = joint == kFLumbar || joint == kFSpine || joint == kFChest;
    const bool is_stiff = is_spine && !body_.IsEverSeen(kFSpine);
    resistance_mm_.push_back(!is_shown ? 0.0 : is_stiff ? kStiffMm : kResistanceMm);
    const std::vector<Quaterniond> locals = CalmRotations(AxisOf(joint), aims, calm_);
    for (int t = 0; t < frames_; ++t) {
      const Quaterniond& local = locals[static_cast<std::size_t>(t)];
      motion_.parent_from_joint[Index(t, joint)] = local;
      rotations_[Index(t, joint)] = parent < 0 ? local : rotations_[Index(t, parent)] * local;
    }
  }

  [[nodiscard]] Aim InParent(Aim aim, int frame, int parent) const {
    if (parent < 0) return aim;
    const Quaterniond parent_from_world = rotations_[Index(frame, parent)].conjugate();
    aim.direction = parent_from_world * aim.direction;
    for (TwistHint& hint : aim.hints) hint.in_parent = parent_from_world * hint.in_parent;
    return aim;
  }

  /// Points that are fixed to pelvis, skull and feet were measured in frames made of single keypoints; the refined
  /// frames are better.
  void MeasureRigidPoints() {
    for (int t = 0; t < frames_; ++t) {
      ForwardKinematics(motion_, t, frame_positions_, frame_rotations_);
      std::copy(frame_positions_.begin(), frame_positions_.end(), &positions_[Index(t, 0)]);
      std::copy(frame_rotations_.begin(), frame_rotations_.end(), &rotations_[Index(t, 0)]);
    }
    for (const FittedJoint joint : {kFCrown, kFNose, kFLEye, kFREye, kFLEar, kFREar, kFLHip, kFRHip, kFLHeel, kFRHeel,
                                    kFLBigToe, kFRBigToe, kFLSmallToe, kFRSmallToe}) {
      const int parent = HierarchyTemplate()[joint].parent;
      std::array<std::vector<double>, 3> values;
      for (int t = 0; t < frames_; ++t) {
        if (!body_.IsSeen(t, joint)) continue;
        const Vector3d local =
            rotations_[Index(t, parent)].conjugate() * (body_.At(t, joint) - positions_[Index(t, parent)]);
        for (std::size_t axis = 0; axis < 3; ++axis) values[axis].push_back(local[static_cast<Eigen::Index>(axis)]);
      }
      if (values[0].empty()) continue;
      motion_.joints[static_cast<std::size_t>(joint)].offset_mm = {Median(values[0]), Median(values[1]),
                                                                   Median(values[2])};
    }
  }

  void Refine() {
    SeenJoints seen;
    seen.positions_mm.resize(positions_.size());
    seen.weights.assign(positions_.size(), 0.0);
    for (int t = 0; t < frames_; ++t) {
      // Where the pelvis is unknown, it must not leave its interpolated position for the sake of, say, a single wrist.
      seen.positions_mm[Index(t, kFHip)] = motion_.root_position_mm[static_cast<std::size_t>(t)];
      seen.weights[Index(t, kFHip)] = 1.0;
      for (int j = 0; j < kFittedJointCount; ++j) {
        if (!body_.IsKnown(t, j)) continue;
        double weight = 0.0;
        if (body_.IsSeen(t, j)) {
          weight = 1.0;
        } else if (j != kFHip) {
          weight = j == kFThorax ? kWeightOfDerivedThorax : kWeightOfDerivedJoint;
        }
        seen.positions_mm[Index(t, j)] = body_.At(t, j);
        seen.weights[Index(t, j)] = weight;
      }
    }
    RefinePositions(motion_, resistance_mm_, seen);
  }

  const BodyMeasures& body_;
  int frames_;
  double calm_ = 0.0;
  ArticulatedMotion motion_;
  std::vector<Vector3d> positions_;     // (T, J) world
  std::vector<Quaterniond> rotations_;  // (T, J) world_from_joint
  std::vector<double> resistance_mm_;   // (J)
  std::vector<Vector3d> frame_positions_;
  std::vector<Quaterniond> frame_rotations_;
};

/// Without the joints that `names` lacks or that were not seen, all of which are leaves.
void KeepJoints(const BodyMeasures& body, JointNames names, HierarchyFit& fit) {
  const std::array<TemplateJoint, kFittedJointCount>& rows = HierarchyTemplate();
  std::vector<std::size_t> kept;
  std::array<int, kFittedJointCount> index{};
  for (std::size_t j = 0; j < kFittedJointCount; ++j) {
    index[j] = -1;
    if (rows[j].only_if_seen && !body.IsEverSeen(static_cast<int>(j))) continue;
    if (names == JointNames::kMixamo && rows[j].mixamo[0] == '\0') continue;
    index[j] = static_cast<int>(kept.size());
    kept.push_back(j);
  }
  ArticulatedMotion& motion = fit.motion;
  std::vector<MotionJoint> joints;
  for (const std::size_t j : kept) {
    const int parent = rows[j].parent;
    joints.push_back({NameOf(static_cast<FittedJoint>(j), names),
                      parent < 0 ? -1 : index[static_cast<std::size_t>(parent)], motion.joints[j].offset_mm});
    fit.roles.push_back(static_cast<FittedJoint>(j));
    fit.keypoints.push_back(body.KeypointOf(static_cast<int>(j)));
  }
  std::vector<Quaterniond> rotations;
  rotations.reserve(kept.size() * motion.root_position_mm.size());
  for (std::size_t t = 0; t < motion.root_position_mm.size(); ++t) {
    for (const std::size_t j : kept) rotations.push_back(motion.parent_from_joint[t * kFittedJointCount + j]);
  }
  motion.joints = std::move(joints);
  motion.parent_from_joint = std::move(rotations);
}

void Measure(const PoseSequence& person, HierarchyFit& fit) {
  std::vector<Vector3d> positions;
  std::vector<Quaterniond> rotations;
  double sum = 0.0;
  int count = 0;
  for (int t = 0; t < person.frame_count(); ++t) {
    ForwardKinematics(fit.motion, t, positions, rotations);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      if (fit.keypoints[j] < 0 || !person.IsKnown(t, fit.keypoints[j])) continue;
      const Vector3d seen = person.PoseAt(t).row(fit.keypoints[j]).transpose().cast<double>();
      const double error = (positions[j] - seen).norm();
      sum += error;
      ++count;
      if (error <= fit.largest_error_mm) continue;
      fit.largest_error_mm = error;
      fit.worst_joint = fit.motion.joints[j].name;
      fit.worst_frame = t;
    }
  }
  if (count > 0) fit.mean_error_mm = sum / count;
}

void FindUnseen(const PoseSequence& person, HierarchyFit& fit) {
  for (std::size_t j = 0; j < fit.keypoints.size(); ++j) {
    const int keypoint = fit.keypoints[j];
    const std::string& name = fit.motion.joints[j].name;
    std::vector<UnseenFrames> unseen;
    for (int t = 0; t < person.frame_count() && keypoint >= 0; ++t) {
      if (person.IsKnown(t, keypoint)) continue;
      if (unseen.empty() || unseen.back().last != t - 1) unseen.push_back({name, t, t});
      unseen.back().last = t;
    }
    const bool never = unseen.size() == 1 && unseen[0].first == 0 && unseen[0].last == person.frame_count() - 1;
    if (never) {
      fit.never_seen.push_back(name);
    } else {
      fit.unseen.insert(fit.unseen.end(), unseen.begin(), unseen.end());
    }
  }
}

}  // namespace

HierarchyFit FitHierarchy(const PoseSequence& person, JointNames names) {
  CANONPOSE_CHECK(person.unit == LengthUnit::kMillimetres, "the poses' unit is {}", ToString(person.unit));
  const BodyMeasures body(person);
  HierarchyFit fit;
  fit.stature_mm = body.stature_mm();
  fit.motion = RotationFitter(body, person).Fit();
  KeepJoints(body, names, fit);
  Measure(person, fit);
  FindUnseen(person, fit);
  return fit;
}

}  // namespace canonpose
