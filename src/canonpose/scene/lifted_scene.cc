#include "canonpose/scene/lifted_scene.h"

#include "canonpose/base/error.h"

namespace canonpose {

Scene SceneOfLifted(const PoseSequence& pose_in_camera, const std::vector<std::int64_t>& frames,
                    const std::string& name) {
  CANONPOSE_CHECK(std::ssize(frames) == pose_in_camera.frame_count(), "{} numbers of {} frames", frames.size(),
                  pose_in_camera.frame_count());
  Scene scene;
  scene.name = name;
  scene.up.source = "a camera that is taken to be level";
  if (pose_in_camera.unit == LengthUnit::kMillimetres) scene.scale.source = "the height that was given";
  PoseSequence& person = scene.people.emplace_back(pose_in_camera);
  person.coordinate_frame = {};
  if (person.name.empty()) person.name = name;
  for (std::size_t i = 0; i + 2 < person.positions().size(); i += 3) {
    float* const position = &person.positions()[i];
    const float down = position[1];
    position[1] = position[2];
    position[2] = -down;
  }
  bool has_gaps = false;
  for (std::size_t t = 0; t < frames.size(); ++t) has_gaps |= frames[t] != static_cast<std::int64_t>(t);
  if (has_gaps && person.fps > 0.0) {
    person.time_seconds.clear();
    for (const std::int64_t frame : frames) person.time_seconds.push_back(static_cast<double>(frame) / person.fps);
  }
  return scene;
}

}  // namespace canonpose
