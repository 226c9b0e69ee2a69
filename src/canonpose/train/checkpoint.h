// A training run frozen between two steps: everything that the steps after it depend on.
//
// Data order and permutations come from the seed and the step number, so there is no generator state to keep.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "canonpose/model/model_file.h"

namespace canonpose {

/// Sums over the steps of the running epoch, for its line in metrics.jsonl.
struct EpochSums {
  double reprojection = 0.0;
  double view = 0.0;
  double camera = 0.0;
  double total = 0.0;
  std::int64_t steps = 0;
};

struct Checkpoint;

/// How far the short runs are of which the best is gone on with (TrainOptions::restarts).
struct RestartState {
  int running = 0;                         ///< the one that is running, or that was chosen
  std::vector<double> losses;              ///< of view mixing, at the end of each that is finished
  std::shared_ptr<const Checkpoint> best;  ///< the end of the best of them; none once they all are finished
};

/// HDF5: the model file's attributes and groups, attributes `step` and `epoch_sums`, and groups `first_moments` and
/// `second_moments` beside `parameters`. The learned perspective factor is the parameter "perspective".
/// While a run has restarts before it, also attribute `restart`, array `restart_losses` and group `best_restart`, laid
/// out like the file itself.
struct Checkpoint {
  ModelInfo info;  ///< info.steps is the number of steps done
  EpochSums sums;
  std::int64_t perspective_steps = 0;  ///< steps taken by the optimiser of the perspective factor
  NamedArrays parameters;
  NamedArrays first_moments;
  NamedArrays second_moments;
  RestartState restarts;
};

void WriteCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws Error(kBadInput) where the file is missing, damaged or of another version.
Checkpoint ReadCheckpoint(const std::filesystem::path& path);

/// Whether `path` is a checkpoint file.
bool IsCheckpoint(const std::filesystem::path& path);

}  // namespace canonpose
