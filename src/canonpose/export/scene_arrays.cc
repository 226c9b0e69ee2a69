#include "canonpose/export/scene_arrays.h"

#include <limits>

namespace canonpose {

std::vector<float> PositionsInFile(const PoseSequence& person, const FileSpace& space) {
  std::vector<float> positions;
  positions.reserve(person.positions().size());
  for (int t = 0; t < person.frame_count(); ++t) {
    for (int j = 0; j < person.joint_count(); ++j) {
      const Eigen::Vector3f position = space.Position(person, t, j).cast<float>();
      positions.insert(positions.end(), position.begin(), position.end());
    }
  }
  return positions;
}

std::vector<float> DeviationsInFile(const PoseSequence& person, const FileSpace& space) {
  std::vector<float> deviations;
  deviations.reserve(person.standard_deviation().size());
  for (const float deviation : person.standard_deviation()) {
    deviations.push_back(static_cast<float>(space.Length(static_cast<double>(deviation))));
  }
  return deviations;
}

std::vector<double> SecondsOf(const PoseSequence& person) {
  const bool is_known = person.fps > 0.0 || !person.time_seconds.empty();
  std::vector<double> seconds;
  for (int t = 0; t < person.frame_count(); ++t) {
    seconds.push_back(is_known ? person.TimeOf(t) : std::numeric_limits<double>::quiet_NaN());
  }
  return seconds;
}

CameraArrays ArraysOfCameras(const std::vector<Camera>& cameras, const FileSpace& space) {
  CameraArrays arrays;
  for (const Camera& in_scene : cameras) {
    const Camera camera = space.InFile(in_scene);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        arrays.K.push_back(camera.K(row, column));
        arrays.R.push_back(camera.camera_from_world_rotation(row, column));
      }
      arrays.t.push_back(camera.camera_from_world_translation[row]);
    }
    arrays.distortion.insert(arrays.distortion.end(), camera.distortion.begin(), camera.distortion.end());
  }
  return arrays;
}

}  // namespace canonpose
