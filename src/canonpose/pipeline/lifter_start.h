// Starts of the self-calibration that a lifter gives. Where the program is built without LibTorch there are none
// (lifter_start_absent.cc).
#pragma once

#include <string>

#include "canonpose/data/dataset.h"
#include "canonpose/pipeline/bootstrap.h"
#include "canonpose/solve/observations.h"

namespace canonpose {

/// Whether the starter lifts bodies of these joints.
bool StarterCanStart(const Skeleton& skeleton);

/// What the lifter BootstrapOptions::model sees in each view.
StartPoses StartFromModel(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

/// What the starter sees in each view: its own joints, of which the dataset's are made again.
StartPoses StartFromStarter(const Dataset& dataset, const std::string& device);

/// What a lifter sees that is trained on the dataset first, by the method.
StartPoses StartFromMethod(const Dataset& dataset, const std::string& file, const BootstrapOptions& options);

}  // namespace canonpose
