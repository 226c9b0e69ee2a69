// Some of the cameras or subjects of a dataset.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Cuts a sequence down to the cameras of these names; names that it has not change nothing.
void KeepCameras(Sequence& sequence, const std::vector<std::string>& names);

/// Cuts every sequence down to the cameras of `choice`: "A,B" by name, or a number N for the first N of each sequence
/// (unless a camera has that name). Sequences without any disappear. Throws Error(kInvalidArgument) where it is no
/// choice, Error(kBadInput) naming `file` where a camera is in no sequence, or a sequence has fewer than N.
void KeepCameras(Dataset& dataset, const std::string& choice, const std::string& file);

/// Cuts a dataset down to the sequences of the subjects "A,B"; case does not matter. Throws Error(kInvalidArgument)
/// where it is no choice, Error(kBadInput) naming `file` where one is not there.
void KeepSubjects(Dataset& dataset, const std::string& choice, const std::string& file);

}  // namespace canonpose
