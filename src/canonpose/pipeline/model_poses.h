// A model's poses, for evaluation.
#pragma once

#include "canonpose/lift/pose_lifter.h"
#include "canonpose/pipeline/evaluate_datasets.h"

namespace canonpose {

/// Lifts each view by itself. Keeps a reference to `lifter`.
Predictor ModelPoses(const PoseLifter& lifter);

}  // namespace canonpose
