// Whether data suit a training, and what it records of them.
#pragma once

#include <string>

#include "canonpose/train/trainer.h"

namespace canonpose {

/// A hash of what training sees of a dataset, as text: its 2D poses and, where they are learnt from, its 3D poses and
/// cameras.
std::string FingerprintOf(const Dataset& dataset, const TrainOptions& options);

/// Throws Error(kBadInput) where the datasets have different joints, or none has what `options` are to learn from.
void RequireSuitableData(const TrainJob& job);

}  // namespace canonpose
