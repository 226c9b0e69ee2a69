// Compares where solved people are in the world with where they were.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/data/sequence_triangulation.h"

namespace canonpose {

/// Means over all joints of all frames of recordings by static cameras, each joint counted once, whatever the number of
/// cameras.
struct WorldErrors {
  /// After the one similarity that fits all people and frames of a recording best: WA-MPJPE, as Ye et al. (SLAHMR, CVPR
  /// 2023) define it for stretches of a video.
  double wa_mpjpe_mm = 0.0;
  /// After the rotation and translation, without scale, that take the solved cameras' centres to the calibrated ones:
  /// W-MPJPE, as Mueller et al. (HSfM, CVPR 2025) define it. Where the centres do not determine a rotation, as those of
  /// two cameras, it is the mean of the cameras'. Nothing where solved poses are not in millimetres or fewer than two
  /// cameras are calibrated.
  std::optional<double> w_mpjpe_mm;
  /// After a similarity of each pose of each person: PA-MPJPE.
  double pa_mpjpe_mm = 0.0;
};

/// Collects the errors of datasets that are solved. Sequences of one capture are one recording: its people share a
/// world.
class WorldComparison {
 public:
  /// Joints of these indices are not compared.
  explicit WorldComparison(std::vector<int> left_out = {}) : left_out_(std::move(left_out)) {}

  /// `reference` in the order of the dataset's sequences. Cameras with a calibration are used, or, where none has one,
  /// the first with a solution and a reference: then the world is that camera's frame.
  void Add(const Dataset& dataset, const std::vector<SequencePoses>& reference);
  /// Nothing where no recording by static cameras was solved.
  [[nodiscard]] std::optional<WorldErrors> Means() const;

 private:
  struct Mean {
    double sum = 0.0;
    long count = 0;
  };
  void AddCapture(const Dataset& dataset, const std::vector<SequencePoses>& reference, const std::string& capture);

  std::vector<int> left_out_;
  Mean whole_;
  Mean by_cameras_;
  Mean by_pose_;
};

}  // namespace canonpose
