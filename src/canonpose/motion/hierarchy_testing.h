// For tests only: a person in a T pose, moving hierarchies, and the poses that their joints make.
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "canonpose/motion/hierarchy_fit.h"
#include "canonpose/scene/pose_sequence.h"
#include "canonpose/skeleton/mapping.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose::testing {

/// A joint of a person of about 1.75 m in a T, looking towards -y, mm; zero where `part` (FindPart()) is unknown.
inline Eigen::Vector3d InTPose(const std::string& part) {
  static const std::map<std::string, Eigen::Vector3d> kMiddle = {{"pelvis", {0, 0, 930}},   {"spine", {0, 0, 1170}},
                                                                 {"thorax", {0, 0, 1435}},  {"upperneck", {0, 0, 1510}},
                                                                 {"nose", {0, -115, 1590}}, {"headtop", {0, 0, 1750}}};
  static const std::map<std::string, Eigen::Vector3d> kLeft = {
      {"hip", {88, 0, 930}},     {"knee", {88, 0, 502}},     {"ankle", {88, 0, 70}},       {"shoulder", {182, 0, 1435}},
      {"elbow", {505, 0, 1435}}, {"wrist", {762, 0, 1435}},  {"eye", {32, -85, 1635}},     {"ear", {74, -10, 1615}},
      {"heel", {88, 62, 20}},    {"bigtoe", {70, -195, 15}}, {"smalltoe", {140, -155, 15}}};
  if (const auto found = kMiddle.find(part); found != kMiddle.end()) return found->second;
  const auto found = kLeft.find(part.substr(1));
  if (found == kLeft.end()) return Eigen::Vector3d::Zero();
  const double sign = part.front() == 'l' ? 1.0 : -1.0;
  return {sign * found->second.x(), found->second.y(), found->second.z()};
}

/// The hierarchy of that person in one frame; what the skeleton has keypoints for decides which joints it has.
inline HierarchyFit TPoseHierarchy(const Skeleton& skeleton, JointNames names) {
  PoseSequence person(skeleton, 1);
  person.unit = LengthUnit::kMillimetres;
  person.fps = 50.0;
  for (const TemplateJoint& row : HierarchyTemplate()) {
    const std::string part = row.part;
    std::optional<int> joint = FindPart(skeleton, part);
    if (!joint && part == "thorax") joint = skeleton.Find("Neck");
    if (!joint && part == "upperneck") joint = skeleton.Find("UpperNeck");
    if (joint) person.PoseAt(0).row(*joint) = InTPose(part).transpose().cast<float>();
  }
  person.TrustKnownJoints();
  return FitHierarchy(person, names);
}

/// Lets the hierarchy walk, turn, wave and nod, smoothly: at most 4 degrees per frame at each joint.
inline void Animate(int frames, double phase, HierarchyFit& fit) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  ArticulatedMotion& motion = fit.motion;
  motion.root_position_mm.clear();
  motion.parent_from_joint.clear();
  for (int t = 0; t < frames; ++t) {
    const double a = 0.06 * t + phase;
    motion.root_position_mm.emplace_back(500.0 * std::sin(0.3 * a), -20.0 * t, 930.0 + 30.0 * std::sin(a));
    for (const FittedJoint role : fit.roles) {
      const int side = role >= kFRHip || (role >= kFRClavicle && role <= kFRHandEnd) ? 1 : 0;
      const double sign = side == 0 ? 1.0 : -1.0;
      const double swing = std::sin(a + side * 3.14159);
      Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
      if (role == kFHip) {
        q = AngleAxisd(0.4 * a, Vector3d::UnitZ()) * AngleAxisd(0.1 * std::sin(a), Vector3d::UnitY());
      } else if (role == kFSkull) {
        q = AngleAxisd(0.4 * std::sin(a), Vector3d::UnitZ()) * AngleAxisd(0.2 * std::cos(a), Vector3d::UnitX());
      } else if (role == kFLShoulder || role == kFRShoulder) {
        q = AngleAxisd(sign * (0.9 + 0.3 * swing), Vector3d::UnitY()) * AngleAxisd(0.6 * swing, Vector3d::UnitZ()) *
            AngleAxisd(0.3 * swing, Vector3d::UnitX());
      } else if (role == kFLElbow || role == kFRElbow) {
        q = AngleAxisd(-sign * (0.9 + 0.5 * swing), Vector3d::UnitZ());
      } else if (role == kFLHip || role == kFRHip) {
        q = AngleAxisd(-0.5 * swing - 0.2, Vector3d::UnitX()) * AngleAxisd(0.2 * swing, Vector3d::UnitZ());
      } else if (role == kFLKnee || role == kFRKnee) {
        q = AngleAxisd(0.6 + 0.5 * std::cos(a + side * 3.14159), Vector3d::UnitX());
      } else if (role == kFLAnkle || role == kFRAnkle) {
        q = AngleAxisd(0.2 * swing, Vector3d::UnitX());
      } else if (role == kFSpine) {
        q = AngleAxisd(0.1 * std::sin(a), Vector3d::UnitZ());
      }
      motion.parent_from_joint.push_back(q);
    }
  }
}

/// The poses of the hierarchy's joints that stand for keypoints, mm.
inline PoseSequence PosesOf(const HierarchyFit& fit, const Skeleton& skeleton) {
  PoseSequence person(skeleton, fit.motion.frame_count());
  person.unit = LengthUnit::kMillimetres;
  person.fps = fit.motion.fps;
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Quaterniond> rotations;
  for (int t = 0; t < person.frame_count(); ++t) {
    ForwardKinematics(fit.motion, t, positions, rotations);
    for (std::size_t j = 0; j < positions.size(); ++j) {
      if (fit.keypoints[j] >= 0) person.PoseAt(t).row(fit.keypoints[j]) = positions[j].transpose().cast<float>();
    }
  }
  person.TrustKnownJoints();
  return person;
}

}  // namespace canonpose::testing
