// SLEAP's analysis HDF5: one array of all animals' points over a video.
#pragma once

#include <filesystem>
#include <vector>

#include "canonpose/data/readers/detections.h"

namespace canonpose {

/// The cameras of a path: an analysis file, or a folder with one per camera. Throws Error(kBadInput).
std::vector<CameraInput> FindSleapCameras(const std::filesystem::path& path);

/// Reads one camera. `tracks` is (tracks, 2, nodes, frames), or in sleap-io's other order (frames, tracks, nodes, 2);
/// which of them follows from the numbers of nodes and of named tracks. The layout is that of `node_names`, its bones
/// those of `edge_inds`. Confidences are the `point_scores`, 1 where there is none, as for points that a person placed.
/// A track is a track. The first frame of the file is frame 0. Throws Error(kBadInput).
DetectedCamera ReadSleap(const CameraInput& input);

/// Whether a file is one.
bool IsSleapFile(const std::filesystem::path& file);

}  // namespace canonpose
