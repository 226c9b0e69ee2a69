// For tests only: a handmade figure that walks in a circle with swinging limbs.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "canonpose/geometry/angles.h"
#include "canonpose/motion/landmarks.h"

namespace canonpose::testing {

/// Landmarks of a person of 1.75 m who stands at the origin and faces +x, with the left side at +y; mm.
inline std::array<Eigen::Vector3d, kLandmarkCount> StandingFigure() {
  std::array<Eigen::Vector3d, kLandmarkCount> p;
  p[kHip] = {0, 0, 930};
  p[kSpine] = {-10, 0, 1170};
  p[kThorax] = {-10, 0, 1420};
  p[kUpperNeck] = {10, 0, 1500};
  p[kNose] = {115, 0, 1590};
  p[kHead] = {15, 0, 1745};
  const auto both = [&](Landmark right, Landmark left, double x, double y, double z) {
    p[right] = {x, -y, z};
    p[left] = {x, y, z};
  };
  both(kRHip, kLHip, 0, 130, 925);
  both(kRKnee, kLKnee, 10, 120, 490);
  both(kRFoot, kLFoot, -10, 110, 80);
  both(kRShoulder, kLShoulder, -10, 175, 1415);
  both(kRElbow, kLElbow, -20, 210, 1120);
  both(kRWrist, kLWrist, 20, 220, 870);
  both(kREye, kLEye, 95, 32, 1625);
  both(kREar, kLEar, 10, 75, 1610);
  both(kRBigToe, kLBigToe, 180, 100, 25);
  both(kRSmallToe, kLSmallToe, 150, 155, 20);
  both(kRHeel, kLHeel, -55, 110, 25);
  return p;
}

/// Swings parts forward by `degrees` about a joint's left-right axis.
inline void Swing(std::array<Eigen::Vector3d, kLandmarkCount>& p, Landmark about, std::initializer_list<Landmark> parts,
                  double degrees) {
  const Eigen::AngleAxisd turn(RadFromDeg(-degrees), Eigen::Vector3d::UnitY());
  for (const Landmark part : parts) p[part] = p[about] + turn * (p[part] - p[about]);
}

/// One walking pose in the figure's own frame at a phase of the step.
inline std::array<Eigen::Vector3d, kLandmarkCount> WalkingFigure(double phase) {
  std::array<Eigen::Vector3d, kLandmarkCount> p = StandingFigure();
  const double s = std::sin(phase);
  const double c = std::cos(phase);
  Swing(p, kRElbow, {kRWrist}, 45.0 + 35.0 * c);
  Swing(p, kLElbow, {kLWrist}, 45.0 - 35.0 * c);
  Swing(p, kRShoulder, {kRElbow, kRWrist}, -35.0 * s);
  Swing(p, kLShoulder, {kLElbow, kLWrist}, 35.0 * s);
  Swing(p, kRKnee, {kRFoot, kRHeel, kRBigToe, kRSmallToe}, -30.0 + 28.0 * c);
  Swing(p, kLKnee, {kLFoot, kLHeel, kLBigToe, kLSmallToe}, -30.0 - 28.0 * c);
  Swing(p, kRHip, {kRKnee, kRFoot, kRHeel, kRBigToe, kRSmallToe}, 10.0 + 28.0 * s);
  Swing(p, kLHip, {kLKnee, kLFoot, kLHeel, kLBigToe, kLSmallToe}, 10.0 - 28.0 * s);
  return p;
}

/// A track of the figure walking in a circle around the origin, which faces all directions once in `lap_seconds`.
inline LandmarkTrack WalkInCircle(int frames, double fps, double radius_mm = 700.0, double lap_seconds = 8.0) {
  LandmarkTrack track{"circle", "figure", fps, {}};
  for (int t = 0; t < frames; ++t) {
    const double seconds = t / fps;
    const double angle = 2.0 * std::numbers::pi * seconds / lap_seconds;
    const Eigen::AngleAxisd heading(angle + std::numbers::pi / 2.0, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d place(radius_mm * std::cos(angle), radius_mm * std::sin(angle), 0.0);
    for (const Eigen::Vector3d& p : WalkingFigure(2.0 * std::numbers::pi * 0.9 * seconds)) {
      track.positions_mm.emplace_back(place + heading * p);
    }
  }
  return track;
}

}  // namespace canonpose::testing
