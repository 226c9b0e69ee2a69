// Whether data are suitable for a training, and how a training identifies them.
#pragma once

#include <string>

#include "canonpose/train/train_job.h"
#include "canonpose/train/training_set.h"

namespace canonpose {

/// A hash of what training uses of a dataset, as text: its 2D poses and, where it learns from them, its 3D poses and
/// cameras.
std::string FingerprintOf(const Dataset& dataset, const TrainOptions& options);

/// Throws Error(kBadInput) where the datasets have different joints, none has what `options` learn from, or a recording
/// is given twice.
void RequireSuitableData(const TrainJob& job);

/// The part of RequireSuitableData() that needs no 3D poses, to be called before they are solved: throws where there
/// are hardly any frames, or a recording is given twice.
void RequireRecordings(const TrainJob& job);

/// Throws Error(kBadInput) where there are too few usable frames to learn anything from.
void RequireEnoughFrames(const TrainJob& job, const TrainingSplit& split);

}  // namespace canonpose
