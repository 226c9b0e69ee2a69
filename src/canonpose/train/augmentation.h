// Makes more of a batch of supervised rows: new views, left-right mirrored poses, missing joints.
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

/// Mirrors a row left-right, exactly: x is negated and every joint changes places with its partner. Twice is nothing.
void FlipRow(const Skeleton& skeleton, const TrainingRow& row);

/// Takes one to four joints other than the root from a row, as if they had not been detected, and scales the others as
/// NormalisePose() does. At least half of the joints stay.
void DropJoints(const Skeleton& skeleton, Rng& rng, const TrainingRow& row);

class Augmentation {
 public:
  /// By new_views, flips and joint_dropout of `options`. Keeps a reference to `set`.
  Augmentation(const std::vector<Dataset>& datasets, const TrainingSet& set, const TrainOptions& options);

  [[nodiscard]] bool any() const { return new_views_.has_value() || flips_ > 0.0 || joint_dropout_ > 0.0; }

  /// Changes the copy of row `set_row`.
  void Change(int set_row, Rng& rng, const TrainingRow& row) const;

 private:
  Skeleton skeleton_;
  double share_of_new_views_;
  double flips_;
  double joint_dropout_;
  std::optional<NewViews> new_views_;
};

/// How `options` want the network to see a pose.
InputForm InputFormOf(const TrainOptions& options);

/// How `options` want rows to be made.
RowForm RowFormOf(const TrainOptions& options);

}  // namespace canonpose
