// Recordings that are given twice, under two names or as parts of each other: what is held out of one copy would be
// learned from the other.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// Throws Error(kBadInput) where two sequences of the datasets share most of the frames of the shorter one, whatever
/// their names and captures: a frame is known by a fingerprint of a view's keypoints. `files` are the datasets' names.
void RequireDistinctRecordings(const std::vector<Dataset>& datasets, const std::vector<std::string>& files);

}  // namespace canonpose
