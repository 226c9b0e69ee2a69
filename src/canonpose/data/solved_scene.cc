#include "canonpose/data/solved_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

bool IsSolved(const CameraView& view) { return !view.solved.empty() && !view.solved_calibration.empty(); }

/// Adds what one view knows in its own frame `own` to joints of `frame` that are still missing.
void AddPose(const CameraView& view, int own, int frame, PoseSequence& person) {
  const Camera& camera = view.SolvedCalibrationAt(own);
  const auto joints = static_cast<std::size_t>(person.joint_count());
  const std::size_t first = static_cast<std::size_t>(frame) * joints;
  const std::size_t first_own = static_cast<std::size_t>(own) * joints;
  for (std::size_t j = 0; j < joints; ++j) {
    const auto joint = static_cast<int>(j);
    if (!view.solved.IsKnown(own, joint) || person.IsKnown(frame, joint)) continue;
    const Eigen::Vector3d in_camera = view.solved.PoseAt(own).row(joint).transpose().cast<double>();
    const Eigen::Vector3d in_world =
        camera.camera_from_world_rotation.transpose() * (in_camera - camera.camera_from_world_translation);
    person.PoseAt(frame).row(joint) = in_world.cast<float>();
    person.standard_deviation()[first + j] = view.solved.standard_deviation()[first_own + j];
  }
}

/// The view's keypoint confidences, frame by frame of the sequence, where they are higher.
void AddConfidence(const CameraView& view, const ViewClock& clock, PoseSequence& person) {
  const auto joints = static_cast<std::size_t>(person.joint_count());
  for (int n = 0; n < person.frame_count(); ++n) {
    const int own = clock.OwnFrame(n);
    for (std::size_t j = 0; own >= 0 && j < joints; ++j) {
      float& confidence = person.confidence()[static_cast<std::size_t>(n) * joints + j];
      confidence = std::max(confidence, view.confidence[static_cast<std::size_t>(own) * joints + j]);
    }
  }
}

/// The cameras of a view, frame by frame of the sequence where it moves; the nearest in time where none of its frames
/// is there.
std::vector<Camera> CamerasByFrame(const CameraView& view, const ViewClock& clock, int frame_count) {
  if (view.solved_calibration.size() <= 1) return view.solved_calibration;
  std::vector<Camera> cameras;
  for (int n = 0; n < frame_count; ++n) {
    int own = -1;
    for (int distance = 0; own < 0 && distance < frame_count; ++distance) {
      own = std::max(clock.OwnFrame(n - distance), clock.OwnFrame(n + distance));
    }
    cameras.push_back(view.SolvedCalibrationAt(std::max(own, 0)));
  }
  return cameras;
}

/// Adds the person of a sequence to the scene of others who were filmed together with them.
void AddPerson(Scene own, const Sequence& sequence, const std::string& file, Scene& scene) {
  PoseSequence& person = own.people.front();
  const PoseSequence& first = scene.people.front();
  if (person.frame_count() != first.frame_count() || person.unit != first.unit || person.fps != first.fps) {
    ThrowBadInput({file, "/sequences/" + sequence.name,
                   fmt::format("{} frames in {}, as the others of the scene {} have", first.frame_count(),
                               ToString(first.unit), scene.name),
                   fmt::format("{} in {}", person.frame_count(), ToString(person.unit)),
                   "give only recordings of one time the same attribute `scene`"});
  }
  for (SceneCamera& camera : own.cameras) {
    const auto known = std::ranges::find(scene.cameras, camera.name, &SceneCamera::name);
    if (known == scene.cameras.end()) {
      scene.cameras.push_back(std::move(camera));
    } else if (camera.used && !known->used) {
      *known = std::move(camera);
    }
  }
  scene.people.push_back(std::move(person));
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
  std::vector<ViewClock> clocks;
  for (const CameraView& view : sequence.cameras) {
    const ViewClock& clock = clocks.emplace_back(sequence, view);
    AddConfidence(view, clock, person);
    SceneCamera& camera = scene.cameras.emplace_back();
    camera.name = view.name;
    camera.image_size_px = view.image_size;
    camera.calibration = CamerasByFrame(view, clock, sequence.frame_count);
    camera.time_offset_seconds = view.time_offset_seconds;
    camera.used = IsSolved(view);
    if (!camera.used) camera.why_not_used = "no solution of it was found";
  }
  // Poses of views with another clock may stand between the frames of the others, so they come last.
  for (const bool has_own_clock : {false, true}) {
    for (std::size_t c = 0; c < clocks.size(); ++c) {
      const CameraView& view = sequence.cameras[c];
      if (!IsSolved(view) || has_own_clock != (view.time_offset_seconds != 0.0 || !view.solved_frames.empty()))
        continue;
      for (int n = 0; n < sequence.frame_count; ++n) {
        if (const int own = clocks[c].OwnFrame(n); own >= 0) AddPose(view, own, n, person);
      }
    }
  }
  return scene;
}

std::vector<const Sequence*> SequencesOf(const Dataset& dataset, const Scene& scene) {
  std::vector<const Sequence*> sequences;
  for (const Sequence& sequence : dataset.sequences) {
    if (sequence.scene.empty() ? sequence.name != scene.name : sequence.scene != scene.name) continue;
    if (std::ranges::any_of(sequence.cameras, IsSolved)) sequences.push_back(&sequence);
  }
  return sequences;
}

std::vector<Scene> ScenesOfSolved(const Dataset& dataset, const std::string& file) {
  std::vector<Scene> scenes;
  std::map<std::string, std::size_t> joined;
  for (const Sequence& sequence : dataset.sequences) {
    if (sequence.scene.empty()) {
      scenes.push_back(SceneOfSolved(dataset, sequence, file));
      continue;
    }
    if (std::ranges::none_of(sequence.cameras, IsSolved)) continue;
    Scene own = SceneOfSolved(dataset, sequence, file);
    const auto [known, is_new] = joined.try_emplace(sequence.scene, scenes.size());
    if (is_new) {
      own.name = sequence.scene;
      scenes.push_back(std::move(own));
    } else {
      AddPerson(std::move(own), sequence, file, scenes[known->second]);
    }
  }
  if (scenes.empty() && !dataset.sequences.empty()) {
    (void)SceneOfSolved(dataset, dataset.sequences.front(), file);  // says what is missing
  }
  return scenes;
}

}  // namespace canonpose
