// The 3D poses that predictions are compared with: the file's truth, or what its calibration gives by triangulation.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/evaluate/report.h"

namespace canonpose {

/// Of one sequence: for each of its cameras the poses (T, J, 3) in mm in that camera's frame, NaN where unknown; empty
/// for a camera that nothing is known of.
struct SequenceReference {
  std::vector<std::vector<float>> poses_in_camera;
};

/// Triangulates every joint of every frame from all calibrated cameras of a sequence, weighted by confidence and the
/// distortion undone. For each camera (T, J, 3) mm in that camera's frame, NaN where unknown: where fewer than two
/// cameras see the joint, its rays are nearly parallel, or it would lie behind a camera that sees it; empty for cameras
/// without calibration. `reprojection_errors_px`, where given, gets the error of every triangulated joint in every view
/// that sees it, after what it holds.
SequenceReference TriangulateSequence(const Sequence& sequence, int joint_count,
                                      std::vector<double>* reprojection_errors_px = nullptr);

class ReferencePoses {
 public:
  /// Truth where the file has any, otherwise TriangulateSequence(). Throws Error(kBadInput) naming `file` where there
  /// is neither truth nor calibration.
  ReferencePoses(const Dataset& dataset, const std::string& file);

  /// In the order of the dataset's sequences.
  [[nodiscard]] const std::vector<SequenceReference>& sequences() const { return sequences_; }
  [[nodiscard]] bool triangulated() const { return triangulated_; }
  /// Of every triangulated joint in every view that sees it.
  [[nodiscard]] const std::vector<double>& reprojection_errors_px() const { return reprojection_errors_px_; }

 private:
  bool triangulated_ = false;
  std::vector<SequenceReference> sequences_;
  std::vector<double> reprojection_errors_px_;
};

/// What to say about the references of several files together.
class ReferenceSummary {
 public:
  void Add(const ReferencePoses& reference);
  [[nodiscard]] ReferenceKind Kind() const;

 private:
  bool any_truth_ = false;
  bool any_triangulated_ = false;
  std::vector<double> reprojection_errors_px_;
};

}  // namespace canonpose
