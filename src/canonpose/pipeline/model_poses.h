// A model's poses, to be evaluated.
#pragma once

#include "canonpose/lift/lifter.h"
#include "canonpose/pipeline/evaluate_datasets.h"

namespace canonpose {

/// What a model sees in each view by itself. Keeps a reference to `lifter`.
Predictor ModelPoses(const PoseLifter& lifter);

}  // namespace canonpose
