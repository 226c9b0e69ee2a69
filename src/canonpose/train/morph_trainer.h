// Training a morphing network, into a folder. No LibTorch in this header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "canonpose/model/model_file.h"
#include "canonpose/train/morph_options.h"
#include "canonpose/train/morph_pairs.h"

namespace canonpose {

/// What is trained on, and where the result goes: RUN/model.cpm, checkpoint.h5 and metrics.jsonl as for a lifter.
struct MorphJob {
  MorphPairs pairs;
  Skeleton skeleton;
  DatasetSource source;                        ///< of the detected keypoints
  std::vector<std::string> data_files;         ///< for the record
  std::vector<std::string> data_fingerprints;  ///< likewise, and to know the data again
  MorphOptions options;
  std::filesystem::path run_folder;
  bool resume = false;     ///< go on from checkpoint.h5 where there is one
  bool overwrite = false;  ///< start anew although the folder holds a run
};

struct MorphReport {
  std::int64_t steps = 0;
  /// Mean distance of the held-out poses' joints from where they truly are, % of the pose's size (its Frobenius norm
  /// over the square root of the number of joints), before and after; NaN where none is held out.
  double before_percent = 0.0;
  double after_percent = 0.0;
  bool stopped = false;  ///< by Callbacks::stop, before the end; the checkpoint is saved
};

/// Learns the offsets of `pairs`: the mean absolute difference over the joints that are known is the loss. The same
/// data, options and threads give the same bits on the CPU, however often training was killed and resumed.
///
/// Throws Error(kInvalidArgument) where the folder holds a run and neither resume nor overwrite is asked for,
/// Error(kBadInput) where a checkpoint is of other data or options, Error(kComputation) where there are too few pairs
/// or the loss is no longer finite.
MorphReport TrainMorph(const MorphJob& job);

}  // namespace canonpose
