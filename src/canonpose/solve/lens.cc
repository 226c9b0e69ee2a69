#include "canonpose/solve/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace canonpose {
namespace {

/// Of the image diagonal.
constexpr double kCornerRadius = 0.5;
/// The derivative of the distorted radius below which the polynomial is about to fold back.
constexpr double kLeastSlope = 0.1;

/// The square of s up to which the polynomial is used: where its slope 1 + 3 a s^2 + 5 b s^4 falls to kLeastSlope.
double LargestSquare(const RadialLens& lens) {
  const double linear = 3.0 * lens.at_corner[0];
  const double quadratic = 5.0 * lens.at_corner[1];
  const double margin = 1.0 - kLeastSlope;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double discriminant = linear * linear - 4.0 * quadratic * margin;
  if (discriminant < 0.0) return kNever;
  // The smallest positive root of margin + linear u + quadratic u^2, in the form that also holds for quadratic = 0.
  const double root = std::sqrt(discriminant);
  double smallest = kNever;
  for (const double denominator : {-linear + root, -linear - root}) {
    if (denominator > 0.0) smallest = std::min(smallest, 2.0 * margin / denominator);
  }
  return smallest;
}

double Factor(const RadialLens& lens, double square) {
  return 1.0 + square * (lens.at_corner[0] + square * lens.at_corner[1]);
}

/// The s whose distorted radius is `distorted`, by Newton's method; the radius grows up to `largest`.
double UndistortedRadius(const RadialLens& lens, double distorted, double largest) {
  constexpr int kMaxIterations = 60;
  constexpr double kTolerance = 1e-15;
  double low = 0.0;
  double high = largest;
  double radius = std::min(distorted, largest);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double square = radius * radius;
    const double error = radius * Factor(lens, square) - distorted;
    (error > 0.0 ? high : low) = radius;
    const double slope = 1.0 + square * (3.0 * lens.at_corner[0] + square * 5.0 * lens.at_corner[1]);
    double next = radius - error / slope;
    if (!(next >= low && next <= high)) next = std::isfinite(high) ? 0.5 * (low + high) : 2.0 * low;
    if (std::abs(next - radius) <= kTolerance * radius) return next;
    radius = next;
  }
  return radius;
}

}  // namespace

Eigen::Vector2d RadialLens::Distort(const Eigen::Vector2d& undistorted) const {
  if (IsNone()) return undistorted;
  const double square = undistorted.squaredNorm() / (kCornerRadius * kCornerRadius);
  return undistorted * Factor(*this, std::min(square, LargestSquare(*this)));
}

Eigen::Vector2d RadialLens::Undistort(const Eigen::Vector2d& distorted) const {
  if (IsNone() || !distorted.allFinite()) return distorted;
  const double radius = distorted.norm() / kCornerRadius;
  if (radius == 0.0) return distorted;
  const double largest = LargestSquare(*this);
  if (std::isfinite(largest)) {
    const double factor = Factor(*this, largest);
    if (radius >= std::sqrt(largest) * factor) return distorted / factor;
  }
  return distorted * (UndistortedRadius(*this, radius, std::sqrt(largest)) / radius);
}

std::array<double, 5> RadialLens::OpenCv(double focal) const {
  const double square = focal * focal / (kCornerRadius * kCornerRadius);
  return {at_corner[0] * square, at_corner[1] * square * square, 0.0, 0.0, 0.0};
}

}  // namespace canonpose
