// Places people and cameras of an arbitrary frame in the real world: which way is up, where the floor is, how large all
// is.
//
//   up      People hold cameras level: image x axes are horizontal, and image y axes point down on the whole. Of people
//           who stand upright, shoulders are above ankles. Feet that stand still are on one level floor. Each counts by
//           how sure it is (up_solver.h): a camera's x axis is within about 2 degrees of the level, a person's axis
//           within 3 to 10 degrees of the vertical, and the floor under feet as well as they are spread.
//   floor   Through the feet that stand still (feet.h). Where none does, through their lowest positions.
//   scale   A person's height, known from the lengths of bones (stature.h), or the distance of two cameras.
//
// With moving cameras the solver's frame follows the person: it is centred on the root joint and its axes drift. Then
// up is found in every frame, from cameras and people within some seconds. The heading of the frame may still drift,
// and where the floor is and where the person walks cannot be known: the person stays above the origin, with the feet
// at about z = 0.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/scene/scene.h"
#include "canonpose/scene/world_measures.h"

namespace canonpose {

/// x_in_world = scale * rotation * x_in_scene + translation.
struct WorldPlacement {
  double scale = 1.0;
  std::vector<Eigen::Matrix3d> rotations;  ///< one, or one for each frame where cameras move
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  LengthUnit unit = LengthUnit::kBodyLengths;  ///< in the world: millimetres where the scale is known
  WorldProvenance known;

  [[nodiscard]] const Eigen::Matrix3d& RotationAt(int frame) const {
    return rotations.size() == 1 ? rotations.front() : rotations[static_cast<std::size_t>(frame)];
  }
  [[nodiscard]] Eigen::Vector3d Apply(int frame, const Eigen::Vector3d& point) const {
    return scale * RotationAt(frame) * point + translation;
  }
  /// The camera in the world.
  [[nodiscard]] Camera Apply(int frame, const Camera& camera) const;
};

/// Finds the world of scenes that share one frame: any number of clips before the same static cameras, or one clip of
/// moving ones. The x axis is to the right in the first used camera; the origin is below the first known pose of the
/// first person of the first scene. Lengths of scenes in millimetres are kept as they are. What is not known stays
/// unknown in `known`, and the rest is as documented above. Throws Error(kInvalidArgument) where `measures` name
/// people or cameras that are not there, or a distance is given of cameras that move or were not solved.
WorldPlacement FindWorld(std::span<const Scene> scenes, const WorldMeasures& measures);

/// Moves one of these scenes there.
void PlaceInWorld(const WorldPlacement& world, Scene& scene);

}  // namespace canonpose
