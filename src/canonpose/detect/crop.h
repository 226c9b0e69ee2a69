// Squares of an image that the network looks at.
#pragma once

#include <array>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "canonpose/detect/pose.h"

namespace canonpose {

/// A square of an image, which may reach beyond its border.
struct Crop {
  Eigen::Vector2f corner{0.0F, 0.0F};  ///< top left, pixels of the image
  float size = 0.0F;                   ///< pixels
};

/// The square around a person whose pose was found in the frame before: about the hips (or what is seen, where they
/// are not), 1.9 times as far as the trunk's farthest joint and 1.2 times as far as the farthest of all, but no larger
/// than what holds the whole image. The rule is that of MoveNet's own demonstrations.
Crop CropAround(const DetectedPose& pose, int image_width, int image_height);

/// The pixels of a crop, resized to size x size; outside of the image they are black. `input` gets (size, size, 3),
/// red, green, blue in -1..1 by value · scale - 1, where value is 0..255.
void TakeCrop(const cv::Mat& image, const Crop& crop, int size, float scale, std::vector<float>& input);

/// The whole image, resized so that its longer side is `longest`, and filled up with black to multiples of 32. Returns
/// the height and width of the input, and how many pixels of the image one of the input is.
struct WholeImage {
  int height = 0;
  int width = 0;
  float image_pixels_per_pixel = 1.0F;
};
WholeImage TakeWholeImage(const cv::Mat& image, int longest, float scale, std::vector<float>& input);

}  // namespace canonpose
