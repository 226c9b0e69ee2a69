// The 3D poses with which predictions are compared: the file's truth, or a triangulation with its calibration.
#pragma once

#include <string>
#include <vector>

#include "canonpose/data/dataset.h"
#include "canonpose/data/sequence_triangulation.h"
#include "canonpose/evaluate/report.h"

namespace canonpose {

class ReferencePoses {
 public:
  /// Truth if the file has any, otherwise TriangulateSequence(). Throws Error(kBadInput) that names `file` if there is
  /// neither truth nor calibration.
  ReferencePoses(const Dataset& dataset, const std::string& file);

  /// In the order of the dataset's sequences.
  [[nodiscard]] const std::vector<SequencePoses>& sequences() const { return sequences_; }
  [[nodiscard]] bool triangulated() const { return triangulated_; }
  /// The errors of every triangulated joint in every view that sees it.
  [[nodiscard]] const std::vector<double>& reprojection_errors_px() const { return reprojection_errors_px_; }

 private:
  bool triangulated_ = false;
  std::vector<SequencePoses> sequences_;
  std::vector<double> reprojection_errors_px_;
};

/// Summarises the references of several files for the report.
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
