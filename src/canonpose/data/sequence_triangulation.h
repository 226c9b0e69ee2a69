// 3D poses of a whole sequence, from its calibrated cameras.
#pragma once

#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// For each camera of a sequence the poses in that camera's frame in millimetres; empty for a camera whose poses are
/// not known at all.
struct SequencePoses {
  std::vector<PoseSequence> poses_in_camera;
};

/// Triangulates every joint of every frame from all calibrated cameras of a sequence (geometry/triangulation.h,
/// Triangulate()). A joint is unknown where fewer than two cameras see it, its rays are nearly parallel, or it would
/// lie behind a camera that sees it. Cameras without calibration get no poses. Frames are those of
/// one time: views are shifted by their `time_offset_seconds` or `solved_frames`, between their frames by linear
/// interpolation, and frames that `solve` left out of a view are not used.
/// `reprojection_errors_px`, where given, receives the error of every triangulated joint in every view that sees it,
/// appended to what it holds.
SequencePoses TriangulateSequence(const Sequence& sequence, const Skeleton& skeleton,
                                  std::vector<double>* reprojection_errors_px = nullptr);

}  // namespace canonpose
