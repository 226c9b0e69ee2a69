// Shared by tests only: writes small videos and images whose frames tell their number.
#pragma once

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

namespace canonpose::testing {

/// A grey image; its brightness is the frame's number times 8, so that frames 0 to 31 differ.
inline cv::Mat NumberedImage(int number, cv::Size size) { return {size, CV_8UC3, cv::Scalar::all(8.0 * number)}; }

/// Which NumberedImage() this is, after lossy compression.
inline int NumberOf(const cv::Mat& image) { return static_cast<int>(std::lround(cv::mean(image)[1] / 8.0)); }

/// A video of numbered images, with Motion-JPEG, in the container that the name's extension says.
inline void WriteNumberedVideo(const std::filesystem::path& path, int frames, double fps = 25.0,
                               cv::Size size = {64, 48}) {
  cv::VideoWriter writer(path.string(), cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), fps, size);
  ASSERT_TRUE(writer.isOpened()) << path;
  for (int i = 0; i < frames; ++i) writer.write(NumberedImage(i, size));
}

/// A folder of numbered images, image_0.png and so on without leading zeros.
inline void WriteNumberedImages(const std::filesystem::path& folder, int frames, cv::Size size = {64, 48}) {
  std::filesystem::create_directories(folder);
  for (int i = 0; i < frames; ++i) {
    ASSERT_TRUE(cv::imwrite((folder / fmt::format("image_{}.png", i)).string(), NumberedImage(i, size)));
  }
}

}  // namespace canonpose::testing
