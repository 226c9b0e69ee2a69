// Several datasets as one.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// One dataset with the sequences of all of them, in their order; `files` are their names. Captures of one name become
/// one capture: their cameras are the same. Sequences of one name get that of their file before it, and so do captures
/// that a file does not name (Sequence::capture_is_named), which no other file shares.
///
/// What is known of the source is that of the first dataset; a warning says where others differ. A single dataset is
/// returned as it is. Throws Error(kBadInput) where the joints differ.
Dataset MergeDatasets(std::vector<Dataset> datasets, const std::vector<std::string>& files);

}  // namespace canonpose
