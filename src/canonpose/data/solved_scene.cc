#include "canonpose/data/solved_scene.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

bool IsSolved(const CameraView& view) { return !view.solved.empty() && !view.solved_calibration.empty(); }

/// Adds what one view knows of a frame to joints that are still missing.
void AddPose(const CameraView& view, int frame, PoseSequence& person) {
  const Camera& camera = view.SolvedCalibrationAt(frame);
  const auto joints = static_cast<std::size_t>(person.joint_count());
  const std::size_t first = static_cast<std::size_t>(frame) * joints;
  for (std::size_t j = 0; j < joints; ++j) {
    const auto joint = static_cast<int>(j);
    if (!view.solved.IsKnown(frame, joint) || person.IsKnown(frame, joint)) continue;
    const Eigen::Vector3d in_camera = view.solved.PoseAt(frame).row(joint).transpose().cast<double>();
    const Eigen::Vector3d in_world =
        camera.camera_from_world_rotation.transpose() * (in_camera - camera.camera_from_world_translation);
    person.PoseAt(frame).row(joint) = in_world.cast<float>();
    person.standard_deviation()[first + j] = view.solved.standard_deviation()[first + j];
  }
}

}  // namespace

Scene SceneOfSolved(const Dataset& dataset, const Sequence& sequence, const std::string& file) {
  const auto solved = std::ranges::find_if(sequence.cameras, IsSolved);
  if (solved == sequence.cameras.end()) {
    ThrowBadInput({file, "/sequences/" + sequence.name, "3D poses that were solved", "none",
                   "run `canonpose solve` on it first"});
  }
  Scene scene;
  scene.name = sequence.name;
  scene.up = sequence.solved_world.up;
  scene.floor = sequence.solved_world.floor;
  scene.scale = sequence.solved_world.scale;
  PoseSequence& person = scene.people.emplace_back(dataset.skeleton, sequence.frame_count);
  person.name = sequence.subject;
  person.fps = sequence.fps;
  person.unit = solved->solved.unit;
  for (const CameraView& view : sequence.cameras) {
    for (std::size_t i = 0; i < view.confidence.size(); ++i) {
      person.confidence()[i] = std::max(person.confidence()[i], view.confidence[i]);
    }
    SceneCamera& camera = scene.cameras.emplace_back();
    camera.name = view.name;
    camera.image_size_px = view.image_size;
    camera.calibration = view.solved_calibration;
    camera.used = IsSolved(view);
    if (!camera.used) camera.why_not_used = "no solution of it was found";
  }
  for (const CameraView& view : sequence.cameras) {
    if (!IsSolved(view)) continue;
    for (int t = 0; t < sequence.frame_count; ++t) AddPose(view, t, person);
  }
  return scene;
}

}  // namespace canonpose
