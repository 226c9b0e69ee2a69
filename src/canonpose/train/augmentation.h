// Augmentation of supervised rows: new views, exchange of left and right, missing joints.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "canonpose/base/random.h"
#include "canonpose/data/dataset.h"
#include "canonpose/train/new_views.h"
#include "canonpose/train/options.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// Exchanges left and right of a row, exactly: x is negated and every joint changes places with its partner. Doing it
/// twice restores the row.
void FlipRow(const Skeleton& skeleton, const TrainingRow& row);

/// Removes one to four joints other than the root from a row, as if they had not been detected, and scales the others
/// as NormalisePose() does. At least half of the joints remain.
void DropJoints(const Skeleton& skeleton, Rng& rng, const TrainingRow& row);

class Augmentation {
 public:
  /// As `options.new_views`, `flips` and `joint_dropout` say. Keeps a reference to `set`.
  Augmentation(const std::vector<Dataset>& datasets, const TrainingSet& set, const TrainOptions& options);

  [[nodiscard]] bool any() const { return new_views_.has_value() || flips_ > 0.0 || joint_dropout_ > 0.0; }

  /// Changes a copy of row `set_row` at random.
  void Change(int set_row, Rng& rng, const TrainingRow& row) const;

 private:
  Skeleton skeleton_;
  double share_of_new_views_;
  double flips_;
  double joint_dropout_;
  std::optional<NewViews> new_views_;
};

/// The network's input, by `options`.
InputForm InputFormOf(const TrainOptions& options);

/// How rows are made of views, by `options`.
RowForm RowFormOf(const TrainOptions& options);

}  // namespace canonpose
