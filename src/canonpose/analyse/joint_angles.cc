#include "canonpose/analyse/joint_angles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "canonpose/geometry/angles.h"

namespace canonpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kPi = std::numbers::pi;
/// No hip turns its limb further about itself: the knee seems to bend the wrong way.
constexpr double kLargestRotation = RadFromDeg(120.0);
/// Far beyond what shoulders can, so that an arm seldom changes from one description to the other in mid-air: an arm at
/// the limits of its movements reaches 130 in either.
constexpr double kLargestArmRotation = RadFromDeg(150.0);
constexpr double kDecidingElbow = RadFromDeg(30.0);

double Wrapped(double angle) { return std::remainder(angle, 2.0 * kPi); }

/// The angle plus a multiple of 2 pi that is nearest to another one, if that is known.
double Near(double angle, double other) {
  return std::isfinite(other) ? other + Wrapped(angle - other) : Wrapped(angle);
}

JointRotation Near(const JointRotation& rotation, const JointRotation& other) {
  return {Near(rotation.flexion, other.flexion), Near(rotation.adduction, other.adduction),
          Near(rotation.rotation, other.rotation)};
}

double Distance(const JointRotation& a, const JointRotation& b) {
  const auto distance = [](double x, double y) { return std::isfinite(x - y) ? std::abs(x - y) : 0.0; };
  return distance(a.flexion, b.flexion) + distance(a.rotation, b.rotation);
}

/// Our world to one with x forward, y up and z to the right for who faces along x.
const Matrix3d& YUpFromWorld() {
  static const Matrix3d rotation = (Matrix3d() << 1, 0, 0, 0, 0, 1, 0, -1, 0).finished();
  return rotation;
}

/// Rotation about the vertical first, so that the other two do not depend on where the person faces (Baker 2001).
struct Orientation {
  double tilt = 0.0;
  double list = 0.0;
  double rotation = 0.0;
};

Orientation OrientationOf(const Matrix3d& segment) {
  const Matrix3d r = YUpFromWorld() * segment;
  const double list = std::asin(std::clamp(-r(1, 2), -1.0, 1.0));
  if (std::cos(list) < std::sin(RadFromDeg(kSmallestAngleDeg))) return {kNaN, list, kNaN};
  return {std::atan2(r(1, 0), r(1, 1)), list, std::atan2(r(0, 2), r(2, 2))};
}

/// Collects series that have a value for every frame.
class AngleTable {
 public:
  AngleTable(const PoseSequence& person, const BodyJoints& joints) {
    for (int frame = 0; frame < person.frame_count(); ++frame) segments_.push_back(SegmentsAt(person, joints, frame));
  }

  void Add(const std::string& name, const std::function<double(const Segments&)>& radians) {
    std::vector<double> values;
    for (const Segments& segments : segments_) values.push_back(DegFromRad(radians(segments)));
    Unwrap(values);
    series_.push_back({name, "deg", std::move(values)});
  }

  /// Flexion, adduction and rotation; those without a name are left out.
  void Add(const std::array<std::string, 3>& names, const std::vector<JointRotation>& rotations,
           bool is_continuous = false) {
    const auto add = [&](std::size_t which, double JointRotation::*angle) {
      if (names.at(which).empty()) return;
      std::vector<double> values;
      for (const JointRotation& rotation : rotations) values.push_back(DegFromRad(rotation.*angle));
      if (!is_continuous) Unwrap(values);
      series_.push_back({names.at(which), "deg", std::move(values)});
    };
    add(0, &JointRotation::flexion);
    add(1, &JointRotation::adduction);
    add(2, &JointRotation::rotation);
  }

  [[nodiscard]] std::vector<JointRotation> Rotations(
      const std::function<JointRotation(const Segments&)>& rotation) const {
    std::vector<JointRotation> rotations;
    for (const Segments& segments : segments_) rotations.push_back(rotation(segments));
    return rotations;
  }

