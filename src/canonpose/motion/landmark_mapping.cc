#include "canonpose/motion/landmark_mapping.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/error.h"
#include "canonpose/base/names.h"
#include "canonpose/skeleton/joint_names.h"

namespace canonpose {
namespace {

using Eigen::Vector3d;

// Anthropometry as fractions of the stature: lengths of limbs and heights from Drillis and Contini (in Winter,
// Biomechanics and Motor Control of Human Movement, fig. 4.1), the head from the means of ANSUR II (US Army, 2012).
constexpr double kHipToAnkle = 0.530 - 0.039;
constexpr double kSpineShare = 0.475;    // of the distance from hips to thorax, as in Human3.6M's skeleton
constexpr double kUpperNeckShare = 0.2;  // of the height between thorax and crown, which is below the chin
constexpr double kHeadJointToCrown = 0.11;
/// CMU's head bone ends in the middle of the head's markers, a band around the forehead. Measured on its subjects: with
/// this value, the stature from the legs and the stature from the sum of segments agree.
constexpr double kHeadBandToCrown = 0.035;
struct HeadPoint {
  double down;  // from the crown
  double forward;
  double left;
};
constexpr HeadPoint kNosePoint = {0.089, 0.068, 0.0};
constexpr HeadPoint kEyePoint = {0.064, 0.045, 0.018};
constexpr HeadPoint kEarPoint = {0.075, 0.0, 0.043};
constexpr double kAnkleToBall = 0.075;
constexpr double kBallToToeTip = 0.040;
constexpr double kHeelBehindAnkle = 0.038;
constexpr double kAnkleAboveHeel = 0.037;
constexpr double kAnkleAboveToes = 0.030;
constexpr double kBigToeInside = 0.010;
constexpr double kSmallToeOutside = 0.032;
constexpr double kSmallToeBehindTip = 0.022;

/// A name in lower case, without punctuation, and with its side first: "LeftUpLeg", "upleg.L" and "l_up_leg" all become
/// "lupleg".
std::string PlainName(std::string_view name) {
  std::string side;
  if (name.size() > 2 && std::string_view("._- ").find(name[name.size() - 2]) != std::string_view::npos) {
    const char last = static_cast<char>(std::tolower(static_cast<unsigned char>(name.back())));
    if (last == 'l' || last == 'r') {
      side = last;
      name.remove_suffix(2);
    }
  }
  std::string plain = side;
  for (const char c : LowerCase(name)) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain += c;
  }
  for (const std::string_view word : {"left", "right"}) {
    if (plain.starts_with(word)) return plain.substr(0, 1) + plain.substr(word.size());
  }
  return plain;
}

class JointFinder {
 public:
  explicit JointFinder(const std::vector<MotionJoint>& joints) {
    std::vector<std::string> names;
    names.reserve(joints.size());
    for (const MotionJoint& joint : joints) names.push_back(joint.name);
    names = WithoutPrefix(names);
    for (std::size_t j = 0; j < names.size(); ++j) {
      plain_.emplace(PlainName(names[j]), static_cast<int>(j));
      exact_.emplace(names[j], static_cast<int>(j));
    }
  }
  /// The joint with the first of these names that exists; -1 if none does.
  [[nodiscard]] int Find(std::initializer_list<std::string_view> names, std::string_view side = "") const {
    for (const std::string_view name : names) {
      const auto found = plain_.find(fmt::format("{}{}", side, name));
      if (found != plain_.end()) return found->second;
    }
    return -1;
  }
  /// The joint of exactly this name, apart from a prefix; -1 if there is none.
  [[nodiscard]] int Exactly(const std::string& name) const {
    const auto found = exact_.find(name);
    return found == exact_.end() ? -1 : found->second;
  }

