// Training a morphing network. No LibTorch in this header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/model/model_file.h"
#include "canonpose/train/morph_options.h"
#include "canonpose/train/morph_pairs.h"

namespace canonpose {

/// What a morphing network is trained on, and where the result goes.
struct MorphJob {
  MorphPairs pairs;
  Skeleton skeleton;
  DatasetSource source;                        ///< of the detected keypoints
  std::vector<std::string> data_files;         ///< for the record
  std::vector<std::string> data_fingerprints;  ///< likewise; a resumed run must have the same
  MorphOptions options;
  /// Where model, checkpoint and metrics are written (train/run_folder.h). Empty: nothing is written, the model is
  /// returned alone, and a run that is stopped is lost.
  std::filesystem::path run_folder;
  bool resume = false;     ///< continue from the folder's checkpoint where there is one
  bool overwrite = false;  ///< start afresh although the folder holds a run
};

struct MorphReport {
  ModelFile model;  ///< as in model.cpm; empty where training was stopped
  /// Mean distance of the joints of held-out poses from their true positions, before and after morphing, % of the
  /// pose's size (its Frobenius norm over the square root of the number of joints); NaN where none is held out.
  double before_percent = 0.0;
  double after_percent = 0.0;
  bool stopped = false;  ///< by Callbacks::stop, before the end; the checkpoint is saved
};

/// Learns the offsets of `pairs`; the loss is the mean absolute difference over the known joints. The same data,
/// options and number of threads give the same bits on the CPU, however often the run was killed and resumed.
///
/// Throws Error(kInvalidArgument) where the folder holds a run and neither resume nor overwrite is asked for,
/// Error(kBadInput) where the checkpoint is of other data or options, and Error(kComputation) where there are too few
/// pairs or the loss is not finite any more.
MorphReport TrainMorph(const MorphJob& job);

}  // namespace canonpose
