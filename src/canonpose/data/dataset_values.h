// What the values in a dataset file must be, whichever array they are in.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "canonpose/base/hdf5.h"
#include "canonpose/skeleton/skeleton.h"

namespace canonpose {

/// The file and the place in it of the values being checked, for messages.
struct DatasetPlace {
  std::string file;
  std::string group;
  const Skeleton* skeleton;

  /// Throws the Error(kBadInput) for a value of `array`.
  [[noreturn]] void Fail(const std::string& array, std::size_t frame, std::size_t joint, const std::string& expected,
                         float found, const std::string& advice) const;
};

/// Checks keypoints (T, J, 2) and confidences (T, J); a joint that is missing in one becomes missing in both. Throws
/// Error(kBadInput).
void CheckKeypoints(const DatasetPlace& place, std::vector<float>& keypoints, std::vector<float>& confidence);

/// Checks 3D poses (T, J, 3); a joint with one unknown coordinate becomes unknown in all three. Throws
/// Error(kBadInput).
void CheckPoses(std::vector<float>& poses, const std::string& array, const DatasetPlace& place);

/// The array `name`, which must have this shape; `meaning` says for the message what its dimensions are. Throws
/// Error(kBadInput).
std::vector<float> ReadArray(const h5::Group& group, const std::string& name, const std::vector<std::size_t>& shape,
                             const std::string& meaning);

}  // namespace canonpose
