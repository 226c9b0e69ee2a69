// Shared by the tests of exported scenes: a scene with gaps, several people and cameras of all kinds.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/scene/scene.h"

namespace canonpose::testing {

inline const Skeleton& ThreeJoints() {
  static const Skeleton skeleton{"", {"Hip", "LKnee", "RKnee"}, {-1, 0, 0}, 0, {0, 2, 1}};
  return skeleton;
}

/// Where joint `j` is in frame `t`: different in every coordinate, frame and joint.
inline Eigen::Vector3d PlaceOfJoint(int t, int j) {
  return {1000.0 + 7.25 * t + 100.0 * j, -500.0 + 3.5 * t - 40.0 * j, 900.0 + std::sin(0.1 * t) - 400.0 * j};
}

/// Millimetres; joint 1 is missing in every fourth frame.
inline PoseSequence MovingPerson(const std::string& name, int frames, double shift_mm = 0.0) {
  PoseSequence person(ThreeJoints(), frames);
  person.name = name;
  person.unit = LengthUnit::kMillimetres;
  person.fps = 50.0;
  for (int t = 0; t < frames; ++t) {
    for (int j = 0; j < 3; ++j) {
      if (j == 1 && t % 4 == 3) continue;
      const std::size_t i = static_cast<std::size_t>(3 * t + j);
      person.PoseAt(t).row(j) = (PlaceOfJoint(t, j) + Eigen::Vector3d(shift_mm, 0, 0)).cast<float>();
      person.confidence()[i] = 0.5F;
      if (j != 2) person.standard_deviation()[i] = 4.0F + 0.01F * static_cast<float>(t % 100);
    }
  }
  return person;
}

inline Camera CameraFrom(double angle_rad, double k3 = 0.0) {
  Camera camera;
  camera.K << 1200.125, 0, 955.5, 0, 1190.75, 541.25, 0, 0, 1;
  // Looks horizontally at the origin from 4 m, with z up.
  const Eigen::Vector3d forward(-std::cos(angle_rad), -std::sin(angle_rad), 0.0);
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ());
  camera.camera_from_world_rotation << right.transpose(), -Eigen::RowVector3d::UnitZ(), forward.transpose();
  camera.camera_from_world_translation =
      -camera.camera_from_world_rotation * Eigen::Vector3d(-4000.0 * forward.x(), -4000.0 * forward.y(), 1500.0);
  camera.distortion = {-0.05, 0.02, 0.001, -0.0005, k3};
  return camera;
}

inline SceneCamera StaticCamera(const std::string& name, double angle_rad, double k3 = 0.0) {
  SceneCamera camera;
  camera.name = name;
  camera.image_size_px = {1920, 1080};
  camera.calibration = {CameraFrom(angle_rad, k3)};
  return camera;
}

/// z up and in millimetres, with one person and three cameras.
inline Scene StaticScene(int frames = 10) {
  Scene scene;
  scene.name = "walk";
  scene.up.source = "the cameras";
  scene.scale.source = "the height given";
  scene.people = {MovingPerson("anna", frames)};
  scene.cameras = {StaticCamera("cam1", 0.3), StaticCamera("cam2", 1.7, 0.01), StaticCamera("cam 10.b", 3.0)};
  return scene;
}

/// The same without up and scale.
inline Scene UnknownScene(int frames = 10) {
  Scene scene = StaticScene(frames);
  scene.up = scene.scale = {};
  for (PoseSequence& person : scene.people) person.unit = LengthUnit::kBodyLengths;
  return scene;
}

inline std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// The lines of a text that ends in a line end.
inline std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines = Split(text, '\n');
  if (!lines.empty() && lines.back().empty()) lines.pop_back();
  return lines;
}

}  // namespace canonpose::testing
