// What training sees of datasets: every usable 2D pose, normalised, and which of them were taken at the same moment.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canonpose/data/dataset.h"

namespace canonpose {

/// One camera's view in a frame.
struct TrainingView {
  int camera = 0;  ///< index into the cameras of the capture
  int row = 0;     ///< index into TrainingSet::keypoints
};

/// One moment, seen by at least one camera.
struct TrainingFrame {
  int capture = 0;  ///< frames of one capture share their cameras
  int clip = 0;     ///< consecutive frames of one sequence, the unit that statistics are averaged over
  std::vector<TrainingView> views;
  int sequence = 0;      ///< number of its sequence, counted over all datasets
  double seconds = 0.0;  ///< since the sequence's first frame; 30 frames a second where the rate is unknown
};

/// N poses of J joints.
struct TrainingSet {
  int joint_count = 0;
  std::vector<float> keypoints;   ///< (N, 2J) planar, normalised (geometry/normalisation.h)
  std::vector<float> confidence;  ///< (N, J)
  /// (N, 3J) planar, in the camera's frame, centred on the root and of unit Frobenius norm; NaN where unknown. Empty
  /// unless asked for.
  std::vector<float> truth;
  std::vector<TrainingFrame> frames;
  std::vector<std::uint8_t> static_captures;  ///< per capture: whether its cameras stand still

  [[nodiscard]] int row_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(confidence.size()) / joint_count;
  }
};

struct TrainingSplit {
  TrainingSet training;
  TrainingSet validation;
  int frames_left_out = 0;  ///< seen by too few cameras: fewer than two, or none whose truth is known
};

/// What the network is to learn from.
enum class TrainingTarget {
  kViews,  ///< other views: frames seen by two cameras or more
  kTruth,  ///< the true 3D poses: views whose truth has the root and at least half of the joints
};

/// The frames of all datasets, `validation_share` of them held out: the end of every 50 frames of a sequence. Sequences
/// of one capture share their cameras by name, also across datasets where the capture is named in the file. Throws
/// Error(kComputation) where no frame can be used.
TrainingSplit MakeTrainingSplit(const std::vector<Dataset>& datasets, double validation_share,
                                TrainingTarget target = TrainingTarget::kViews);

}  // namespace canonpose
