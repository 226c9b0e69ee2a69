// For tests only: a puppet that moves in front of simple cameras, and a short training on it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>

#include <Eigen/Geometry>

#include "canonpose/base/callbacks.h"
#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"
#include "canonpose/train/trainer.h"

namespace canonpose::testing {

inline constexpr int kJoints = 11;

inline Skeleton Puppet() {
  return {"",
          {"pelvis", "left hip", "left knee", "left foot", "right hip", "right knee", "right foot", "chest", "head",
           "left hand", "right hand"},
          {-1, 0, 1, 2, 0, 4, 5, 0, 7, 7, 7},
          0,
          {0, 4, 5, 6, 1, 2, 3, 7, 8, 10, 9}};
}

/// Joint positions of a puppet that kicks, bends its knees and waves, in metres: x left, y down, z forward.
inline std::array<std::array<double, 3>, kJoints> PuppetAt(double time) {
  const auto leg = [](double side, double swing, double bend) {
    return std::array<std::array<double, 3>, 3>{{{side, 0, 0},
                                                 {side, 0.45 * std::cos(swing), 0.45 * std::sin(swing)},
                                                 {side, 0.45 * std::cos(swing) + 0.45 * std::cos(swing - bend),
                                                  0.45 * std::sin(swing) + 0.45 * std::sin(swing - bend)}}};
  };
  const auto left = leg(-0.15, 0.6 * std::sin(time), 0.5 + 0.5 * std::sin(1.3 * time));
  const auto right = leg(0.15, 0.6 * std::sin(time + 3.1), 0.5 + 0.5 * std::sin(1.3 * time + 2.0));
  const double left_arm = std::sin(0.7 * time);
  const double right_arm = std::sin(0.9 * time + 1.0);
  return {{{0, 0, 0},
           left[0],
           left[1],
           left[2],
           right[0],
           right[1],
           right[2],
           {0, -0.5, 0.05 * std::sin(time)},
           {0, -0.75, 0.1},
           {-0.2 - 0.3 * std::abs(std::sin(left_arm)), -0.5 + 0.3 * std::cos(left_arm), 0.2 * std::sin(2 * left_arm)},
           {0.2 + 0.3 * std::abs(std::sin(right_arm)), -0.5 + 0.3 * std::cos(right_arm), 0.25 * std::sin(right_arm)}}};
}

/// The puppet, rotating to and fro, seen from 3.5 m by cameras around it at several heights.
inline Dataset PuppetShow(int frames, int cameras, std::uint64_t seed = 1) {
  constexpr double kTilts[] = {0.1, 0.5, 0.3, 0.0};
  Rng rng(seed);
  Dataset dataset;
  dataset.skeleton = Puppet();
  Sequence sequence{"show", "s", 30.0, true, "s", frames, {}};
  for (int c = 0; c < cameras; ++c) {
    CameraView view;
    view.name = "cam" + std::to_string(c);
    view.image_size = {1000, 1000};
    const double tilt = kTilts[c % 4];
    std::vector<float> positions;
    for (int t = 0; t < frames; ++t) {
      const double time = 0.13 * t;
      const double azimuth = 0.3 + 1.1 * c + 0.4 * std::sin(0.31 * time);
      for (const auto& joint : PuppetAt(time)) {
        const double x = std::cos(azimuth) * joint[0] + std::sin(azimuth) * joint[2];
        const double level_z = -std::sin(azimuth) * joint[0] + std::cos(azimuth) * joint[2];
        const double y = std::cos(tilt) * joint[1] - std::sin(tilt) * level_z;
        const double z = 3.5 + std::sin(tilt) * joint[1] + std::cos(tilt) * level_z;
        view.keypoints.push_back(static_cast<float>(500 + 800 * x / z + 0.3 * rng.Normal()));
        view.keypoints.push_back(static_cast<float>(500 + 800 * y / z + 0.3 * rng.Normal()));
        view.confidence.push_back(0.9F);
        positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
      }
    }
    view.truth = TruthPoses(dataset.skeleton, std::move(positions), view.name);
    sequence.cameras.push_back(view);
  }
  dataset.sequences.push_back(sequence);
  return dataset;
}

/// The same with a calibration whose cameras are all tilted by the same angle, so that "down" is not their y axis.
inline Dataset CalibratedShow(int frames, int cameras) {
  Dataset dataset = PuppetShow(frames, cameras);
  for (std::size_t c = 0; c < dataset.sequences[0].cameras.size(); ++c) {
    Camera camera;
    camera.K << 800, 0, 500, 0, 800, 500, 0, 0, 1;
    camera.camera_from_world_rotation =
        (Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(1.1 * c, Eigen::Vector3d::UnitY()))
            .toRotationMatrix();
    dataset.sequences[0].cameras[c].calibration = {camera};
  }
  return dataset;
}

/// What train() returns when it is stopped at its `polls`th query of Callbacks::stop.
template <typename TrainOnce>
auto StoppedAfter(int polls, TrainOnce&& train) {
  Callbacks callbacks;
  callbacks.stop = [&polls] { return --polls <= 0; };
  const CallbackScope scope(callbacks);
  return train();
}

/// A short training on it, on one thread.
inline TrainJob PuppetJob(const std::filesystem::path& folder, const std::string& name, const std::string& preset) {
  TrainJob job;
  job.datasets = {PuppetShow(40, 3)};
  job.data_files = {"show.h5"};
  job.options = PresetOptions(preset);
  job.options.width = 16;
  job.options.epochs = 20;
  job.options.batch_frames = 8;
  job.options.threads = 1;
  job.options.seed = 3;
  job.run_folder = folder / name;
  return job;
}

}  // namespace canonpose::testing
