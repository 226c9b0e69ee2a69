// The detections of Human3.6M that CanonPose's authors published: detections.pickle.
#pragma once

#include "canonpose/data/readers/benchmarks/benchmark.h"

namespace canonpose {

/// Reads one pickle {subjects: N whole numbers, poses_2d_pred: {camera: (N, 32) px}, confidences: {camera: (N, 16)}}
/// whose rows are x of all joints, then y of all, in the order of canonpose-16, or of mpii-16 if that is the `layout`.
/// The order is checked by anatomy. There is one sequence per subject, "S5", with its rows in the file's order. If
/// confidences exceed 1, all are divided by the largest. The file does not contain the image size, which is 1000x1002
/// unless given. Throws Error(kBadInput), and Error(kInvalidArgument) for another layout.
Dataset ImportCanonPoseDetections(const BenchmarkOptions& options);

}  // namespace canonpose
