// Self-calibration: the 3D poses and cameras of a recording from its 2D keypoints alone.
//
// Each capture is solved by itself:
//
//   0. Where nobody synchronised the cameras: when each began (synchronisation.h).
//   1. The cameras and bone lengths, from some frames and the start's poses. Both ways round in depth are tried
//      (calibration.h).
//   2. Cameras that do not fit the others are corrected or left out, and 1 is repeated without the fault
//      (camera_check.h). Moving cameras: each subject's bone lengths are then the medians over all of its captures.
//   3. How the lenses of static cameras distort, where the keypoints show it: keypoints are undistorted, so that all
//   else knows pinhole
//      cameras only (lens_estimation.h). Before 2 if the cameras fit then, otherwise after it.
//   4. All frames: those in which the detector swapped left and right are corrected (swaps.h), and all are adjusted in
//      windows (windows.h).
//   5. The solution is placed in the real world: up, floor and, if a size is known, millimetres (scene/world.h).
//   6. The report (report.h).
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/scene/world.h"
#include "canonpose/solve/observations.h"
#include "canonpose/solve/report.h"
#include "canonpose/solve/synchronisation.h"

namespace canonpose {

struct SolveOptions {
  std::string mirror = "auto";      ///< of the start's poses; auto: decided by perspective; keep, flip: by request
  int calibration_frames = 400;     ///< from which the cameras of a static capture are found
  int window_frames = 128;          ///< solved at once
  int threads = 0;                  ///< 0: one per core; the result does not depend on it
  WorldMeasures measures{};         ///< of people or between cameras, for millimetres
  bool calibrated_scale = false;    ///< millimetres by the distances between calibrated cameras instead
  std::string distortion = "auto";  ///< of static cameras' lenses; auto: found where keypoints show it; none: none
  GivenOffsets offsets{};           ///< of cameras that began later than the others; those not given are found
  /// Names of cameras that share their distortion, being of one model, group by group; {{"all"}}: all of them do.
  std::vector<std::vector<std::string>> same_lens{};

  /// Throws Error(kInvalidArgument).
  void Validate() const;
  /// Throws Error(kInvalidArgument) where `offsets` names a camera that the dataset lacks, or all that it has. To be
  /// called before the start's poses are found.
  void RequireCamerasOf(const Dataset& dataset) const;
  /// Throws Error(kInvalidArgument) where sizes or lenses are of others than the people and cameras of the dataset, or
  /// a calibration is to give them and there is none. To be called before the start's poses are found.
  void RequireSizesOf(const Dataset& dataset) const;
};

/// Solves every capture of the dataset and sets `solved` and `solved_calibration`; what was there before is removed.
/// Lengths are in millimetres where a size is known, otherwise in the unit in which the bones of the capture's first
/// subject add up to 1. What could not be solved is NaN, and the report says why.
///
/// Throws Error(kComputation) with the reasons where no capture can be solved, Error(kInvalidArgument) where
/// RequireSizesOf() or RequireCamerasOf() does.
SolveReport Solve(Dataset& dataset, const StartPoses& start, const SolveOptions& options);

}  // namespace canonpose
