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
  /// Where `method` trains; a run that was interrupted there goes on. Empty: a temporary folder.
  std::filesystem::path run_folder;
  std::uint64_t seed = 0;
  int threads = 0;
  std::string device = "cpu";
};

/// The poses that a lifter sees in each view of the dataset: the lifter named by the options, or the starter that
/// comes with the program. For other bodies than people's the poses are
/// those of a factorisation where all cameras stand still, otherwise of a lifter trained now on the dataset itself by
/// the method. `file` is the dataset's name for messages. Throws Error.
StartPoses Bootstrap(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

}  // namespace canonpose
