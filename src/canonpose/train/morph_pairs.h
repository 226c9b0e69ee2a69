// What a morphing network learns from: 2D poses as a detector finds them, and where their joints truly are.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// N poses of J joints, seen at the same moment by the detector and in truth.
struct MorphPairs {
  int joint_count = 0;
  std::vector<float> input;  ///< (N, 3J) detected, normalised (geometry/normalisation.h): planar keypoints, confidences
  std::vector<float> offset;  ///< (N, 2J) planar: true minus detected, in the unit of the input; NaN where unknown

  [[nodiscard]] std::size_t count() const {
    return joint_count == 0 ? 0 : input.size() / (3 * static_cast<std::size_t>(joint_count));
  }
};

/// Adds the pairs of a dataset whose truth and calibration say where the joints are in the image. Throws
/// Error(kBadInput) naming `file` where no view has both.
void AddPairsOfTruth(const Dataset& detected, const std::string& file, MorphPairs& pairs);

/// Adds the pairs of two datasets with the same joints, whose sequences, cameras and frames are matched by name and
/// number: keypoints of the detector and true ones. Throws Error(kBadInput) naming the files where they do not belong
/// together.
void AddPairsOfDatasets(const Dataset& detected, const std::string& detected_file, const Dataset& exact,
                        const std::string& exact_file, MorphPairs& pairs);

}  // namespace canonpose
