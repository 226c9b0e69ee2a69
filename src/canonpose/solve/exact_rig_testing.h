// For tests only: cameras, joints and bone lengths that are known, and the keypoints that such a rig sees of them. No
// simulator: a body whose bones keep their lengths exactly, cameras without distortion, errors that are normal.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/base/random.h"
#include "canonpose/skeleton/skeleton.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/rig_estimate.h"

namespace canonpose::testing {

struct ExactRigOptions {
  bool static_cameras = true;
  int frames = 40;  ///< of each clip
  int clips = 1;
  int views = 4;
  double fps = 25.0;
  double distance = 1.2;        ///< of the cameras from the middle, body units
  double log_focal = 0.0;       ///< of all cameras
  double turn_rad_per_s = 0.1;  ///< of moving cameras, each about an axis of its own
  std::string skeleton = "h36m-17";
};

struct ExactRig {
  RigEstimate truth;
  CaptureObservations capture;  ///< confidence 1 everywhere; start poses are the truth
};

/// Sets the keypoints of `capture` to the projections of `truth` plus normal errors of standard deviation `noise` along
/// each axis, in body units at the depth of the root.
inline void SeeJoints(const RigEstimate& truth, double noise, std::uint64_t seed, CaptureObservations& capture) {
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int v = 0; v < capture.view_count(); ++v) {
      Rng rng(seed, {static_cast<std::uint64_t>(n), static_cast<std::uint64_t>(v)});
      const double scale = truth.ImageScale(n, v, capture.skeleton.root);
      for (int j = 0; j < capture.joint_count(); ++j) {
        const Eigen::Vector2d error(rng.Normal(), rng.Normal());
        const Eigen::Vector2d seen = truth.Project(n, v, j) + noise * scale * error;
        const std::size_t i = capture.Index(n, v, j);
        capture.xy[2 * i] = static_cast<float>(seen.x());
        capture.xy[2 * i + 1] = static_cast<float>(seen.y());
        capture.confidence[i] = 1.0F;
      }
    }
  }
}

/// What cameras with these lenses (V) see instead.
inline void SeeThrough(const std::vector<RadialLens>& lenses, CaptureObservations& capture) {
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int v = 0; v < capture.view_count(); ++v) {
      for (int j = 0; j < capture.joint_count(); ++j) {
        const Eigen::Vector2d distorted = lenses[static_cast<std::size_t>(v)].Distort(capture.At(n, v, j));
        Eigen::Map<Eigen::Vector2f>(&capture.xy[2 * capture.Index(n, v, j)]) = distorted.cast<float>();
      }
    }
  }
}

/// Hides a joint from a view in a frame.
inline void Hide(CaptureObservations& capture, int frame, int view, int joint) {
  const std::size_t i = capture.Index(frame, view, joint);
  capture.confidence[i] = 0.0F;
  capture.xy[2 * i] = capture.xy[2 * i + 1] = std::nanf("");
}

/// A view's frame n becomes what it saw in frame source(n) of `recorded`; nothing where there is no such frame.
template <typename Source>
void TakeFrames(const CaptureObservations& recorded, int view, Source&& source, CaptureObservations& capture) {
  for (int n = 0; n < capture.frame_count; ++n) {
    const int from = source(n);
    for (int j = 0; j < capture.joint_count(); ++j) {
      Hide(capture, n, view, j);
      if (from < 0 || from >= recorded.frame_count) continue;
      const std::size_t to = capture.Index(n, view, j);
      const std::size_t old = recorded.Index(from, view, j);
      capture.confidence[to] = recorded.confidence[old];
      std::copy_n(&recorded.xy[2 * old], 2, &capture.xy[2 * to]);
    }
  }
}

namespace internal {

/// The directions of the bones sway about fixed means, with periods of about two seconds.
inline void SetJoints(const Skeleton& skeleton, double fps, const std::vector<double>& lengths, RigEstimate& truth) {
  const auto sway = [](double t, Rng& rng) {
    Eigen::Vector3d value;
    for (double& axis : value) axis = std::sin(2.0 * M_PI * (rng.Uniform(0.3, 0.6) * t + rng.Uniform()));
    return value;
  };
  for (int n = 0; n < truth.frame_count(); ++n) {
    const double t = n / fps;
    Rng of_root(7, {1000});
    truth.Joint(n, skeleton.root) =
        truth.static_cameras ? Eigen::Vector3d(0.1 * sway(t, of_root)) : Eigen::Vector3d::Zero();
    // Parents need not come before their children.
    for (int placed = 1; placed < skeleton.joint_count();) {
      for (int j = 0; j < skeleton.joint_count(); ++j) {
        const int parent = skeleton.parents[static_cast<std::size_t>(j)];
        if (parent < 0 || truth.Joint(n, j).allFinite() || !truth.Joint(n, parent).allFinite()) continue;
        Rng rng(7, {static_cast<std::uint64_t>(j)});
        const Eigen::Vector3d mean = Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal()).normalized();
        const Eigen::Vector3d direction = (mean + 0.4 * sway(t, rng)).normalized();
        truth.Joint(n, j) = truth.Joint(n, parent) + lengths[static_cast<std::size_t>(j)] * direction;
        ++placed;
      }
    }
  }
}

