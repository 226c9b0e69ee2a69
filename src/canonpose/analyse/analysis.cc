#include "canonpose/analyse/analysis.h"

#include <algorithm>
#include <cmath>

#include "canonpose/analyse/foot_contacts.h"
#include "canonpose/analyse/joint_angles.h"
#include "canonpose/analyse/segments.h"

namespace canonpose {
namespace {

std::vector<TimeSeries> SegmentLengths(const PoseSequence& person, const BodyJoints& joints) {
  const std::string unit = ToString(person.unit);
  std::vector<TimeSeries> series;
  const auto add = [&](const std::string& name, const std::vector<int>& from, const std::vector<int>& to) {
    const auto lacks = [](int joint) { return joint < 0; };
    if (std::any_of(from.begin(), from.end(), lacks) || std::any_of(to.begin(), to.end(), lacks)) return;
    TimeSeries length{name, unit, {}};
    for (int t = 0; t < person.frame_count(); ++t) {
      const auto middle = [&](const std::vector<int>& of) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const int joint : of) sum += PositionOf(person, t, joint);
        return Eigen::Vector3d(sum / static_cast<double>(of.size()));
      };
      length.values.push_back((middle(to) - middle(from)).norm());
    }
    series.push_back(std::move(length));
  };
  add("pelvis_width", {joints.left.hip}, {joints.right.hip});
  add("trunk_length", {joints.left.hip, joints.right.hip}, {joints.left.shoulder, joints.right.shoulder});
  add("shoulder_width", {joints.left.shoulder}, {joints.right.shoulder});
  for (const Side side : kSides) {
    const LimbJoints& limbs = joints.Of(side);
    const std::string end = std::string("_") + Suffix(side);
    add("thigh_length" + end, {limbs.hip}, {limbs.knee});
    add("shank_length" + end, {limbs.knee}, {limbs.ankle});
    add("foot_length" + end, {limbs.heel}, {limbs.big_toe});
    add("upper_arm_length" + end, {limbs.shoulder}, {limbs.elbow});
    add("forearm_length" + end, {limbs.elbow}, {limbs.wrist});
  }
  return series;
}

/// Adds the differences of series whose names end in _l and _r.
void AddSymmetry(const std::vector<TimeSeries>& series, bool are_lengths, std::vector<TimeSeries>& symmetry) {
  for (const TimeSeries& right : series) {
    if (!right.name.ends_with("_r")) continue;
    const std::string name = right.name.substr(0, right.name.size() - 2);
    const TimeSeries* left = FindSeries(series, name + "_l");
    if (left == nullptr) continue;
    TimeSeries difference{name + "_symmetry", are_lengths ? "" : right.unit, {}};
    for (std::size_t t = 0; t < right.values.size(); ++t) {
      const double l = left->values[t];
      const double r = right.values[t];
      difference.values.push_back(are_lengths ? (l - r) / ((l + r) / 2.0) : std::remainder(l - r, 360.0));
    }
    symmetry.push_back(std::move(difference));
  }
}

}  // namespace

const TimeSeries* FindSeries(const std::vector<TimeSeries>& series, std::string_view name) {
  const auto found = std::find_if(series.begin(), series.end(), [&](const TimeSeries& s) { return s.name == name; });
  return found == series.end() ? nullptr : &*found;
}

Analysis Analyse(const PoseSequence& person, bool up_is_known) {
  const BodyJoints joints = FindBodyJoints(person);
  Analysis analysis;
  analysis.angles = JointAngles(person, joints, up_is_known);
  analysis.segment_lengths = SegmentLengths(person, joints);
  AddSymmetry(analysis.segment_lengths, true, analysis.symmetry);
  AddSymmetry(analysis.angles, false, analysis.symmetry);
  if (up_is_known) analysis.contacts = FindFootContacts(person, joints);
  return analysis;
}

}  // namespace canonpose
