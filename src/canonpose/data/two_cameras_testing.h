// For tests only: the smallest calibrated dataset.
#pragma once

#include "canonpose/data/dataset.h"

namespace canonpose::testing {

/// Two cameras a right angle apart that see three points exactly.
inline Dataset TwoCameras() {
  Dataset dataset;
  dataset.skeleton = {"", {"Hip", "L", "R"}, {-1, 0, 0}, 0, {0, 2, 1}};
  Sequence sequence{"walk", "S1", 50.0, true, "S1", 1, {}};
  for (int c = 0; c < 2; ++c) {
    Camera camera;
    camera.K << 1000, 0, 500, 0, 1000, 500, 0, 0, 1;
    camera.distortion = {-0.05, 0.01, 0.001, 0.0};
    if (c == 1) camera.camera_from_world_rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    camera.camera_from_world_translation = {0, 0, 4000};
    CameraView view;
    view.name = c == 0 ? "a" : "b";
    view.image_size = {1000, 1000};
    view.calibration = {camera};
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(200, 300, 100), Eigen::Vector3d(-100, 50, 10)}) {
      const Eigen::Vector2d pixel = camera.Project(point);
      view.keypoints.insert(view.keypoints.end(), {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())});
      view.confidence.push_back(0.8F);
    }
    sequence.cameras.push_back(view);
  }
  dataset.sequences.push_back(sequence);
  return dataset;
}

}  // namespace canonpose::testing
