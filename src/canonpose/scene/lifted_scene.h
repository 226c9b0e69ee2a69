// What a single view was lifted to, as a scene.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/scene/scene.h"

namespace canonpose {

/// One person in a world without calibrated cameras, from poses about the root joint with the axes of a camera
/// (LiftedPoses::pose_in_camera). The root joint stays at the origin, since a view does not show where a person is. z
/// is up as if the camera was held level, and `up` says so; x points to the camera's right, and y away from it.
/// `frames` are the poses' numbers in the video; they give the times where fps is known. The scale is known where the
/// poses are in millimetres.
Scene SceneOfLifted(const PoseSequence& pose_in_camera, const std::vector<std::int64_t>& frames,
                    const std::string& name);

}  // namespace canonpose