 private:
  std::unordered_map<std::string, int> plain_;
  std::unordered_map<std::string, int> exact_;
};

/// Joints of one side. MotionBuilder's and Mixamo's "LeftShoulder" and "LeftLeg" are the collar bone and the shank, so
/// the names of upper arm and thigh, which these files also have, are tried first. In SMPL's names the foot is the
/// joint after the ankle.
struct Side {
  int hip;
  int knee;
  int ankle;
  int shoulder;
  int elbow;
  int wrist;
  int toe;
};

Side FindSide(const JointFinder& joints, std::string_view side) {
  const auto find = [&](std::initializer_list<std::string_view> names) { return joints.Find(names, side); };
  Side found{};
  found.hip = find({"femur", "upleg", "upperleg", "thigh", "hip"});
  found.knee = find({"tibia", "leg", "lowleg", "lowerleg", "shin", "calf", "shank", "knee"});
  found.ankle = find({"ankle", "foot"});
  found.shoulder = find({"humerus", "arm", "uparm", "upperarm", "shoulder"});
  found.elbow = find({"radius", "forearm", "lowarm", "lowerarm", "elbow"});
  // CMU's bone "wrist" is the lower third of the forearm. The hand begins where that ends, like the thumb; files
  // converted from CMU's call this joint the base of the fingers.
  found.wrist = joints.Find({"radius"}, side) >= 0 ? find({"hand", "wrist"}) : find({"fingerbase", "wrist", "hand"});
  found.toe = find({"toes", "toebase", "toe", "toe0", "ball"});
  if (found.toe < 0 && find({"ankle"}) >= 0) found.toe = find({"foot"});
  return found;
}

/// A landmark as a point of a segment, fixed in the joint's frame and given by its position in the rest pose.
struct Attachment {
  int joint = -1;
  Vector3d rest = Vector3d::Zero();
};

class Mapper {
 public:
  Mapper(const ArticulatedMotion& motion, const std::string& file)
      : joints_(motion.joints), file_(file), finder_(motion.joints), rest_(RestPose(motion)) {}

  std::array<Attachment, kLandmarkCount> Map() {
    FindLimbs();
    FindBodyFrame();
    MapTrunkAndHead();
    MapFoot(left_, kLBigToe, 1.0);
    MapFoot(right_, kRBigToe, -1.0);
    MapByOwnNames();
    return plan_;
  }

 private:
  [[nodiscard]] const Vector3d& Rest(int joint) const { return rest_[static_cast<std::size_t>(joint)]; }
  [[nodiscard]] int Parent(int joint) const { return joints_[static_cast<std::size_t>(joint)].parent; }
  [[nodiscard]] const std::string& Name(int joint) const { return joints_[static_cast<std::size_t>(joint)].name; }
  void AtJoint(Landmark landmark, int joint) { plan_[landmark] = {joint, Rest(joint)}; }

  void FindLimbs() {
    left_ = FindSide(finder_, "l");
    right_ = FindSide(finder_, "r");
    // Our "Head" is the crown, but that of other files is where the head begins. Ours are recognised by their thorax.
    is_ours_ = finder_.Exactly("Thorax") >= 0 && finder_.Exactly("LHip") >= 0 && finder_.Exactly("LWrist") >= 0;
    head_ = is_ours_ ? finder_.Exactly("Head") : finder_.Find({"head", "skull"});
    std::vector<std::string> missing;
    const auto take = [&](Landmark landmark, int joint) {
      if (joint >= 0) {
        AtJoint(landmark, joint);
      } else {
        missing.push_back(LandmarkSkeleton().joints[landmark]);
      }
    };
    take(kRHip, right_.hip);
    take(kRKnee, right_.knee);
    take(kRFoot, right_.ankle);
    take(kLHip, left_.hip);
    take(kLKnee, left_.knee);
    take(kLFoot, left_.ankle);
    take(kLShoulder, left_.shoulder);
    take(kLElbow, left_.elbow);
    take(kLWrist, left_.wrist);
    take(kRShoulder, right_.shoulder);
    take(kRElbow, right_.elbow);
    take(kRWrist, right_.wrist);
    take(kHead, head_);
    if (missing.empty()) return;
    ThrowBadInput({file_, "joints",
                   fmt::format("{} under CMU's, Mixamo's, MotionBuilder's or our names", fmt::join(missing, ", ")),
                   Names(), "rename the joints"});
  }

