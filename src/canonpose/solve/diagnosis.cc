#include "canonpose/solve/diagnosis.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "canonpose/base/median.h"
#include "canonpose/geometry/angles.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/initialisation.h"

namespace canonpose {
namespace {

constexpr int kMeasuredFrames = 200;
// The limits below were measured on simulated captures: studio, handheld and pan-tilt-zoom rigs, nine activities, the
// usual noise and twice as much; on people who stand still like statues; and on pairs of cameras that show different
// people.
/// Keypoints of a statue move by 0.06 to 0.12 (usual noise), those of people by 0.36 or more.
constexpr double kMinMotion = 0.18;
/// A recording may be too short for a movement.
constexpr int kFewFrames = 100;
/// Good captures: 0.3 to 0.5 %, with twice the noise up to 1.3 %.
constexpr double kMaxReprojection = 0.015;
/// Good captures: 0.05 to 0.09, with twice the noise up to 0.16; more where cameras are close together. Different
/// people: 0.09 to 1.8.
constexpr double kMaxBoneScatter = 0.25;
constexpr double kAngleForBonesDeg = 30.0;
/// Above both of these, cameras may show different people or just be noisy.
constexpr double kDoubtfulReprojection = 0.005;
constexpr double kDoubtfulBoneScatter = 0.085;
constexpr double kMinViewAngleDeg = 10.0;
/// Good captures: 0.86 to 1.47.
constexpr double kMaxDepthOverWidth = 1.8;
/// A quarter longer. Good captures: up to 0.08, with twice the noise 0.14.
constexpr double kMaxAsymmetry = 0.223;

/// The size of a body in a view: the root mean square distance of its keypoints from the root; NaN where only one is
/// seen.
double ImageSize(const CaptureObservations& capture, int frame, int view) {
  const Eigen::Vector2d root = capture.At(frame, view, capture.skeleton.root);
  double squares = 0.0;
  int count = 0;
  for (int j = 0; j < capture.joint_count(); ++j) {
    if (!capture.Sees(frame, view, j)) continue;
    squares += (capture.At(frame, view, j) - root).squaredNorm();
    ++count;
  }
  return count > 1 ? std::sqrt(squares / (count - 1)) : std::nan("");
}

double LargestAngle(const CaptureObservations& capture, const RigEstimate& estimate, int frame) {
  double largest = 0.0;
  for (int v = 0; v < capture.view_count(); ++v) {
    for (int w = 0; w < v; ++w) {
      const CameraEstimate& a = estimate.CameraAt(frame, v);
      const CameraEstimate& b = estimate.CameraAt(frame, w);
      if (!a.valid || !b.valid) continue;
      const double cosine = std::abs(a.Rotation().row(2).dot(b.Rotation().row(2)));
      largest = std::max(largest, std::acos(std::min(1.0, cosine)));
    }
  }
  return DegFromRad(largest);
}

/// Extent of a pose along the viewing axis relative to its width; NaN where joints are missing.
double DepthOverWidth(const CaptureObservations& capture, const RigEstimate& estimate, int frame, int view) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int j = 0; j < capture.joint_count(); ++j) {
    const Eigen::Vector3d p = estimate.InCamera(frame, view, j) / capture.joint_count();
    mean += p;
    squares += capture.joint_count() * p.cwiseProduct(p);
  }
  const Eigen::Vector3d variance = squares - mean.cwiseProduct(mean);
  return std::sqrt(variance.z() / variance.x());
}

/// Adds |log(length / the subject's)| of the bones of a frame, each joint being triangulated without regard to bones.
void AddBoneErrors(const CaptureObservations& capture, const Solution& solution, int frame,
                   std::vector<double>& errors) {
  const std::vector<double>& lengths =
      solution.estimate.log_bone_lengths[static_cast<std::size_t>(capture.ClipOf(frame).subject)];
  std::vector<Eigen::Vector3d> joints;
  for (int j = 0; j < capture.joint_count(); ++j) {
    joints.push_back(TriangulateJoint(capture, frame, j, solution.scales, solution.estimate).point);
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const int parent = capture.skeleton.parents[j];
    if (parent < 0) continue;
    const double error = std::log((joints[j] - joints[static_cast<std::size_t>(parent)]).norm()) - lengths[j];
    if (std::isfinite(error)) errors.push_back(std::abs(error));
  }
}

double LimbAsymmetry(const CaptureObservations& capture, const RigEstimate& estimate) {
  const Skeleton& skeleton = capture.skeleton;
  std::vector<double> differences;
  for (const std::vector<double>& lengths : estimate.log_bone_lengths) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const int partner = skeleton.mirror[static_cast<std::size_t>(j)];
      if (partner <= j) continue;
      const double difference = lengths[static_cast<std::size_t>(j)] - lengths[static_cast<std::size_t>(partner)];
      if (std::isfinite(difference)) differences.push_back(std::abs(difference));
    }
  }
  return differences.empty() ? 0.0 : Median(std::move(differences));
}

}  // namespace

