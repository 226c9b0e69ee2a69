// The tracks of a camera in a dataset file: the group `tracks`, with one group per track.
#pragma once

#include "canonpose/base/hdf5.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/dataset_values.h"

namespace canonpose {

/// Reads the tracks of a camera, whose group is `camera`, into `view`. Its `keypoints` and `confidence` become those of
/// nobody. `frame_count` is that of the sequence, -1 where its attribute is missing. Throws Error(kBadInput).
void ReadTracks(const h5::Group& camera, const Skeleton& skeleton, int frame_count, CameraView& view);

/// Writes the tracks of `view`, of T = `frame_count` frames, into the group of its camera. Throws Error(kBadInput)
/// where values cannot be keypoints or a name cannot be a group's.
void WriteTracks(const DatasetPlace& place, CameraView& view, int frame_count, h5::Group& camera);

}  // namespace canonpose