  [[nodiscard]] std::string Names() const {
    std::string names;
    for (const MotionJoint& joint : joints_) names += (names.empty() ? "" : ", ") + joint.name;
    return names.size() > 200 ? names.substr(0, 200) + "..." : names;
  }

  void FindBodyFrame() {
    stature_ = StatureByLegs(joints_);
    hips_ = (Rest(left_.hip) + Rest(right_.hip)) / 2.0;
    const Vector3d up = Rest(head_) - hips_;
    const Vector3d left = Rest(left_.hip) - Rest(right_.hip);
    if (stature_ <= 0.0 || up.norm() < 0.1 * stature_ || left.cross(up).norm() < 0.02 * stature_ * up.norm()) {
      ThrowBadInput({file_, "rest pose", "a person with legs, hips apart and the head above them", "none",
                     "export it with the skeleton's offsets"});
    }
    up_ = up.normalized();
    left_axis_ = (left - left.dot(up_) * up_).normalized();
    forward_ = left_axis_.cross(up_);
  }

  [[nodiscard]] std::vector<int> WayFromRoot(int joint) const {
    std::vector<int> way;
    for (int j = joint; j >= 0; j = Parent(j)) way.push_back(j);
    std::reverse(way.begin(), way.end());
    return way;
  }

  /// The last joint on the paths from the root to both.
  [[nodiscard]] int CommonAncestor(int a, int b) const {
    const std::vector<int> way_a = WayFromRoot(a);
    const std::vector<int> way_b = WayFromRoot(b);
    const auto end = std::mismatch(way_a.begin(), way_a.end(), way_b.begin(), way_b.end()).first;
    return *(end - 1);
  }

  [[nodiscard]] double Height(const Vector3d& point) const { return (point - hips_).dot(up_); }

  /// The point of the spine at a height above the hips, attached to its segment.
  [[nodiscard]] Attachment OnSpine(double height) const {
    for (std::size_t i = 0; i + 1 < spine_.size(); ++i) {
      const double low = Height(spine_[i].rest);
      const double high = Height(spine_[i + 1].rest);
      if (height > high || high <= low) continue;
      const double share = std::clamp((height - low) / (high - low), 0.0, 1.0);
      return {spine_[i].joint, spine_[i].rest + share * (spine_[i + 1].rest - spine_[i].rest)};
    }
    return spine_.back();
  }

  void MapTrunkAndHead() {
    AtJoint(kHip, CommonAncestor(left_.hip, right_.hip));
    plan_[kHip].rest = hips_;
    const int chest = CommonAncestor(left_.shoulder, right_.shoulder);
    MapCrown();
    // The spine goes from the hips through the joints up to the head, as far as each lies above the last, to the crown.
    spine_ = {plan_[kHip]};
    for (const int joint : WayFromRoot(skull_)) {
      if (Height(Rest(joint)) > Height(spine_.back().rest) + 1e-6) {
        spine_.push_back({joint, Rest(joint)});
      } else if (joint != spine_.back().joint) {
        spine_.back().joint = joint;
      }
    }
    spine_.push_back(plan_[kHead]);
    const double shoulders = Height((Rest(left_.shoulder) + Rest(right_.shoulder)) / 2.0);
    const double crown = Height(plan_[kHead].rest);
    plan_[kThorax] = OnSpine(shoulders);
    plan_[kThorax].joint = chest;  // when the neck turns, the shoulders do not turn with it
    plan_[kSpine] = OnSpine(kSpineShare * shoulders);
    plan_[kUpperNeck] = OnSpine(shoulders + kUpperNeckShare * (crown - shoulders));
    OnHead(kNose, kNosePoint, 0.0);
    OnHead(kLEye, kEyePoint, 1.0);
    OnHead(kREye, kEyePoint, -1.0);
    OnHead(kLEar, kEarPoint, 1.0);
    OnHead(kREar, kEarPoint, -1.0);
  }

