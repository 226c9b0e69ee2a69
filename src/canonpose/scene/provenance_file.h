// What is known of a world, as attributes of the groups of our files.
#pragma once

#include <string>

#include "canonpose/base/hdf5.h"
#include "canonpose/scene/provenance.h"

namespace canonpose {

/// Reads the attributes `prefix`up, floor and scale (strings: what they are known from),
/// `prefix`up_uncertainty_degrees, floor_uncertainty and scale_uncertainty_percent; any of them may be absent. Throws
/// Error(kBadInput).
WorldProvenance ReadWorldProvenance(const h5::Group& group, const std::string& prefix = "");

/// Writes those that are known.
void WriteWorldProvenance(h5::Group& group, const WorldProvenance& world, const std::string& prefix = "");

}  // namespace canonpose
