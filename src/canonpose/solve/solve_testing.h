// For tests only: simulated captures in memory, and the poses that a lifter might find in them.
#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"
#include "canonpose/simulate/simulator.h"
#include "canonpose/solve/observations.h"

namespace canonpose::testing {

/// The errors of a pretended lifter.
struct StartErrors {
  double turn_rad = 0.25;  ///< of each pose as a whole, about each axis; standard deviation
  double joint_mm = 50.0;  ///< of each joint, along each axis; standard deviation
};

/// The true poses, rotated, with noise, and of another size in every view: what the solver starts from.
inline StartPoses NoisyTruth(const Dataset& dataset, const StartErrors& errors = {}, std::uint64_t seed = 1) {
  StartPoses start;
  for (std::size_t s = 0; s < dataset.sequences.size(); ++s) {
    start.sequences.emplace_back();
    for (std::size_t c = 0; c < dataset.sequences[s].cameras.size(); ++c) {
      const CameraView& view = dataset.sequences[s].cameras[c];
      Rng rng(seed, {s, c});
      const double scale = rng.Uniform(0.2, 5.0);
      std::vector<float> poses(view.truth.positions().size(), std::nanf(""));
      const auto joints = static_cast<std::size_t>(dataset.skeleton.joint_count());
      for (std::size_t t = 0; t < static_cast<std::size_t>(view.truth.frame_count()); ++t) {
        const float* truth = &view.truth.positions()[3 * t * joints];
        const Eigen::Vector3d turn = errors.turn_rad * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal()) +
                                     Eigen::Vector3d::Constant(1e-9);
        const Eigen::AngleAxisd rotation(turn.norm(), turn.normalized());
        const float* root = truth + 3 * dataset.skeleton.root;
        for (std::size_t j = 0; j < joints; ++j) {
          Eigen::Vector3d p;
          for (int axis = 0; axis < 3; ++axis) p[axis] = truth[3 * j + static_cast<std::size_t>(axis)] - root[axis];
          if (static_cast<int>(j) != dataset.skeleton.root) {
            p = rotation * p + errors.joint_mm * Eigen::Vector3d(rng.Normal(), rng.Normal(), rng.Normal());
          }
          if (!(view.confidence[t * joints + static_cast<std::size_t>(dataset.skeleton.root)] > 0.0F)) continue;
          for (int axis = 0; axis < 3; ++axis) {
            poses[3 * (t * joints + j) + static_cast<std::size_t>(axis)] = static_cast<float>(scale * p[axis]);
          }
        }
      }
      start.sequences.back().push_back(PosesAboutRoot(dataset.skeleton, std::move(poses), view.name));
    }
  }
  return start;
}

/// One person, two short clips, four static cameras.
inline SimulationOptions SmallSimulation() {
  SimulationOptions options;
  options.activities = {Activity::kGait, Activity::kDance};
  options.subjects = 1;
  options.clips = 2;
  options.seconds = 6.0;
  options.fps = 25.0;
  options.seed = 3;
  return options;
}

struct SimulatedCapture {
  Dataset dataset;
  std::vector<std::vector<Detections>> detections;  ///< by sequence and camera
};

inline SimulatedCapture Simulate(const SimulationOptions& options) {
  SimulatedCapture capture;
  const Simulator simulator(options);
  capture.dataset.skeleton = simulator.skeleton();
  ClipStream stream(simulator, 1);
  while (std::optional<SimulatedClip> clip = stream.Next()) {
    capture.dataset.sequences.push_back(std::move(clip->sequence));
    capture.detections.push_back(std::move(clip->detections));
  }
  return capture;
}

}  // namespace canonpose::testing
