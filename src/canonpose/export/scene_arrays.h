// A scene as arrays of numbers in the axes and unit of a file, for the formats that are made of arrays.
#pragma once

#include <vector>

#include "canonpose/export/file_space.h"

namespace canonpose {

/// (T, J, 3), NaN where unknown.
std::vector<float> PositionsInFile(const PoseSequence& person, const FileSpace& space);
/// (T, J), NaN where unknown.
std::vector<float> DeviationsInFile(const PoseSequence& person, const FileSpace& space);
/// (T) seconds, NaN where neither stamps nor fps are known.
std::vector<double> SecondsOf(const PoseSequence& person);

/// Row by row, of one camera or T of them.
struct CameraArrays {
  std::vector<double> K;           ///< (N, 3, 3)
  std::vector<double> R;           ///< (N, 3, 3) camera_from_world
  std::vector<double> t;           ///< (N, 3)
  std::vector<double> distortion;  ///< (N, 5)
};
CameraArrays ArraysOfCameras(const std::vector<Camera>& cameras, const FileSpace& space);

}  // namespace canonpose
