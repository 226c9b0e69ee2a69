// What self-calibration starts from: rough poses of every view.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

struct BootstrapOptions {
  /// auto, starter (the lifter that comes with the program), method (a lifter trained now on the dataset itself) or
  /// factorisation (no lifter; static cameras).
  std::string kind = "auto";
  std::filesystem::path model;  ///< a model or run to start from instead; empty: none
  /// Where `method` trains; a run that was interrupted there is continued. Empty: nothing is written.
  std::filesystem::path run_folder;
  std::uint64_t seed = 0;
  int threads = 0;
  std::string device = "cpu";
};

/// Poses of each view of the dataset: from the lifter named by the options, or from the starter that comes with the
/// program. For bodies other than people's they come from a factorisation if all cameras are static, otherwise from a
/// lifter that is trained now on the dataset itself by the method. `file` is the dataset's name for messages. Throws
/// Error.
StartPoses Bootstrap(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

}  // namespace canonpose
