// The radial distortion of a lens, in the solver's normalised image coordinates (observations.h).
#pragma once

#include <array>

#include <Eigen/Core>

namespace canonpose {

/// OpenCV's radial model about the middle of the image, in units of half the image diagonal:
///
///   distorted = undistorted (1 + a s^2 + b s^4),  s = |undistorted| / 0.5
///
/// so that a and b are displacements in the corner of the image, as fractions of its radius: barrel distortion is
/// negative. They say the same at every focal length, unlike OpenCV's k1 = 4 f^2 a and k2 = 16 f^4 b.
///
/// The polynomial of a barrel lens folds back far from the middle, as no lens does. From shortly before that on, the
/// lens counts as magnifying all radii alike, so that each of the two functions below is the inverse of the other
/// everywhere.
struct RadialLens {
  std::array<double, 2> at_corner{0.0, 0.0};  ///< a, b

  [[nodiscard]] bool IsNone() const { return at_corner[0] == 0.0 && at_corner[1] == 0.0; }
  [[nodiscard]] Eigen::Vector2d Distort(const Eigen::Vector2d& undistorted) const;
  [[nodiscard]] Eigen::Vector2d Undistort(const Eigen::Vector2d& distorted) const;
  /// k1, k2, p1, p2, k3 of a camera with this focal length in image diagonals.
  [[nodiscard]] std::array<double, 5> OpenCv(double focal) const;
  /// How far outwards a point is moved that a lens without distortion shows in the corner of the image, as a fraction
  /// of the half diagonal.
  [[nodiscard]] double CornerShift() const { return at_corner[0] + at_corner[1]; }
  bool operator==(const RadialLens&) const = default;
};

}  // namespace canonpose