/// On a ring, but at different heights, looking at the middle.
inline void SetCameras(const ExactRigOptions& options, RigEstimate& truth) {
  const int times = options.static_cameras ? 1 : truth.frame_count();
  for (int n = 0; n < times; ++n) {
    for (int v = 0; v < options.views; ++v) {
      const double angle = 2.0 * M_PI * (v + 0.2) / (options.views + 0.5);
      const Eigen::Vector3d position =
          options.distance * Eigen::Vector3d(std::cos(angle), 0.25 * ((v * 2) % 3) - 0.2, std::sin(angle)).normalized();
      Eigen::Matrix3d rotation;  // rows: the camera's x, y and z axis in the world, whose y points down
      rotation.row(2) = -position.normalized().transpose();
      rotation.row(0) = Eigen::Vector3d::UnitY().cross(rotation.row(2).transpose()).normalized().transpose();
      rotation.row(1) = rotation.row(2).cross(rotation.row(0));
      CameraEstimate& camera = truth.CameraAt(n, v);
      camera.log_focal = options.log_focal;
      camera.valid = true;
      if (options.static_cameras) {
        camera.SetRotation(rotation);
        Eigen::Vector3d::Map(camera.placement.data()) = -rotation * position;
        continue;
      }
      const Eigen::Vector3d axis = Eigen::Vector3d(0.3 * v, 1.0, 0.5 - 0.2 * v).normalized();
      const double turn = options.turn_rad_per_s * n / options.fps * (v % 2 == 0 ? 1.0 : -1.0);
      camera.SetRotation(Eigen::AngleAxisd(turn, axis) * rotation);
      camera.placement = {0.05 * std::sin(0.1 * n + v), 0.03 * v - 0.04,
                          options.log_focal - std::log(options.distance)};
    }
  }
}

}  // namespace internal

/// A rig with exact keypoints; SeeJoints() replaces them by noisy ones.
inline ExactRig MakeExactRig(const ExactRigOptions& options = {}) {
  ExactRig rig;
  CaptureObservations& capture = rig.capture;
  capture.name = "exact";
  capture.skeleton = *FindSkeleton(options.skeleton);
  capture.static_cameras = options.static_cameras;
  for (int v = 0; v < options.views; ++v) {
    capture.cameras.push_back({"camera" + std::to_string(v), {1000, 1000}, {1000, 1000}, std::hypot(1000.0, 1000.0)});
  }
  for (int c = 0; c < options.clips; ++c) {
    capture.clips.push_back({static_cast<std::size_t>(c), c * options.frames, options.frames, options.fps, 0});
  }
  capture.subjects = {"somebody"};
  capture.frame_count = options.clips * options.frames;
  const int joints = capture.joint_count();
  rig.truth = RigEstimate::Unknown(options.static_cameras, capture.frame_count, options.views, joints, 1);
  std::vector<double> lengths(static_cast<std::size_t>(joints), 0.0);
  double sum = 0.0;
  for (std::size_t j = 0; j < lengths.size(); ++j) {
    if (capture.skeleton.parents[j] < 0) continue;
    lengths[j] = 1.0 + 0.1 * static_cast<double>(j % 4);
    sum += lengths[j];
  }
  for (std::size_t j = 0; j < lengths.size(); ++j) {
    lengths[j] /= sum;
    if (lengths[j] > 0.0) rig.truth.log_bone_lengths[0][j] = std::log(lengths[j]);
  }
  internal::SetJoints(capture.skeleton, options.fps, lengths, rig.truth);
  internal::SetCameras(options, rig.truth);
  const std::size_t values = capture.Index(capture.frame_count, 0, 0);
  capture.xy.resize(2 * values);
  capture.confidence.resize(values);
  capture.start.resize(3 * values);
  SeeJoints(rig.truth, 0.0, 0, capture);
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int v = 0; v < options.views; ++v) {
      Eigen::Matrix3Xd pose(3, joints);
      for (int j = 0; j < joints; ++j) {
        pose.col(j) = rig.truth.InCamera(n, v, j) - rig.truth.InCamera(n, v, capture.skeleton.root);
      }
      Eigen::Map<Eigen::Matrix3Xf>(&capture.start[3 * capture.Index(n, v, 0)], 3, joints) =
          (pose / pose.norm()).cast<float>();
    }
  }
  return rig;
}

}  // namespace canonpose::testing
