// What training uses of datasets: every usable 2D pose, normalised, and which of them were taken at the same moment.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "canonpose/data/dataset.h"
#include "canonpose/model/model_file.h"
#include "canonpose/train/options.h"

namespace canonpose {

/// One camera's view in a frame.
struct TrainingView {
  int camera = 0;  ///< index into the cameras of the capture
  int row = 0;     ///< index into TrainingSet::keypoints
};

/// One moment, seen by at least one camera.
struct TrainingFrame {
  int capture = 0;  ///< frames of one capture share their cameras
  int clip = 0;     ///< a run of consecutive frames of one sequence; statistics treat clips as independent
  std::vector<TrainingView> views;
  int sequence = 0;      ///< number of its sequence, counted over all datasets
  double seconds = 0.0;  ///< since the sequence's first frame; 30 frames per second where the rate is unknown
};

/// Where a row of a set comes from: indices into the datasets, their sequences and cameras, and the frame.
struct RowSource {
  int dataset = 0;
  int sequence = 0;
  int camera = 0;
  int frame = 0;
};

/// N poses of J joints.
struct TrainingSet {
  int joint_count = 0;
  std::vector<float> keypoints;   ///< (N, 2J) planar, normalised (geometry/normalisation.h)
  std::vector<float> confidence;  ///< (N, J)
  /// (N, 3J) planar 3D poses to learn, see NormaliseTarget(). Empty unless asked for.
  std::vector<float> target;
  std::vector<float> target_weight;  ///< (N, J) how much a joint of the target counts; empty: all the same
  std::vector<RowSource> sources;    ///< (N)
  /// (N) the rotation of a row's root onto the optical axis (model/pose_input.h); empty where there is none.
  std::vector<Eigen::Matrix3f> turned_from_camera;
  std::vector<TrainingFrame> frames;
  std::vector<std::uint8_t> static_captures;  ///< per capture: whether its cameras are static

  [[nodiscard]] int row_count() const {
    return joint_count == 0 ? 0 : static_cast<int>(confidence.size()) / joint_count;
  }
};

/// A row of a set or a batch, to be changed in place: the values of its J joints, as above; null where there are none.
struct TrainingRow {
  float* keypoints = nullptr;
  float* confidence = nullptr;
  float* target = nullptr;
  float* target_weight = nullptr;
};

struct TrainingSplit {
  TrainingSet training;
  TrainingSet validation;
  int frames_left_out = 0;  ///< seen by too few cameras: fewer than two, or none whose target is known
};

/// What the network learns from.
enum class TrainingTarget {
  kViews,   ///< other views: frames seen by two cameras or more
  kTruth,   ///< true 3D poses: views whose truth has the root and at least half of the joints
  kSolved,  ///< likewise the 3D poses that Solve() found, or that LearnFromTriangulation() put in their place
};

/// Triangulated poses take the place of solved ones (train/triangulated_targets.h).
TrainingTarget TargetOf(Supervision supervision);

/// The poses of a view to learn and the cameras that belong to them; empty where there are none.
const PoseSequence& TargetPoses(const CameraView& view, TrainingTarget target);
const std::vector<Camera>& TargetCameras(const CameraView& view, TrainingTarget target);

/// The target (3J) that a pose (J, 3) makes: rotated, centred on the root, divided by its Frobenius norm over the known
/// joints, planar; NaN where unknown. Returns the norm, or nothing, `target` unspecified, where the root or more than
/// half of the joints are unknown.
std::optional<double> NormaliseTarget(const float* pose, int joint_count, int root,
                                      const Eigen::Matrix3d& turned_from_camera, float* target);

/// How MakeTrainingSplit() makes rows of views.
struct RowForm {
  TrainingTarget target = TrainingTarget::kViews;
  InputForm input;  ///< the target is rotated like the input
  bool uncertainty_weights = false;
};

/// The frames of all datasets. `validation_share` of them is held out: the end of every 50 frames of a sequence.
/// Cameras of the same name in sequences of one capture are the same, also across datasets if the file names the
/// capture. Only the training set has target weights. Throws Error(kComputation) where no frame can be used.
TrainingSplit MakeTrainingSplit(const std::vector<Dataset>& datasets, double validation_share,
                                const RowForm& form = {});

}  // namespace canonpose
