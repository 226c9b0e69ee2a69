// Whether data are suitable for a training, and how a training identifies them.
#pragma once

#include <string>

#include "canonpose/train/train_job.h"

namespace canonpose {

/// A hash of what training uses of a dataset, as text: its 2D poses and, where it learns from them, its 3D poses and
/// cameras.
std::string FingerprintOf(const Dataset& dataset, const TrainOptions& options);

/// Throws Error(kBadInput) where the datasets have different joints, or none has what `options` learn from.
void RequireSuitableData(const TrainJob& job);

}  // namespace canonpose