  void AddOrientation(const std::string& prefix, Matrix3d Segments::*segment) {
    Add(prefix + "_tilt", [&](const Segments& s) { return OrientationOf(s.*segment).tilt; });
    Add(prefix + "_list", [&](const Segments& s) { return OrientationOf(s.*segment).list; });
    Add(prefix + "_rotation", [&](const Segments& s) { return OrientationOf(s.*segment).rotation; });
  }

  [[nodiscard]] const std::vector<Segments>& segments() const { return segments_; }
  std::vector<TimeSeries> Take() { return std::move(series_); }

 private:
  std::vector<Segments> segments_;
  std::vector<TimeSeries> series_;
};

void AddLeg(AngleTable& table, const BodyJoints& joints, Side side) {
  const LimbJoints& limbs = joints.Of(side);
  const bool is_left = side == Side::kLeft;
  const std::string end = std::string("_") + Suffix(side);
  const bool has_pelvis = joints.has_hips() && (joints.spine >= 0 || joints.has_trunk());
  if (has_pelvis && limbs.knee >= 0) {
    std::vector<JointRotation> hip =
        table.Rotations([&](const Segments& s) { return RotationBetween(s.pelvis, s.Of(side).thigh, is_left); });
    HideWherePolesCoincide(hip);
    for (JointRotation& rotation : hip) {
      if (std::abs(rotation.rotation) > kLargestRotation) rotation.rotation = kNaN;
    }
    table.Add({"hip_flexion" + end, "hip_adduction" + end, limbs.ankle >= 0 ? "hip_rotation" + end : ""}, hip);
  }
  if (limbs.knee < 0 || limbs.ankle < 0) return;
  if (limbs.hip >= 0) {
    table.Add("knee_angle" + end,
              [&](const Segments& s) { return AngleBetween(s.Of(side).thigh.col(1), s.Of(side).shank.col(1)); });
  }
  if (limbs.big_toe < 0) return;
  table.Add("ankle_angle" + end, [&](const Segments& s) {
    return kPi / 2.0 - AngleBetween(s.Of(side).foot.col(0), s.Of(side).shank.col(1));
  });
  if (limbs.hip < 0 || limbs.heel < 0 || limbs.small_toe < 0) return;
  std::vector<JointRotation> ankle =
      table.Rotations([&](const Segments& s) { return RotationBetween(s.Of(side).shank, s.Of(side).foot, is_left); });
  HideWherePolesCoincide(ankle);
  table.Add({"", "ankle_inversion" + end, "ankle_rotation" + end}, ankle);
}

/// The plane in which the arm is lifted: 0 to the side, 90 degrees to the front.
double ElevationPlane(const Segments& s, Side side) {
  const Vector3d arm = -(s.trunk.transpose() * s.Of(side).upper_arm.col(1));
  if (std::hypot(arm.x(), arm.z()) < std::sin(RadFromDeg(kSmallestAngleDeg))) return kNaN;
  return std::atan2(arm.x(), side == Side::kLeft ? -arm.z() : arm.z());
}

void AddArm(AngleTable& table, const BodyJoints& joints, Side side) {
  const LimbJoints& limbs = joints.Of(side);
  const std::string end = std::string("_") + Suffix(side);
  if (limbs.shoulder < 0 || limbs.elbow < 0) return;
  const auto elbow = [&](const Segments& s) { return AngleBetween(s.Of(side).upper_arm.col(1), s.Of(side).forearm); };
  if (joints.has_trunk()) {
    std::vector<JointRotation> arm = table.Rotations(
        [&](const Segments& s) { return RotationBetween(s.trunk, s.Of(side).upper_arm, side == Side::kLeft); });
    std::vector<double> elbow_rad;
    for (const Segments& s : table.segments()) elbow_rad.push_back(elbow(s));
    FollowArm(arm, elbow_rad);
    HideWherePolesCoincide(arm);
    table.Add({"arm_flex" + end, "arm_add" + end, limbs.wrist >= 0 ? "arm_rot" + end : ""}, arm, true);
    table.Add("shoulder_elv" + end,
              [&](const Segments& s) { return AngleBetween(s.trunk.col(1), s.Of(side).upper_arm.col(1)); });
    table.Add("elv_angle" + end, [&](const Segments& s) { return ElevationPlane(s, side); });
  }
  if (limbs.wrist >= 0) table.Add("elbow_flex" + end, elbow);
}

}  // namespace