  /// The head has the frame of the joint where it begins; the crown is at its end.
  void MapCrown() {
    skull_ = head_;
    if (is_ours_) {
      if (Parent(head_) >= 0) skull_ = Parent(head_);
      plan_[kHead] = {skull_, Rest(head_)};
      return;
    }
    const int end = finder_.Find({"headend", "headtopend", "headtop", "headnub", "headsite"});
    const double length = end >= 0 ? (Rest(end) - Rest(head_)).norm() : 0.0;
    const bool is_cmu = finder_.Find({"lhipjoint"}) >= 0 && finder_.Find({"lowerback"}) >= 0;
    if (end >= 0 && is_cmu && length > 0.0) {
      plan_[kHead] = {head_, Rest(end) + kHeadBandToCrown * stature_ * (Rest(end) - Rest(head_)) / length};
    } else if (length > 0.07 * stature_ && length < 0.2 * stature_) {
      plan_[kHead] = {head_, Rest(end)};
    } else {
      plan_[kHead] = {head_, Rest(head_) + kHeadJointToCrown * stature_ * up_};
    }
  }

  void OnHead(Landmark landmark, const HeadPoint& point, double left) {
    const Vector3d from_crown = -point.down * up_ + point.forward * forward_ + left * point.left * left_axis_;
    plan_[landmark] = {skull_, plan_[kHead].rest + stature_ * from_crown};
  }

  /// Big toe, small toe and heel, in this order from `big_toe`. In the rest pose the sole is at right angles to the
  /// shank, whether the legs are together or, as in CMU's files, apart.
  void MapFoot(const Side& side, Landmark big_toe, double left) {
    const Vector3d ankle = Rest(side.ankle);
    const Vector3d up = (Rest(side.knee) - ankle).normalized();
    const auto along_sole = [&](const Vector3d& v) { return Vector3d(v - v.dot(up) * up); };
    // Without a joint at the ball of the foot, the end of the foot may show where it points to.
    const int end = FindEnd(side.toe >= 0 ? side.toe : side.ankle);
    Vector3d forward = along_sole(forward_);
    if (side.toe >= 0) {
      forward = along_sole(Rest(side.toe) - ankle);
    } else if (end >= 0 && along_sole(Rest(end) - ankle).norm() > 0.04 * stature_) {
      forward = along_sole(Rest(end) - ankle);
    }
    forward.normalize();
    const Vector3d outside = left * up.cross(forward);
    double to_ball = kAnkleToBall * stature_;
    if (side.toe >= 0) to_ball = (Rest(side.toe) - ankle).dot(forward);
    double to_tip = to_ball + kBallToToeTip * stature_;
    if (side.toe >= 0 && end >= 0) {
      const double length = (Rest(end) - Rest(side.toe)).dot(forward);
      if (length > 0.02 * stature_ && length < 0.08 * stature_) to_tip = to_ball + length;
    }
    const int toes = side.toe >= 0 ? side.toe : side.ankle;
    const auto point = [&](double ahead, double out, double below) {
      return Vector3d(ankle + ahead * forward + stature_ * (out * outside - below * up));
    };
    plan_[big_toe] = {toes, point(to_tip, -kBigToeInside, kAnkleAboveToes)};
    plan_[big_toe + 1] = {toes, point(to_tip - kSmallToeBehindTip * stature_, kSmallToeOutside, kAnkleAboveToes)};
    plan_[big_toe + 2] = {side.ankle, point(-kHeelBehindAnkle * stature_, 0.0, kAnkleAboveHeel)};
  }

