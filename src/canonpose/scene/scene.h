// People and cameras in one world: what a recording was turned into, and what viewers, exports and analyses start from.
//
// The world is right-handed. Where `up` is known, z points up, and the origin lies below the first known pose of the
// first person; where `floor` is known, too, it is z = 0. Where cameras move, z = 0 is about where the feet are, and
// the person stays above the origin: nothing shows where he or she walks. scene/world.h finds all that.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/geometry/camera.h"
#include "canonpose/scene/pose_sequence.h"
#include "canonpose/scene/provenance.h"

namespace canonpose {

struct SceneCamera {
  std::string name;
  std::array<int, 2> image_size_px{0, 0};  ///< width, height
  /// One camera, or one for each frame where it moves; empty where it is unknown. Translations are in the unit of the
  /// scene's people.
  std::vector<Camera> calibration;
  double time_offset_seconds = 0.0;  ///< added to its time to match the first camera's
  bool used = true;
  std::string why_not_used;  ///< where `used` is false

  [[nodiscard]] const Camera& At(int frame) const {
    return calibration.size() == 1 ? calibration.front() : calibration[static_cast<std::size_t>(frame)];
  }
};

struct Scene {
  std::string name;
  std::vector<PoseSequence> people;  ///< of the same frames, in the world's coordinates and one unit
  std::vector<SceneCamera> cameras;
  Provenance up;     ///< uncertain by degrees
  Provenance floor;  ///< uncertain by a length in the unit of the people
  Provenance scale;  ///< uncertain by percents

  /// Throws std::logic_error where people differ in unit, frames or times, or are not in the world's coordinates, or a
  /// moving camera lacks one calibration per frame.
  void Validate() const;
};

/// Reads a scene file (format "canonpose-scene", version 1). Throws Error(kBadInput).
Scene ReadScene(const std::filesystem::path& path);

/// Whether `path` is an HDF5 file that says it is a scene.
bool IsSceneFile(const std::filesystem::path& path);

/// Layout:
///
///   /                       attributes format = "canonpose-scene", version, name, up, scale (what they are known from,
///                           "" where they are not); optional: floor, up_uncertainty_degrees, floor_uncertainty,
///                           scale_uncertainty_percent
///   /people/N               attributes name, unit, fps; skeleton: joints, parents, root, mirror
///     positions             float32 (T, J, 3), NaN where unknown
///     confidence            float32 (T, J) 0..1
///     standard_deviation    float32 (T, J), NaN where unknown
///     time_seconds          float64 (T); absent: frame / fps
///   /cameras/N              attributes name, image_size (width, height), time_offset_seconds, used (0 or 1),
///                           why_not_used
///     K, R, t, distortion   (3, 3), (3, 3), (3), (5), or one for each frame: x_in_camera = R x_in_world + t; absent:
///                           unknown
void WriteScene(const std::filesystem::path& path, const Scene& scene);

}  // namespace canonpose
