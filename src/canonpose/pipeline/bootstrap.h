// The start of self-calibration: rough poses of every view, from which `solve` finds cameras and better poses.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

struct BootstrapOptions {
  /// What the poses come from, if `model` names no lifter:
  ///
  ///   starter        the lifter that comes with the program, trained on simulated people; any cameras, but only a
  ///                  person's joints (StarterKnows(), train/starter.h)
  ///   factorisation  a factorisation of the keypoints (solve/factorisation.h): no lifter, any body; static cameras
  ///   method         a lifter that is trained now on the dataset itself, by the method (preset plus); any body, any
  ///                  cameras
  ///   auto           the starter for people; for other bodies factorisation if all cameras are static, or else method
  std::string kind = "auto";
  std::filesystem::path model;  ///< a run or model file of a lifter of your own; empty: none
  /// Where `method` trains; a run that was interrupted there is continued. Empty: nothing is written.
  std::filesystem::path run_folder;
  std::uint64_t seed = 0;  ///< of `method`, which alone involves chance
  int threads = 0;
  std::string device = "cpu";
};

/// The start for a dataset; `file` is its name for messages. Throws Error(kBadInput) where the dataset lacks what
/// the start needs, and Error(kStopped) where training was stopped. A build without LibTorch has only the factorisation
/// and throws Error(kInvalidArgument) for the others.
StartPoses Bootstrap(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

}  // namespace canonpose