JointRotation RotationBetween(const Matrix3d& parent, const Matrix3d& child, bool is_left) {
  const Matrix3d r = parent.transpose() * child;
  const double sign = is_left ? -1.0 : 1.0;
  return {std::atan2(-r(0, 1), r(1, 1)), sign * std::asin(std::clamp(r(2, 1), -1.0, 1.0)),
          sign * std::atan2(-r(2, 0), r(2, 2))};
}

JointRotation OtherWay(const JointRotation& rotation) {
  return {rotation.flexion + kPi, kPi - rotation.adduction, rotation.rotation + kPi};
}

void FollowArm(std::vector<JointRotation>& arm, const std::vector<double>& elbow_rad) {
  JointRotation last{kNaN, kNaN, kNaN};
  for (std::size_t t = 0; t < arm.size(); ++t) {
    if (!std::isfinite(arm[t].flexion)) continue;
    JointRotation one = Near(arm[t], last);
    JointRotation other = Near(OtherWay(arm[t]), last);
    const bool goes_on = std::isfinite(last.flexion);
    if (goes_on && Distance(other, last) < Distance(one, last)) std::swap(one, other);
    const double limit = goes_on ? kLargestArmRotation : kPi / 2.0;
    if (std::abs(Wrapped(one.rotation)) > limit) {
      if (elbow_rad[t] >= kDecidingElbow) {
        one = Near(other, {kNaN, kNaN, kNaN});
      } else {
        one.rotation = kNaN;
      }
    }
    arm[t] = one;
    last = {one.flexion, one.adduction, std::isfinite(one.rotation) ? one.rotation : last.rotation};
  }
}

void HideWherePolesCoincide(std::vector<JointRotation>& rotations) {
  static const double kLeast = std::sin(RadFromDeg(kSmallestAngleDeg));
  for (JointRotation& rotation : rotations) {
    if (std::abs(std::cos(rotation.adduction)) < kLeast) rotation.flexion = rotation.rotation = kNaN;
  }
}

void Unwrap(std::vector<double>& degrees) {
  double last = kNaN;
  for (double& value : degrees) {
    if (!std::isfinite(value)) continue;
    if (std::isfinite(last)) value = last + std::remainder(value - last, 360.0);
    last = value;
  }
}

std::vector<TimeSeries> JointAngles(const PoseSequence& person, const BodyJoints& joints, bool up_is_known) {
  AngleTable table(person, joints);
  const bool has_pelvis = joints.has_hips() && (joints.spine >= 0 || joints.has_trunk());
  if (up_is_known && has_pelvis) table.AddOrientation("pelvis", &Segments::pelvis);
  if (up_is_known && joints.has_trunk()) table.AddOrientation("trunk", &Segments::trunk);
  if (joints.has_trunk()) {
    std::vector<JointRotation> lumbar =
        table.Rotations([](const Segments& s) { return RotationBetween(s.pelvis, s.trunk); });
    HideWherePolesCoincide(lumbar);
    // Without a spine, the pelvis leans with the trunk.
    table.Add({joints.spine >= 0 ? "lumbar_extension" : "", "lumbar_bending", "lumbar_rotation"}, lumbar);
  }
  for (const Side side : kSides) AddLeg(table, joints, side);
  for (const Side side : kSides) AddArm(table, joints, side);
  return table.Take();
}

std::vector<TimeSeries> OpenSimPelvis(const PoseSequence& person) {
  const BodyJoints joints = FindBodyJoints(person);
  if (!joints.has_hips() || (joints.spine < 0 && !joints.has_trunk())) return {};
  AngleTable table(person, joints);
  std::vector<JointRotation> pelvis = table.Rotations(
      [](const Segments& s) { return RotationBetween(Matrix3d::Identity(), YUpFromWorld() * s.pelvis); });
  HideWherePolesCoincide(pelvis);
  table.Add({"pelvis_tilt", "pelvis_list", "pelvis_rotation"}, pelvis);
  return table.Take();
}

}  // namespace canonpose
