// Some of the cameras or subjects of a dataset.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Keeps only the cameras of these names in a sequence; names of other cameras have no effect.
void KeepCameras(Sequence& sequence, const std::vector<std::string>& names);

/// Keeps only the cameras of `choice` in every sequence: "A,B" by name, or a number N for the first N of each sequence
/// (unless a camera has that name). Sequences left without cameras are removed. Throws Error(kInvalidArgument) where
/// `choice` has no such form, Error(kBadInput) that names `file` where a camera is in no sequence, or a sequence has
/// fewer than N.
void KeepCameras(Dataset& dataset, const std::string& choice, const std::string& file);

/// Keeps only the sequences of the subjects "A,B", ignoring case. Throws Error(kInvalidArgument) where `choice` has no
/// such form, Error(kBadInput) that names `file` where a subject is missing.
void KeepSubjects(Dataset& dataset, const std::string& choice, const std::string& file);

/// Throws Error(kBadInput) that names `file` where no sequence was filmed by two cameras or more, which whatever learns
/// from several views needs.
void RequireTwoCameras(const Dataset& dataset, const std::string& file);

}  // namespace canonpose
