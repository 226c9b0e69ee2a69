#include "canonpose/motion/calm_rotations.h"

#include <complex>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

using Complex = std::complex<double>;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kWeightOfNoTwist = 0.01;

/// The plane at right angles to a bone, as complex numbers.
struct Plane {
  Vector3d first;
  Vector3d second;
  [[nodiscard]] Complex Of(const Vector3d& v) const { return {v.dot(first), v.dot(second)}; }
};

/// What the frames that are known show, in this order.
struct Frames {
  std::vector<std::size_t> index;
  std::vector<Quaterniond> without_twist;
  std::vector<Plane> planes;
  std::vector<Complex> evidence;  ///< sum of weight * hint
  std::vector<double> weight;
};

Frames KnownFrames(const Vector3d& axis, const Plane& plane_of_joint, const std::vector<Aim>& aims) {
  Frames frames;
  for (std::size_t t = 0; t < aims.size(); ++t) {
    const Aim& aim = aims[t];
    if (!aim.is_known) continue;
    const Quaterniond smallest = Quaterniond::FromTwoVectors(axis, aim.direction);
    const Plane plane = {smallest * plane_of_joint.first, smallest * plane_of_joint.second};
    // Opposite to its rest direction, there is no smallest rotation.
    double weight = kWeightOfNoTwist * 0.5 * (1.0 + axis.dot(aim.direction));
    Complex evidence = weight;
    for (const TwistHint& hint : aim.hints) {
      const Complex turn = plane.Of(hint.in_parent) * std::conj(plane_of_joint.Of(hint.in_joint));
      evidence += hint.weight * turn;
      weight += hint.weight * std::abs(turn);
    }
    frames.index.push_back(t);
    frames.without_twist.push_back(smallest);
    frames.planes.push_back(plane);
    frames.evidence.push_back(evidence);
    frames.weight.push_back(weight + 1e-9);
  }
  return frames;
}

/// By how much the plane of known frame i, carried to the next known frame without twist, is turned there.
Complex TurnToNext(const Frames& frames, const std::vector<Aim>& aims, std::size_t i) {
  const Quaterniond carry =
      Quaterniond::FromTwoVectors(aims[frames.index[i]].direction, aims[frames.index[i + 1]].direction);
  const Complex turn = frames.planes[i + 1].Of(carry * frames.planes[i].first);
  return std::abs(turn) > 0.0 ? turn / std::abs(turn) : Complex(1.0);
}

/// Twists of the known frames. Solves the normal equations, which are tridiagonal and Hermitian.
std::vector<double> Twists(const Frames& frames, const std::vector<Aim>& aims, double calm) {
  const std::size_t count = frames.index.size();
  std::vector<Complex> turn(count);      // to the next frame
  std::vector<double> link(count, 0.0);  // weight of the next frame's difference
  for (std::size_t i = 0; i + 1 < count; ++i) {
    turn[i] = TurnToNext(frames, aims, i);
    link[i] = calm / static_cast<double>(frames.index[i + 1] - frames.index[i]);
  }
  std::vector<double> diagonal(count);
  std::vector<Complex> twist = frames.evidence;
  for (std::size_t i = 0; i < count; ++i) {
    diagonal[i] = frames.weight[i] + link[i] + (i > 0 ? link[i - 1] : 0.0);
    if (i == 0) continue;
    const Complex factor = link[i - 1] * turn[i - 1] / diagonal[i - 1];
    diagonal[i] -= link[i - 1] * link[i - 1] / diagonal[i - 1];
    twist[i] += factor * twist[i - 1];
  }
  for (std::size_t i = count; i-- > 0;) {
    if (i + 1 < count) twist[i] += link[i] * std::conj(turn[i]) * twist[i + 1];
    twist[i] /= diagonal[i];
  }
  std::vector<double> angles(count);
  for (std::size_t i = 0; i < count; ++i) angles[i] = std::arg(twist[i]);
  return angles;
}

/// Interpolates between known frames and holds the first and the last.
void FillFrames(const std::vector<std::size_t>& known, std::vector<Quaterniond>& rotations) {
  for (std::size_t t = 0; t < known.front(); ++t) rotations[t] = rotations[known.front()];
  for (std::size_t t = known.back() + 1; t < rotations.size(); ++t) rotations[t] = rotations[known.back()];
  for (std::size_t i = 0; i + 1 < known.size(); ++i) {
    const std::size_t first = known[i];
    const std::size_t last = known[i + 1];
    for (std::size_t t = first + 1; t < last; ++t) {
      const double share = static_cast<double>(t - first) / static_cast<double>(last - first);
      rotations[t] = rotations[first].slerp(share, rotations[last]);
    }
  }
}

}  // namespace

std::vector<Quaterniond> CalmRotations(const Vector3d& axis_in_joint, const std::vector<Aim>& aims, double calm) {
  CANONPOSE_CHECK(std::abs(axis_in_joint.norm() - 1.0) < 1e-6, "an axis of length {}", axis_in_joint.norm());
  std::vector<Quaterniond> rotations(aims.size(), Quaterniond::Identity());
  const Vector3d first = axis_in_joint.unitOrthogonal();
  const Plane plane_of_joint = {first, axis_in_joint.cross(first)};
  const Frames frames = KnownFrames(axis_in_joint, plane_of_joint, aims);
  if (frames.index.empty()) return rotations;
  const std::vector<double> twists = Twists(frames, aims, calm);
  for (std::size_t i = 0; i < frames.index.size(); ++i) {
    const std::size_t t = frames.index[i];
    rotations[t] = Eigen::AngleAxisd(twists[i], aims[t].direction) * frames.without_twist[i];
  }
  FillFrames(frames.index, rotations);
  return rotations;
}

}  // namespace canonpose