double MotionSpread(const CaptureObservations& capture) {
  std::vector<double> spreads;
  for (int v = 0; v < capture.view_count(); ++v) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      std::vector<double> sizes;
      std::array<std::vector<double>, 2> places;
      for (int n = 0; n < capture.frame_count; ++n) {
        if (!capture.Sees(n, v, j) || !capture.Sees(n, v, capture.skeleton.root)) continue;
        const double size = ImageSize(capture, n, v);
        if (!std::isfinite(size)) continue;
        const Eigen::Vector2d origin =
            capture.static_cameras ? Eigen::Vector2d::Zero().eval() : capture.At(n, v, capture.skeleton.root);
        const Eigen::Vector2d place = (capture.At(n, v, j) - origin) / (capture.static_cameras ? 1.0 : size);
        for (std::size_t axis = 0; axis < 2; ++axis) places[axis].push_back(place[static_cast<Eigen::Index>(axis)]);
        sizes.push_back(capture.static_cameras ? size : 1.0);
      }
      if (sizes.size() < static_cast<std::size_t>(kMinFrames)) continue;
      const double size = Median(std::move(sizes));
      double squares = 0.0;
      for (std::vector<double>& values : places) {
        // From the first to the last decile: outliers do not count, and a few moments of motion are enough.
        const auto low = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 10);
        const auto high = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
        std::nth_element(values.begin(), low, values.end());
        const double from = *low;
        std::nth_element(values.begin(), high, values.end());
        squares += std::pow((*high - from) / size, 2);
      }
      spreads.push_back(std::sqrt(squares));
    }
  }
  return spreads.empty() ? 0.0 : Median(std::move(spreads));
}

std::string MissingInput(const CaptureObservations& capture) {
  if (capture.view_count() < 2) {
    return fmt::format("needs at least two cameras, has {}", capture.view_count());
  }
  bool shows_root = false;
  bool shows_anything = false;
  for (std::size_t i = 0; i < capture.confidence.size(); ++i) {
    if (!(capture.confidence[i] > 0.0F)) continue;
    shows_anything = true;
    shows_root = shows_root || i % capture.skeleton.joints.size() == static_cast<std::size_t>(capture.skeleton.root);
  }
  if (shows_anything && !shows_root) {
    return fmt::format("no camera ever sees {}, the joint that poses are centred on",
                       capture.skeleton.joints[static_cast<std::size_t>(capture.skeleton.root)]);
  }
  const auto shared = static_cast<int>(FramesWithStart(capture).size());
  if (shared == 0) return "no two cameras see the person at the same time";
  if (shared < kMinFrames) {
    return fmt::format("needs at least {} frames in which two cameras see the person, has {}", kMinFrames, shared);
  }
  const double motion = MotionSpread(capture);
  if (motion < kMinMotion) {
    return fmt::format(
        "the person hardly moves in these {} frames (keypoints move by {:.1f} % of the body's size), and the {} joints "
        "of one pose are too few points to find cameras: {}",
        capture.frame_count, 100.0 * motion, capture.joint_count(),
        capture.frame_count < kFewFrames ? "give more frames" : "record somebody who moves");
  }
  return "";
}

Plausibility MeasurePlausibility(const CaptureObservations& capture, const Solution& solution) {
  Plausibility result;
  std::vector<double> errors;
  std::vector<double> bone_errors;
  std::vector<double> angles;
  std::vector<double> ratios;
  const int step = std::max(1, capture.frame_count / kMeasuredFrames);
  for (int n = 0; n < capture.frame_count; n += step) {
    VisitErrors(capture, std::span(&n, 1), solution.estimate,
                [&](int, int, int, double error) { errors.push_back(error); });
    AddBoneErrors(capture, solution, n, bone_errors);
    const double angle = LargestAngle(capture, solution.estimate, n);
    if (angle > 0.0) angles.push_back(angle);
    for (int v = 0; v < capture.view_count(); ++v) {
      if (!solution.estimate.CameraAt(n, v).valid) continue;
      const double ratio = DepthOverWidth(capture, solution.estimate, n, v);
      if (std::isfinite(ratio)) ratios.push_back(ratio);
    }
  }
  result.reprojection = Median(std::move(errors));
  result.bone_scatter = Median(std::move(bone_errors));
  result.view_angle_deg = Median(std::move(angles));
  result.depth_over_width = Median(std::move(ratios));
  result.asymmetry = LimbAsymmetry(capture, solution.estimate);
  return result;
}

std::string Implausible(const Plausibility& plausibility) {
  if (!std::isfinite(plausibility.reprojection)) return "no frame could be solved";
  if (!(plausibility.view_angle_deg >= kMinViewAngleDeg)) {
    return fmt::format(
        "all cameras look along nearly the same line ({:.0f} degrees apart), so depth cannot be found; needs at least "
        "{:.0f}. If they stand farther apart, one probably shows another person: import them with `person`, or "
        "everybody "
        "with `person` all",
        plausibility.view_angle_deg, kMinViewAngleDeg);
  }
  const bool bones_vary =
      plausibility.bone_scatter > kMaxBoneScatter && plausibility.view_angle_deg > kAngleForBonesDeg;
  if (plausibility.reprojection > kMaxReprojection || bones_vary) {
    return fmt::format(
        "the cameras do not agree: keypoints are off by {:.1f} % of the body's bone length (usual: 0.5 %), bones by "
        "{:.0f} % (usual: 7 %); do the cameras show the same person, at the same time?",
        100.0 * plausibility.reprojection, 100.0 * plausibility.bone_scatter);
  }
  if (plausibility.depth_over_width > kMaxDepthOverWidth) {
    return fmt::format("the solution is wrong: poses are {:.1f} times as deep as wide; start from another model",
                       plausibility.depth_over_width);
  }
  if (plausibility.asymmetry > kMaxAsymmetry) {
    return fmt::format("the solution is wrong: left and right limbs differ by {:.0f} %; start from another model",
                       100.0 * std::expm1(plausibility.asymmetry));
  }
  return "";
}

std::string Doubtful(const Plausibility& plausibility) {
  if (plausibility.reprojection > kDoubtfulReprojection && plausibility.bone_scatter > kDoubtfulBoneScatter) {
    return fmt::format(
        "the cameras agree poorly: keypoints are off by {:.1f} % of the body's bone length, bones by {:.0f} %; do the "
        "cameras show the same person, at the same time?",
        100.0 * plausibility.reprojection, 100.0 * plausibility.bone_scatter);
  }
  return "";
}

}  // namespace canonpose
