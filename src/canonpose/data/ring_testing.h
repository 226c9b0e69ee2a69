// For tests only: a person who moves between calibrated cameras, with exact keypoints and truth.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"

namespace canonpose::testing {

/// A person of about 1750 mm, by h36m-17, in `frames` frames before `cameras` cameras c0, c1, ... on a half circle of
/// 4 m, which look down a little. World: z up.
inline Dataset PersonInRing(int cameras = 4, int frames = 20) {
  Dataset dataset;
  dataset.skeleton = *FindSkeleton("h36m-17");
  const std::size_t joints = dataset.skeleton.joints.size();
  Eigen::Matrix3Xd upright = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(joints));
  const auto put = [&](const std::string& joint, double x, double y, double z) {
    upright.col(dataset.skeleton.Find(joint).value()) = Eigen::Vector3d(x, y, z);
  };
  put("Hip", 0, 0, 900);
  put("Spine", 0, 20, 1150);
  put("Thorax", 0, 0, 1400);
  put("Nose", 80, 0, 1520);
  put("Head", 0, 0, 1640);
  for (const auto& [side, y] : {std::pair<std::string, double>("L", 1.0), {"R", -1.0}}) {
    put(side + "Hip", 0, 120 * y, 900);
    put(side + "Knee", 60, 130 * y, 480);
    put(side + "Foot", -20, 140 * y, 60);
    put(side + "Shoulder", 0, 170 * y, 1400);
    put(side + "Elbow", -60, 250 * y, 1120);
    put(side + "Wrist", 120, 260 * y, 930);
  }
  Sequence sequence{"walk", "S1", 30.0, true, "S1", frames, {}};
  for (int c = 0; c < cameras; ++c) {
    const double angle = M_PI * (c + 0.25) / cameras;
    const Eigen::Vector3d position(4000 * std::cos(angle), 4000 * std::sin(angle), 1400 + 150 * c);
    const Eigen::Vector3d forward = (Eigen::Vector3d(0, 0, 950) - position).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    Camera camera;
    camera.K << 1100 + 20 * c, 0, 960, 0, 1100 + 20 * c, 540, 0, 0, 1;
    camera.camera_from_world_rotation.row(0) = right;
    camera.camera_from_world_rotation.row(1) = forward.cross(right);
    camera.camera_from_world_rotation.row(2) = forward;
    camera.camera_from_world_translation = -camera.camera_from_world_rotation * position;
    CameraView view;
    view.name = "c" + std::to_string(c);
    view.image_size = {1920, 1080};
    view.calibration = {camera};
    std::vector<float> truth;
    Rng rng(1);  // the same motion for every camera
    for (int t = 0; t < frames; ++t) {
      const Eigen::AngleAxisd turn(0.15 * t, Eigen::Vector3d::UnitZ());
      const Eigen::Vector3d step(300 * std::sin(0.3 * t), 200 * std::cos(0.2 * t), 0);
      for (std::size_t j = 0; j < joints; ++j) {
        const Eigen::Vector3d sway(30 * rng.Normal(), 30 * rng.Normal(), 30 * rng.Normal());
        const Eigen::Vector3d point = turn * (upright.col(static_cast<Eigen::Index>(j)) + sway) + step;
        const Eigen::Vector2d pixel = camera.Project(point);
        view.keypoints.insert(view.keypoints.end(), {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())});
        view.confidence.push_back(0.9F);
        const Eigen::Vector3f in_camera = camera.InCamera(point).cast<float>();
        truth.insert(truth.end(), in_camera.begin(), in_camera.end());
      }
    }
    view.truth = TruthPoses(dataset.skeleton, std::move(truth), view.name);
    sequence.cameras.push_back(std::move(view));
  }
  dataset.sequences.push_back(std::move(sequence));
  return dataset;
}

}  // namespace canonpose::testing
