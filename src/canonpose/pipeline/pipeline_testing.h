// For tests only: small captures, and how much of them has a start.
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "canonpose/pipeline/recording_inputs.h"
#include "canonpose/solve/solve_testing.h"

namespace canonpose::testing {

/// A frame of OpenPose in which nobody is seen.
inline void WriteFrame(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "frame_000000000000_keypoints.json") << R"({"version": 1.3, "people": []})";
}

inline std::vector<std::string> NamesOf(const RecordingInputs& inputs) {
  std::vector<std::string> names;
  for (const RecordedCamera& camera : inputs.cameras) names.push_back(camera.name);
  return names;
}

inline Dataset SmallCapture(const std::string& rig) {
  SimulationOptions options = SmallSimulation();
  options.clips = 1;
  options.seconds = 2.0;
  options.rig.kind = rig;
  return Simulate(options).dataset;
}

/// The share of frames of all views for which there is a start.
inline double ShareStarted(const StartPoses& start) {
  double started = 0.0;
  double count = 0.0;
  for (const auto& sequence : start.sequences) {
    for (const PoseSequence& view : sequence) {
      started += static_cast<double>(
          std::ranges::count_if(view.positions(), [](float value) { return std::isfinite(value); }));
      count += static_cast<double>(view.positions().size());
    }
  }
  return started / count;
}

}  // namespace canonpose::testing
