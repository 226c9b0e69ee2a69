// Training a lifter on datasets. No LibTorch in this header.
#pragma once

#include <filesystem>
#include <optional>

#include "canonpose/model/model_file.h"
#include "canonpose/train/options.h"
#include "canonpose/train/train_job.h"

namespace canonpose {

struct TrainReport {
  ModelFile model;  ///< as in model.cpm; empty where training was stopped
  double seconds = 0.0;
  std::optional<double> validation_loss;  ///< of held-out frames, without camera consistency
  bool stopped = false;                   ///< by Callbacks::stop, before the end; the checkpoint is saved
};

/// The options a run in `run_folder` was started with; nothing where it holds no checkpoint.
std::optional<TrainOptions> RecordedOptions(const std::filesystem::path& run_folder);

/// Trains to the end, an interruption or a failure. With the same data, options and number of threads the model has the
/// same bits on the CPU, however often the run was killed and resumed.
///
/// The datasets must hold what `options.supervision` learns from: solved poses, as preset best asks for, are those that
/// Solve() put there before. The name in `options.preset` is recorded and has no other effect.
///
/// Throws Error(kInvalidArgument) where the folder holds a run and neither resume nor overwrite is asked for,
/// Error(kBadInput) where the data lack something, differ from the checkpoint's, or files cannot be written, and
/// Error(kComputation) where a loss is not finite any more: model.cpm is then the last good one.
TrainReport Train(const TrainJob& job);

}  // namespace canonpose
