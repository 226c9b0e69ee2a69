#include "canonpose/evaluate/reference.h"

#include <numeric>
#include <utility>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"

namespace canonpose {
ReferencePoses::ReferencePoses(const Dataset& dataset, const std::string& file) {
  const bool has_truth = dataset.HasTruth();
  if (!has_truth && !dataset.HasCalibration()) {
    ThrowBadInput({file, "", "truth or a calibration to evaluate against", "neither",
                   "import the data with `calibration`, or evaluate other data"});
  }
  triangulated_ = !has_truth;
  for (const Sequence& sequence : dataset.sequences) {
    if (triangulated_) {
      sequences_.push_back(TriangulateSequence(sequence, dataset.skeleton, &reprojection_errors_px_));
      continue;
    }
    SequencePoses poses;
    for (const CameraView& view : sequence.cameras) poses.poses_in_camera.push_back(view.truth);
    sequences_.push_back(std::move(poses));
  }
}

void ReferenceSummary::Add(const ReferencePoses& reference) {
  (reference.triangulated() ? any_triangulated_ : any_truth_) = true;
  reprojection_errors_px_.insert(reprojection_errors_px_.end(), reference.reprojection_errors_px().begin(),
                                 reference.reprojection_errors_px().end());
}

ReferenceKind ReferenceSummary::Kind() const {
  ReferenceKind kind;
  kind.description = "truth";
  if (!any_triangulated_) return kind;
  kind.description = any_truth_ ? "truth in some files, in others triangulated from the calibration"
                                : "triangulated from the calibration";
  if (reprojection_errors_px_.empty()) return kind;
  const double sum = std::accumulate(reprojection_errors_px_.begin(), reprojection_errors_px_.end(), 0.0);
  kind.reprojection_px = {Median(reprojection_errors_px_), sum / static_cast<double>(reprojection_errors_px_.size())};
  return kind;
}

}  // namespace canonpose
