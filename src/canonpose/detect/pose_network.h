// What the tracker asks of a detector; its network implements it, and so do recordings of what a network said.
#pragma once

#include <array>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "canonpose/detect/crop.h"
#include "canonpose/detect/pose.h"

namespace canonpose {

/// Mean colours of a person's trunk and thighs: red, green, blue of each in 0..1; NaN where they are not seen.
using Appearance = std::array<float, 6>;

class PoseNetwork {
 public:
  PoseNetwork() = default;
  virtual ~PoseNetwork() = default;
  PoseNetwork(const PoseNetwork&) = delete;
  PoseNetwork& operator=(const PoseNetwork&) = delete;

  /// Several people in a whole image, roughly.
  virtual std::vector<DetectedPose> FindPeople(const cv::Mat& image) = 0;
  /// The person in the middle of a crop, precisely.
  virtual DetectedPose PoseInCrop(const cv::Mat& image, const Crop& crop) = 0;
  /// What a person looks like.
  virtual Appearance AppearanceOf(const cv::Mat& image, const DetectedPose& pose) = 0;
};

}  // namespace canonpose
