// A scene as animation software wants it: people as hierarchies, and all in millimetres with z up.
#pragma once

#include <string>
#include <vector>

#include "canonpose/motion/hierarchy_fit.h"
#include "canonpose/scene/scene.h"

namespace canonpose {

struct MotionExportOptions {
  JointNames joint_names = JointNames::kOurs;
};

struct SceneMotion {
  std::vector<HierarchyFit> people;   ///< those of the scene who are ever seen; each with a name of its own
  std::vector<SceneCamera> cameras;   ///< those that are calibrated, mm
  std::vector<double> times_seconds;  ///< (T) from 0 on
  std::string up;                     ///< what it is known from, for the file
  std::string scale;                  ///< likewise
  bool has_floor = false;             ///< whether z = 0 is known to be the floor
};

/// Fits a hierarchy to each person, and says by LogInfo() how well it fits and which frames lack joints.
///
/// Where the scene's up is unknown, it is that of the people on average, and z = 0 is below them. Where its scale is
/// unknown, people are taken to be 1.70 m tall on average, since animation software has no other unit than metres;
/// LogWarning() says so. Where neither frame rate nor times are known, there are 30 frames per second.
///
/// Throws Error(kBadInput) that names the scene where nobody is seen, or each pose has a scale of its own.
SceneMotion MakeSceneMotion(const Scene& scene, const MotionExportOptions& options);

}  // namespace canonpose
