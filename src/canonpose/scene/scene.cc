#include "canonpose/scene/scene.h"

#include "canonpose/base/error.h"

namespace canonpose {

void Scene::Validate() const {
  const int frames = people.empty() ? 0 : people.front().frame_count();
  for (const PoseSequence& person : people) {
    CANONPOSE_CHECK(person.coordinate_frame.kind == CoordinateFrame::Kind::kWorld,
                    "{} is not in the world's coordinates", person.name);
    CANONPOSE_CHECK(person.unit == people.front().unit, "{} and {}", ToString(person.unit),
                    ToString(people.front().unit));
    CANONPOSE_CHECK(person.frame_count() == frames, "{} and {} frames", person.frame_count(), frames);
    CANONPOSE_CHECK(person.time_seconds.empty() || std::ssize(person.time_seconds) == frames,
                    "{} time stamps for {} frames", person.time_seconds.size(), frames);
    CANONPOSE_CHECK(person.fps == people.front().fps && person.time_seconds == people.front().time_seconds,
                    "the times of {} differ", person.name);
  }
  for (const SceneCamera& camera : cameras) {
    CANONPOSE_CHECK(camera.calibration.size() <= 1 || std::ssize(camera.calibration) == frames,
                    "{} calibrations for {} frames", camera.calibration.size(), frames);
  }
}

}  // namespace canonpose
