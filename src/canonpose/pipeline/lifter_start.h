// The starts of self-calibration that need a lifter. A build without LibTorch has none
// (lifter_start_absent.cc).
#pragma once

#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// Whether the starter lifts bodies of these joints.
bool StarterCanStart(const Skeleton& skeleton);

/// The poses that the lifter BootstrapOptions::model estimates in each view.
StartPoses StartFromModel(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

/// The poses that the starter estimates in each view. It has joints of its own, from which the dataset's are made.
StartPoses StartFromStarter(const Dataset& dataset, const std::string& device);

/// The poses of a lifter that is first trained on the dataset itself, by the method.
StartPoses StartFromMethod(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

}  // namespace canonpose
