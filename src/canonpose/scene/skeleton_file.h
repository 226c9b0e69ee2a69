// The group /skeleton, the same in every file of ours.
#pragma once

#include "canonpose/base/hdf5.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// Attributes joints, parents, root, mirror, and name where there is one.
void WriteSkeleton(h5::Group& group, const Skeleton& skeleton);

/// Throws Error(kBadInput) where one is missing or Skeleton::Problem() finds fault with it.
Skeleton ReadSkeleton(const h5::Group& group);

}  // namespace canonpose
