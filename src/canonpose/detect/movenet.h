// MoveNet, the detector of people's keypoints: its files, and its two networks at work. No LibTorch in this header.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/detect/conv_network.h"
#include "canonpose/detect/decoding.h"
#include "canonpose/detect/pose_network.h"

namespace canonpose {

/// Where the files of the networks are kept unless the caller says otherwise: $CANONPOSE_MODELS, or canonpose/movenet
/// in the user's folder for data ($XDG_DATA_HOME, or ~/.local/share).
std::filesystem::path DefaultModelFolder();

/// The files of the two networks, movenet-thunder and movenet-multipose.
struct MoveNetFiles {
  GraphModel thunder;
  GraphModel multipose;
  std::uint64_t fingerprint = 0;  ///< of all files

  /// Throws Error(kBadInput) where a file is missing or damaged.
  static MoveNetFiles Read(const std::filesystem::path& folder);
};

/// For one thread; several objects may share the files. Results do not depend on the thread.
class MoveNet final : public PoseNetwork {
 public:
  static constexpr int kCropSize = 256;
  /// The longer side of the image in which people are looked for. People smaller than a tenth of it are not found.
  static constexpr int kImageSize = 512;

  /// Throws Error(kBadInput) where the files are not those of the two networks.
  explicit MoveNet(const MoveNetFiles& files);

  std::vector<DetectedPose> FindPeople(const cv::Mat& image) override;
  DetectedPose PoseInCrop(const cv::Mat& image, const Crop& crop) override;
  Appearance AppearanceOf(const cv::Mat& image, const DetectedPose& pose) override;

  /// The network for crops on an input (256, 256, 3) of red, green, blue in 0..255: positions in 0..1.
  DetectedPose PoseOf(const std::vector<float>& rgb);

 private:
  /// One of the two networks with what its graph does before the convolutions.
  struct Network {
    explicit Network(const GraphModel& model, bool has_boxes);
    [[nodiscard]] PoseMaps Evaluate(const std::vector<float>& input, int height, int width) const;
    float scale;  ///< of values in 0..255, before 1 is subtracted
    ConvNetwork convolutions;
  };

  Network thunder_;
  Network multipose_;
  std::vector<float> centre_weight_;
  std::vector<float> input_;
};

}  // namespace canonpose
