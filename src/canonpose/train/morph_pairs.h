// What a morphing network learns from: 2D poses as detected, and the true positions of their joints.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// N poses of J joints, detected and true.
struct MorphPairs {
  int joint_count = 0;
  std::vector<float> input;  ///< (N, 3J) detected, normalised (geometry/normalisation.h): planar keypoints, confidences
  std::vector<float> offset;  ///< (N, 2J) planar: true minus detected, in the unit of the input; NaN where unknown

  [[nodiscard]] std::size_t count() const {
    return joint_count == 0 ? 0 : input.size() / (3 * static_cast<std::size_t>(joint_count));
  }
};

/// Adds the pairs of a dataset with truth and calibration, which give the true positions in the image. Throws
/// Error(kBadInput) naming `file` where no view has both.
void AddPairsOfTruth(const Dataset& detected, const std::string& file, MorphPairs& pairs);

/// Adds the pairs of two datasets with the same joints, detected and true keypoints of the same recording. Sequences
/// and cameras are matched by name, frames by number. Throws Error(kBadInput) naming the files where they do not match.
void AddPairsOfDatasets(const Dataset& detected, const std::string& detected_file, const Dataset& exact,
                        const std::string& exact_file, MorphPairs& pairs);

}  // namespace canonpose