  /// The only child of a joint; -1 if it has none or several.
  [[nodiscard]] int FindEnd(int joint) const {
    int end = -1;
    for (int j = 0; j < static_cast<int>(joints_.size()); ++j) {
      if (Parent(j) != joint) continue;
      if (end >= 0) return -1;
      end = j;
    }
    return end;
  }

  /// Joints with names of landmarks are these landmarks; in files of other origin, only those names that are
  /// unambiguous.
  void MapByOwnNames() {
    for (int landmark = 0; landmark < kLandmarkCount; ++landmark) {
      const int joint = finder_.Exactly(LandmarkSkeleton().joints[static_cast<std::size_t>(landmark)]);
      const bool is_plain = landmark == kNose || (landmark >= kREye && landmark != kUpperNeck);
      // Our own pelvis may rotate about a point that is not between the hips.
      if (joint >= 0 && landmark != kHip && (is_ours_ || is_plain)) AtJoint(static_cast<Landmark>(landmark), joint);
    }
  }

  const std::vector<MotionJoint>& joints_;
  const std::string& file_;
  JointFinder finder_;
  std::vector<Vector3d> rest_;
  std::array<Attachment, kLandmarkCount> plan_;
  Side left_{};
  Side right_{};
  bool is_ours_ = false;
  int head_ = -1;
  int skull_ = -1;  // whose frame the face is in
  double stature_ = 0.0;
  Vector3d hips_ = Vector3d::Zero();
  Vector3d up_ = Vector3d::UnitZ();
  Vector3d left_axis_ = Vector3d::UnitX();
  Vector3d forward_ = -Vector3d::UnitY();
  std::vector<Attachment> spine_;  // each point in the segment that begins at it
};

}  // namespace

double StatureByLegs(const std::vector<MotionJoint>& joints) {
  const JointFinder finder(joints);
  ArticulatedMotion motion;
  motion.joints = joints;
  const std::vector<Vector3d> rest = RestPose(motion);
  double length = 0.0;
  for (const char* name : {"l", "r"}) {
    const Side side = FindSide(finder, name);
    if (side.hip < 0 || side.knee < 0 || side.ankle < 0) return 0.0;
    const auto at = [&](int joint) { return rest[static_cast<std::size_t>(joint)]; };
    length += ((at(side.hip) - at(side.knee)).norm() + (at(side.knee) - at(side.ankle)).norm()) / 2.0;
  }
  return length / kHipToAnkle;
}

std::optional<UprightJoints> FindUprightJoints(const std::vector<MotionJoint>& joints) {
  const JointFinder finder(joints);
  const UprightJoints found = {finder.Find({"head", "skull"}), FindSide(finder, "l").ankle,
                               FindSide(finder, "r").ankle};
  if (found.head < 0 || found.left_ankle < 0 || found.right_ankle < 0) return std::nullopt;
  return found;
}

LandmarkTrack MakeLandmarkTrack(const ArticulatedMotion& motion, const std::string& file) {
  if (motion.joints.empty()) ThrowBadInput({file, "joints", "the joints of a body", "none", ""});
  const std::array<Attachment, kLandmarkCount> plan = Mapper(motion, file).Map();
  const std::vector<Vector3d> rest = RestPose(motion);
  LandmarkTrack track;
  track.name = motion.name;
  track.subject = motion.subject;
  track.fps = motion.fps;
  track.positions_mm.reserve(static_cast<std::size_t>(motion.frame_count()) * kLandmarkCount);
  std::vector<Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  for (int t = 0; t < motion.frame_count(); ++t) {
    ForwardKinematics(motion, t, positions, rotations);
    for (const Attachment& point : plan) {
      const auto joint = static_cast<std::size_t>(point.joint);
      track.positions_mm.push_back(positions[joint] + rotations[joint] * (point.rest - rest[joint]));
    }
  }
  return track;
}

}  // namespace canonpose
