// Training a lifter on datasets, into a folder. No LibTorch in this header.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/options.h"

namespace canonpose {

/// What is trained on, and where the result goes:
///
///   RUN/model.cpm       the model, written when training is done
///   RUN/checkpoint.h5   to resume from
///   RUN/metrics.jsonl   a line an epoch
///   RUN/train.log       what was shown
struct TrainJob {
  std::vector<Dataset> datasets;
  std::vector<std::string> data_files;  ///< their names, for the record
  /// The morphing network that the datasets' 2D poses went through, for the record: the model will apply it to what it
  /// lifts. Null: they did not.
  std::shared_ptr<const ModelFile> morph;
  TrainOptions options;
  std::filesystem::path run_folder;
  bool resume = false;     ///< go on from checkpoint.h5 where there is one
  bool overwrite = false;  ///< start anew although the folder holds a run
};

struct TrainReport {
  ModelInfo model;
  double seconds = 0.0;
  std::optional<double> validation_loss;  ///< reprojection loss of held-out frames, without camera consistency
  bool stopped = false;                   ///< by Callbacks::stop, before the end; the checkpoint is saved
};

/// The options a run in `run_folder` was started with; nothing where it holds no checkpoint.
std::optional<TrainOptions> RecordedOptions(const std::filesystem::path& run_folder);

/// Trains to the end, an interruption or a failure. With the same data, options and number of threads the model has the
/// same bits on the CPU, however often it was killed and resumed.
///
/// Throws Error(kInvalidArgument) where the folder holds a run and neither resume nor overwrite is asked for,
/// Error(kBadInput) where data differ from the checkpoint's or files cannot be written, Error(kComputation) where a
/// loss is no longer finite: model.cpm is then the last good one.
TrainReport Train(const TrainJob& job);

}  // namespace canonpose
