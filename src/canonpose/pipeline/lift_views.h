// What `lift` does: the 2D poses of one camera from a file, lifted, scaled, smoothed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/lift/pose_lifter.h"
#include "canonpose/scene/lifted_poses.h"

namespace canonpose {

/// The 2D poses to lift, and the numbers of their frames.
struct LiftInput {
  CameraView view;
  std::vector<std::int64_t> frames;
  double fps = 0.0;
};

/// Which 2D poses of a file.
struct LiftChoice {
  std::string camera;  ///< empty: the only one

  // Of a dataset.
  std::string sequence;  ///< empty: the only one
  std::string frames;    ///< "A-B", empty: all

  // Of a detector's files.
  std::string format;                   ///< empty: recognised by the content
  std::string layout;                   ///< empty: that of the training data
  std::array<int, 2> image_size{0, 0};  ///< 0: unknown
  int person = 1;                       ///< 1: the most prominent
};

/// Reads a dataset, or a detector's files of one camera. Warns where the keypoints were not moved by the morphing
/// network that the lifter's training data went through. Throws Error(kBadInput).
LiftInput ReadLiftInput(const std::filesystem::path& path, const LiftChoice& choice, const PoseLifter& lifter);

struct LiftOptions {
  std::optional<double> height_m;    ///< the person's, for poses in millimetres
  std::optional<int> smooth_frames;  ///< Smooth()
  bool fill = false;                 ///< keep the network's guess for joints that the view does not show

  /// Throws Error(kInvalidArgument).
  void Validate() const;
};

/// Lifts all frames. `file` is the input's name for messages. Throws Error(kBadInput) where the view lacks the image
/// size that the lifter needs, and Error(kInvalidArgument) where there are fewer frames than are to be smoothed over.
LiftedPoses LiftViews(const PoseLifter& lifter, const LiftInput& input, const LiftOptions& options,
                      const std::string& file);

}  // namespace canonpose
