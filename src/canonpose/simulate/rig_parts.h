// Shared by the kinds of rigs: aiming, lenses and positions of cameras. Internal to simulate/.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/base/random.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/simulate/rig.h"

namespace canonpose {

/// Height above the ground of the middle of a standing person, at which cameras are aimed.
inline constexpr double kAimHeightMm = 950.0;

/// A lens and sensor without the zoom: the part of the intrinsics that does not depend on the focal length.
struct Lens {
  std::array<int, 2> image_size{0, 0};
  Eigen::Vector2d principal_point_px{0.0, 0.0};
  double pixel_aspect = 1.0;  ///< fy / fx
  /// Radial displacement at the corner of the image as a fraction of the radius, by the quadratic and the quartic term.
  std::array<double, 2> corner_distortion{0.0, 0.0};
  std::array<double, 2> tangential{0.0, 0.0};  ///< p1, p2 times the corner's radius

  /// Sets K and distortion of a camera for this lens and a focal length.
  void Apply(double focal_px, Camera& camera) const;
};

/// A lens whose centre is slightly off (by about 1 %), with distortion of the strength in RigOptions.
Lens MakeLens(std::array<int, 2> image_size, double distortion, Rng& rng);

/// Turns a camera at `position` to look at `target`, with a level horizon except for `roll` (radians, clockwise as seen
/// by the camera).
void Aim(const Eigen::Vector3d& position_mm, const Eigen::Vector3d& target_mm, double roll_rad, Camera& camera);

/// Directions from the subject to the cameras (radians, anticlockwise from x), by RigOptions::spread.
std::vector<double> Azimuths(const std::string& spread, int count, Rng& rng);

/// Cameras that do not move.
class StaticRig : public Rig {
 public:
  explicit StaticRig(std::vector<FilmingCamera> cameras) : cameras_(std::move(cameras)) {}
  [[nodiscard]] bool is_static() const override { return true; }
  [[nodiscard]] std::vector<FilmingCamera> Film(const LandmarkTrack& /*track*/, Rng /*rng*/) const override {
    return cameras_;
  }

 private:
  std::vector<FilmingCamera> cameras_;
};

std::unique_ptr<Rig> MakePtzRig(const RigOptions& options, Rng& rng);
std::unique_ptr<Rig> MakeHandheldRig(const RigOptions& options, Rng& rng);
/// The rig of a JSON file; see rig.h for its schema.
std::unique_ptr<Rig> ReadRigFile(const std::filesystem::path& path);

}  // namespace canonpose
