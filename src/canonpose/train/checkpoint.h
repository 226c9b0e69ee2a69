// The state of a training run between two steps: everything that the steps after it depend on.
//
// The order of the data and all permutations follow from the seed and the step number, so no generator state is kept.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "canonpose/model/model_file.h"

namespace canonpose {

/// The parameter of checkpoints that holds the learned perspective factor; a model file has it as an attribute instead.
inline constexpr const char* kPerspectiveParameter = "perspective";

/// Sums over the steps of the running epoch, for its line in metrics.jsonl.
struct EpochSums {
  double reprojection = 0.0;
  double view = 0.0;
  double camera = 0.0;
  double total = 0.0;
  std::int64_t steps = 0;

  /// The sums divided by the number of steps; zero without steps.
  [[nodiscard]] EpochSums Mean() const;
};

struct Checkpoint;

/// How far the short runs are, of which the best is continued (TrainOptions::restarts).
struct RestartState {
  int running = 0;                         ///< the one that is running, or that was chosen
  std::vector<double> losses;              ///< of view consistency, at the end of each finished one
  std::shared_ptr<const Checkpoint> best;  ///< the end of the best finished one; null once all are finished
};

/// In HDF5:
///
///   as in a model file, with `steps` the number of steps done and the perspective factor among `parameters`
///   attributes sum_reprojection, sum_view, sum_camera, sum_total, sum_steps, perspective_steps, restart
///   groups `first_moments` and `second_moments`, laid out like `parameters`
///   array `restart_losses` and group `best_restart`, laid out like the file itself, while restarts are running
struct Checkpoint {
  ModelInfo info;  ///< info.steps is the number of steps done
  EpochSums sums;
  std::int64_t perspective_steps = 0;  ///< steps of the perspective factor's optimiser
  NamedArrays parameters;
  NamedArrays first_moments;
  NamedArrays second_moments;
  RestartState restarts;
};

/// The model as it is in a checkpoint.
ModelFile ModelOf(const Checkpoint& checkpoint);

void WriteCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Throws Error(kBadInput) where the file is missing, damaged or of another version.
Checkpoint ReadCheckpoint(const std::filesystem::path& path);

/// Whether `path` is a checkpoint file.
bool IsCheckpoint(const std::filesystem::path& path);

}  // namespace canonpose
