// From videos, or a detector's keypoints, to everything: keypoints, dataset, 3D poses and cameras, a page to look at,
// files for other programs, and a model for single cameras.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/pipeline/run_options.h"
#include "canonpose/pipeline/step_chain.h"

namespace canonpose {

/// What a run came to, for its closing lines. Paths are below RunOptions::output.
struct RunReport {
  std::string name;                ///< of the recording
  std::vector<std::string> trust;  ///< how far the solution can be relied on: a sentence for each capture
  std::vector<std::string> used_cameras;
  std::vector<std::string> unused_cameras;  ///< "cam3: why"
  std::vector<std::string> people;          ///< their names
  int frames = 0;
  double fps = 0.0;  ///< 0 where unknown
  bool in_millimetres = false;
  bool are_videos = false;
  std::string format;  ///< of keypoints
  std::vector<std::filesystem::path> exports;
  std::vector<std::string> formats_left_out;  ///< since the frame rate is unknown
  std::filesystem::path page;
  std::filesystem::path model;            ///< empty where none was trained
  std::optional<double> solved_error_mm;  ///< N-MPJPE against the calibration's triangulation, or the truth
  std::optional<double> model_error_mm;   ///< the same of single cameras
  double seconds_to_page = 0.0;
  double seconds = 0.0;
};

/// Does in `options.output`, in this order and each by the command of that name:
///
///   detect     keypoints/                 of videos alone
///   import     data.h5
///   solve      solved.h5, report.json
///   view       page.html
///   export     exports/poses.csv and others
///   evaluate   evaluation-solved.json     where there is a calibration
///   train      model/                     unless told not to
///   evaluate   evaluation-model.json      where there are both
///
/// commands.sh holds the commands, and run.json what is done (StepChain): the same call again does what is not done
/// yet, or what follows from something that was changed since. The page comes before what takes long.
///
/// Throws Error(kBadInput) where the inputs are none, one camera is missing in the calibration, the folder holds
/// something else than an earlier run or another run is at work there, Error(kInvalidArgument) for options that make no
/// sense, all before anything is done; then whatever a command throws. Where `solve` writes a result that cannot be
/// believed, the page is made before its Error is thrown.
RunReport RunRecording(const RunOptions& options, const StepHooks& hooks);

}  // namespace canonpose
