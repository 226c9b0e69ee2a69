// The group /skeleton, which is the same in all of our HDF5 files.
#pragma once

#include "canonpose/base/hdf5.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// Writes the attributes joints, parents, root, mirror, and name if there is one.
void WriteSkeleton(h5::Group& group, const Skeleton& skeleton);

/// Throws Error(kBadInput) where an attribute is missing or Skeleton::Problem() reports one.
Skeleton ReadSkeleton(const h5::Group& group);

}  // namespace canonpose
