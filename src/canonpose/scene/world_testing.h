// A person of exact proportions before level cameras, for tests of what is found about the world.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/geometry/angles.h"
#include "canonpose/scene/scene.h"
#include "canonpose/skeleton/anthropometry.h"

namespace canonpose::testing {

/// Where and how a person stands in a frame; angles are 0 of one who stands upright.
struct Posture {
  Eigen::Vector2d place_mm{0.0, 0.0};
  double heading_rad = 0.0;    ///< 0: faces along x
  double knees_rad = 0.0;      ///< both knees bent, thighs forward by as much, shanks upright: pi/2 is sitting
  double lean_rad = 0.0;       ///< trunk forward
  double right_foot_mm = 0.0;  ///< the right leg held up, straight upward
};

/// h36m-17 with the proportions of skeleton/anthropometry.h, ankles where they are of somebody who stands on z = 0.
inline void SetPose(const Posture& posture, double stature_mm, int frame, PoseSequence& person) {
  const double s = stature_mm;
  const auto put = [&](const char* joint, double forward, double left, double height) {
    const Eigen::Vector2d in_plane = Eigen::Rotation2Dd(posture.heading_rad) * Eigen::Vector2d(forward, left);
    person.PoseAt(frame).row(*person.skeleton().Find(joint)) =
        Eigen::RowVector3d(in_plane.x() + posture.place_mm.x(), in_plane.y() + posture.place_mm.y(), height)
            .cast<float>();
  };
  const double knee = (kAnkleHeight + 0.246) * s;
  const double hip = knee + 0.245 * s * std::cos(posture.knees_rad);
  const double back = -0.245 * s * std::sin(posture.knees_rad);
  for (const bool is_left : {true, false}) {
    const double side = is_left ? 1.0 : -1.0;
    const double lift = is_left ? 0.0 : posture.right_foot_mm;
    const std::string prefix = is_left ? "L" : "R";
    put((prefix + "Foot").c_str(), 0.0, 0.05 * side * s, kAnkleHeight * s + lift);
    put((prefix + "Knee").c_str(), 0.0, 0.05 * side * s, knee + lift);
    put((prefix + "Hip").c_str(), back, 0.05 * side * s, hip);
  }
  const auto on_trunk = [&](const char* joint, double along, double left) {
    put(joint, back + along * std::sin(posture.lean_rad) * s, left * s, hip + along * std::cos(posture.lean_rad) * s);
  };
  on_trunk("Hip", 0.0, 0.0);
  on_trunk("Spine", 0.144, 0.0);
  on_trunk("Thorax", 0.288, 0.0);
  on_trunk("Nose", 0.38, 0.0);
  on_trunk("Head", 0.47, 0.0);
  for (const bool is_left : {true, false}) {
    const double side = is_left ? 1.0 : -1.0;
    const std::string prefix = is_left ? "L" : "R";
    on_trunk((prefix + "Shoulder").c_str(), 0.288, 0.11 * side);
    on_trunk((prefix + "Elbow").c_str(), 0.288 - 0.186, 0.12 * side);
    on_trunk((prefix + "Wrist").c_str(), 0.288 - 0.186 - 0.146, 0.13 * side);
  }
}

inline PoseSequence MakePerson(const std::vector<Posture>& postures, double stature_mm, double fps = 30.0) {
  PoseSequence person(*FindSkeleton("h36m-17"), static_cast<int>(postures.size()));
  person.name = "Ann";
  person.unit = LengthUnit::kMillimetres;
  person.fps = fps;
  for (int t = 0; t < person.frame_count(); ++t) {
    SetPose(postures[static_cast<std::size_t>(t)], stature_mm, t, person);
  }
  person.TrustKnownJoints();
  person.standard_deviation().assign(person.standard_deviation().size(), 5.0F);
  return person;
}

/// Somebody who stands for a second each at places of a square of two metres, and hurries from one to the next.
inline std::vector<Posture> Walk() {
  std::vector<Posture> walk;
  const std::vector<Eigen::Vector2d> places = {{-1000, -1000}, {1000, -1000}, {1000, 1000}, {-1000, 1000}, {0, 0}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    Posture posture;
    posture.place_mm = places[i];
    posture.heading_rad = 1.3 * static_cast<double>(i);
    for (int t = 0; t < 30; ++t) walk.push_back(posture);
    if (i + 1 == places.size()) break;
    for (int t = 1; t < 10; ++t) {
      posture.place_mm = places[i] + 0.1 * t * (places[i + 1] - places[i]);
      walk.push_back(posture);
    }
  }
  return walk;
}

/// A camera at a place that looks at the middle of the scene, 1 m high, then turned to the right about its axis.
inline SceneCamera MakeCamera(const std::string& name, const Eigen::Vector3d& place_mm, double roll_rad = 0.0) {
  const Eigen::Vector3d forward = (Eigen::Vector3d(0, 0, 1000) - place_mm).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d rotation;
  rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  SceneCamera camera;
  camera.name = name;
  camera.image_size_px = {1920, 1080};
  Camera& one = camera.calibration.emplace_back();
  one.K << 1500, 0, 960, 0, 1500, 540, 0, 0, 1;
  one.camera_from_world_rotation = Eigen::AngleAxisd(-roll_rad, Eigen::Vector3d::UnitZ()) * rotation;
  one.camera_from_world_translation = -one.camera_from_world_rotation * place_mm;
  return camera;
}

/// Four cameras around the scene, 1.5 m high; `roll_deg` (4).
inline std::vector<SceneCamera> MakeCameras(const std::vector<double>& roll_deg = {0, 0, 0, 0},
                                            double height_mm = 1500.0) {
  std::vector<SceneCamera> cameras;
  for (int c = 0; c < 4; ++c) {
    const double azimuth = RadFromDeg(20.0 + 90.0 * c);
    cameras.push_back(MakeCamera("cam" + std::to_string(c + 1),
                                 {5000 * std::cos(azimuth), 5000 * std::sin(azimuth), height_mm},
                                 RadFromDeg(roll_deg[static_cast<std::size_t>(c)])));
  }
  return cameras;
}

/// The similarity with which tests hide the world: x_in_scene = scale * rotation * x_in_world + translation.
struct Disguise {
  double scale = 1.0 / 4321.0;
  Eigen::Matrix3d rotation = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Vector3d translation{0.3, -1.2, 2.0};
};

/// The same scene in another frame, in body lengths.
inline Scene Hide(Scene scene, const Disguise& disguise = {}) {
  for (PoseSequence& person : scene.people) {
    for (int t = 0; t < person.frame_count(); ++t) {
      for (int j = 0; j < person.joint_count(); ++j) {
        const Eigen::Vector3d point = person.PoseAt(t).row(j).transpose().cast<double>();
        person.PoseAt(t).row(j) =
            (disguise.scale * disguise.rotation * point + disguise.translation).cast<float>().transpose();
      }
    }
    for (float& deviation : person.standard_deviation()) deviation *= static_cast<float>(disguise.scale);
    person.unit = LengthUnit::kBodyLengths;
  }
  for (SceneCamera& camera : scene.cameras) {
    for (Camera& one : camera.calibration) {
      one.camera_from_world_rotation *= disguise.rotation.transpose();
      one.camera_from_world_translation =
          disguise.scale * one.camera_from_world_translation - one.camera_from_world_rotation * disguise.translation;
    }
  }
  return scene;
}

}  // namespace canonpose::testing
