#include "canonpose/detect/crop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace canonpose {
namespace {

constexpr float kTrunkMargin = 1.9F;
constexpr float kBodyMargin = 1.2F;
constexpr int kMultiple = 32;

/// Between the hips, or the shoulders, or the joints that are seen.
Eigen::Vector2f MiddleOf(const DetectedPose& pose) {
  for (const auto& [left, right] : {std::pair(kLHip, kRHip), std::pair(kLShoulder, kRShoulder)}) {
    if (IsSeen(pose.joints[left]) && IsSeen(pose.joints[right])) {
      return 0.5F * (pose.joints[left].position + pose.joints[right].position);
    }
  }
  return CentreOf(pose);
}

float Reach(const Eigen::Vector2f& from, const PosePoint& to) {
  return IsSeen(to) ? (to.position - from).cwiseAbs().maxCoeff() : 0.0F;
}

/// The part of an image that a crop needs, in squares of `factor` pixels.
cv::Rect WholeCells(const Crop& crop, int factor, const cv::Size& image) {
  const auto cells = [&](float begin, int extent) {
    const int first =
        std::clamp(static_cast<int>(std::floor(begin / static_cast<float>(factor))) - 1, 0, extent / factor);
    const int last = std::clamp(static_cast<int>(std::ceil((begin + crop.size) / static_cast<float>(factor))) + 1,
                                first, extent / factor);
    return std::pair(first * factor, (last - first) * factor);
  };
  const auto [x, width] = cells(crop.corner.x(), image.width);
  const auto [y, height] = cells(crop.corner.y(), image.height);
  return {x, y, width, height};
}

/// Values of an 8-bit image in blue, green, red, to floats in red, green, blue at the top left of an input.
void Normalise(const cv::Mat& image, float scale, int input_width, std::vector<float>& input) {
  for (int y = 0; y < image.rows; ++y) {
    const auto* from = image.ptr<unsigned char>(y);
    float* to = &input[static_cast<std::size_t>(y) * static_cast<std::size_t>(input_width) * 3];
    for (int x = 0; x < image.cols; ++x, from += 3, to += 3) {
      to[0] = static_cast<float>(from[2]) * scale - 1.0F;
      to[1] = static_cast<float>(from[1]) * scale - 1.0F;
      to[2] = static_cast<float>(from[0]) * scale - 1.0F;
    }
  }
}

}  // namespace

Crop CropAround(const DetectedPose& pose, int image_width, int image_height) {
  const Eigen::Vector2f middle = MiddleOf(pose);
  float trunk = 0.0F;
  for (const std::size_t joint : {kLShoulder, kRShoulder, kLHip, kRHip}) {
    trunk = std::max(trunk, Reach(middle, pose.joints[joint]));
  }
  float body = 0.0F;
  for (const PosePoint& point : pose.joints) body = std::max(body, Reach(middle, point));
  const auto width = static_cast<float>(image_width);
  const auto height = static_cast<float>(image_height);
  const float to_border = std::max({middle.x(), width - middle.x(), middle.y(), height - middle.y()});
  constexpr float kSmallestHalf = 8.0F;
  const float half = std::max(kSmallestHalf, std::min(std::max(kTrunkMargin * trunk, kBodyMargin * body), to_border));
  return {middle - Eigen::Vector2f::Constant(half), 2.0F * half};
}

void TakeCrop(const cv::Mat& image, const Crop& crop, int size, float scale, std::vector<float>& input) {
  cv::Mat source = image;
  Eigen::Vector2f corner = crop.corner;
  float pixels = crop.size / static_cast<float>(size);
  // Where many pixels become one, their mean is taken, since interpolation would look at four of them.
  if (const int factor = static_cast<int>(pixels); factor >= 2) {
    const cv::Rect inside = WholeCells(crop, factor, image.size());
    if (!inside.empty()) {
      cv::resize(image(inside), source, inside.size() / factor, 0.0, 0.0, cv::INTER_AREA);
      corner -= Eigen::Vector2f(static_cast<float>(inside.x), static_cast<float>(inside.y));
      corner /= static_cast<float>(factor);
      pixels /= static_cast<float>(factor);
    }
  }
  // A pixel's centre is half a pixel from its corner.
  const float to_centre = 0.5F * pixels - 0.5F;
  const cv::Matx23f source_from_input(pixels, 0.0F, corner.x() + to_centre, 0.0F, pixels, corner.y() + to_centre);
  cv::Mat resized;
  cv::warpAffine(source, resized, source_from_input, cv::Size(size, size), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT, cv::Scalar());
  input.resize(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 3);
  Normalise(resized, scale, size, input);
}

WholeImage TakeWholeImage(const cv::Mat& image, int longest, float scale, std::vector<float>& input) {
  const float pixels = static_cast<float>(std::max(image.cols, image.rows)) / static_cast<float>(longest);
  const cv::Size size(std::max(1, static_cast<int>(std::lround(static_cast<float>(image.cols) / pixels))),
                      std::max(1, static_cast<int>(std::lround(static_cast<float>(image.rows) / pixels))));
  cv::Mat resized;
  cv::resize(image, resized, size, 0.0, 0.0, pixels > 1.0F ? cv::INTER_AREA : cv::INTER_LINEAR);
  const auto filled = [](int extent) { return (extent + kMultiple - 1) / kMultiple * kMultiple; };
  const WholeImage whole{filled(size.height), filled(size.width), pixels};
  constexpr float kBlack = -1.0F;
  input.assign(static_cast<std::size_t>(whole.height) * static_cast<std::size_t>(whole.width) * 3, kBlack);
  Normalise(resized, scale, whole.width, input);
  return whole;
}

}  // namespace canonpose
