// For tests only: small captures, and how much of them has a start.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "canonpose/solve/solve_testing.h"

namespace canonpose::testing {

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
