#include "canonpose/data/calibration_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/geometry/triangulation.h"

namespace canonpose {
namespace {

constexpr int kCalibrationFrames = 30;
/// Other assignments are tried where the error is larger than this share of the image: one that exact keypoints would
/// not have.
constexpr double kSuspiciousError = 0.002;
/// Another assignment is right where the error is that much smaller with it. Where the given one is right, no other is
/// better at all; but two cameras of the same height contradict each other little whichever is which.
constexpr double kClearlySmaller = 0.5;
constexpr double kClearlySmallerOfTwo = 0.25;
/// A calibration with a larger error, as a share of the image, is not that of the recording.
constexpr double kLargestError = 0.02;
constexpr std::size_t kMaxCamerasForAllAssignments = 5;

/// The calibration of view assignment[v] belongs to view v; only calibrated views take part.
using Assignment = std::vector<std::size_t>;

std::vector<std::size_t> CalibratedViews(const Sequence& sequence) {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < sequence.cameras.size(); ++v) {
    if (!sequence.cameras[v].calibration.empty()) views.push_back(v);
  }
  return views;
}

/// The median reprojection error over some frames. `poses_in_world`, where given, receives those frames' poses (J, 3).
double MedianError(const Sequence& sequence, std::size_t joint_count, const std::vector<std::size_t>& views,
                   const Assignment& assignment, std::vector<float>* poses_in_world = nullptr) {
  std::vector<double> errors_px;
  std::vector<PointObservation> observations(views.size());
  const int step = std::max(1, sequence.frame_count / kCalibrationFrames);
  for (int frame = 0; frame < sequence.frame_count; frame += step) {
    float* pose = nullptr;
    if (poses_in_world != nullptr) {
      poses_in_world->resize(poses_in_world->size() + 3 * joint_count, std::numeric_limits<float>::quiet_NaN());
      pose = &poses_in_world->back() + 1 - 3 * joint_count;
    }
    for (std::size_t j = 0; j < joint_count; ++j) {
      const std::size_t i = static_cast<std::size_t>(frame) * joint_count + j;
      int seen = 0;
      for (std::size_t v = 0; v < views.size(); ++v) {
        const CameraView& view = sequence.cameras[views[v]];
        observations[v].camera = &sequence.cameras[views[assignment[v]]].CalibrationAt(frame);
        observations[v].pixel = {view.keypoints[2 * i], view.keypoints[2 * i + 1]};
        observations[v].confidence = view.confidence[i];
        seen += view.confidence[i] > 0.0F ? 1 : 0;
      }
      if (seen < 2) continue;
      const TriangulatedPoint point = Triangulate(observations);
      const bool is_possible = point.valid() && point.in_front_of_all_cameras;
      errors_px.push_back(is_possible ? point.reprojection_error_px : std::numeric_limits<double>::infinity());
      if (!is_possible || pose == nullptr) continue;
      for (Eigen::Index axis = 0; axis < 3; ++axis)
        pose[3 * j + static_cast<std::size_t>(axis)] = static_cast<float>(point.point_in_world_mm[axis]);
    }
  }
  return Median(std::move(errors_px));
}

Assignment AsGiven(const std::vector<std::size_t>& views) {
  Assignment assignment(views.size());
  std::iota(assignment.begin(), assignment.end(), 0);
  return assignment;
}

double LongerSide(const Sequence& sequence) {
  std::vector<double> sizes;
  for (const CameraView& view : sequence.cameras) sizes.push_back(std::max(view.image_size[0], view.image_size[1]));
  return Median(std::move(sizes));
}

/// The best assignment, and its error.
std::pair<Assignment, double> FindAssignment(const Sequence& sequence, std::size_t joint_count,
                                             const std::vector<std::size_t>& views, double error_px) {
  Assignment best = AsGiven(views);
  double least = error_px;
  const auto consider = [&](const Assignment& assignment) {
    const double error = MedianError(sequence, joint_count, views, assignment);
    if (!(error < least)) return false;
    least = error;
    return true;
  };
  if (views.size() <= kMaxCamerasForAllAssignments) {
    Assignment assignment = best;
    while (std::next_permutation(assignment.begin(), assignment.end())) {
      if (consider(assignment)) best = assignment;
    }
    return {best, least};
  }
  for (bool improves = true; improves;) {
    improves = false;
    Assignment better = best;
    for (std::size_t a = 0; a < views.size(); ++a) {
      for (std::size_t b = a + 1; b < views.size(); ++b) {
        Assignment exchanged = best;
        std::swap(exchanged[a], exchanged[b]);
        if (!consider(exchanged)) continue;
        better = exchanged;
        improves = true;
      }
    }
    best = better;
  }
  return {best, least};
}

std::string DescribeError(double error_px) {
  return std::isinf(error_px) ? "the person would be behind the cameras"
                              : fmt::format("keypoints are {:.0f} px off", error_px);
}

[[noreturn]] void ThrowNobody(const std::string& file, const std::string& place, double stature_mm,
                              const std::string& advice) {
  ThrowBadInput({file, place,
                 fmt::format("a person of {} to {} in millimetres, centimetres or metres",
                             DescribeLength(kMinStatureMm), DescribeLength(kMaxStatureMm)),
                 fmt::format("one of {}", DescribeLength(stature_mm)), advice});
}

/// Scales what was calibrated together to millimetres, if the person's size says that it is in another unit.
void CheckUnitOfCalibration(Sequence& sequence, const Skeleton& skeleton, const std::string& file,
                            std::set<std::string>& reported) {
  const std::vector<std::size_t> views = CalibratedViews(sequence);
  std::vector<float> poses;
  MedianError(sequence, skeleton.joints.size(), views, AsGiven(views), &poses);
  BodySize size(skeleton);
  size.Add(poses);
  const std::optional<double> stature = size.Stature();
  if (!stature) return;
  const std::optional<StatureUnit> unit = UnitOfStature(*stature);
  if (!unit) ThrowNobody(file, "calibration", *stature, "give the translations t of the cameras in millimetres");
  if (unit->mm == 1.0) return;
  if (reported.insert(unit->name).second) {
    LogWarning("{}: the calibration's t is in {}, as the person would be {} tall otherwise; it is read as such", file,
               unit->name, DescribeLength(*stature));
  }
  for (CameraView& view : sequence.cameras) {
    for (Camera& camera : view.calibration) camera.camera_from_world_translation *= unit->mm;
  }
}

}  // namespace

bool CalibrationFit::fits() const { return !(error_px > kLargestError * image_px); }

CalibrationFit MeasureCalibration(const Sequence& sequence, int joint_count) {
  CalibrationFit fit;
  const std::vector<std::size_t> views = CalibratedViews(sequence);
  const auto joints = static_cast<std::size_t>(joint_count);
  fit.error_px = MedianError(sequence, joints, views, AsGiven(views));
  fit.image_px = LongerSide(sequence);
  if (!(fit.error_px > kSuspiciousError * fit.image_px)) return fit;
  const auto [assignment, error_px] = FindAssignment(sequence, joints, views, fit.error_px);
  const double wanted_px = (views.size() == 2 ? kClearlySmallerOfTwo : kClearlySmaller) * fit.error_px;
  if (!(error_px < wanted_px) || error_px > kLargestError * fit.image_px) return fit;
  fit.corrected_px = error_px;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (assignment[v] == v) continue;
    fit.interchanged.emplace_back(sequence.cameras[views[v]].name, sequence.cameras[views[assignment[v]]].name);
  }
  return fit;
}

std::string DescribeInterchange(const CalibrationFit& fit) {
  std::string text;
  std::set<std::string> told;
  for (const auto& [camera, source] : fit.interchanged) {
    const auto& pairs = fit.interchanged;
    const bool is_exchange = std::find(pairs.begin(), pairs.end(), std::pair(source, camera)) != pairs.end();
    if (is_exchange && told.contains(source)) continue;
    told.insert(camera);
    text += text.empty() ? "" : ", ";
    text += is_exchange ? fmt::format("{} and {} interchanged", camera, source)
                        : fmt::format("that of {} under the name {}", camera, source);
  }
  return text;
}

bool CheckCalibration(Dataset& dataset, const std::string& file) {
  std::set<std::string> reported;
  double worst = 0.0;
  std::string worst_sequence;
  CalibrationFit worst_fit;
  for (Sequence& sequence : dataset.sequences) {
    const CalibrationFit fit = MeasureCalibration(sequence, dataset.skeleton.joint_count());
    if (!fit.interchanged.empty()) {
      ThrowBadInput({file, "calibration", "every camera's own calibration",
                     fmt::format("{} ({}; {:.1f} px the other way)", DescribeInterchange(fit),
                                 DescribeError(fit.error_px), fit.corrected_px),
                     "give every camera its own: exchange the names in the calibration, then import"});
    }
    if (!fit.fits()) {
      const double share = fit.error_px / fit.image_px;
      if (share > worst) {
        worst = share;
        worst_sequence = sequence.name;
        worst_fit = fit;
      }
      continue;
    }
    CheckUnitOfCalibration(sequence, dataset.skeleton, file, reported);
  }
  if (worst == 0.0) return true;
  LogWarning(
      "{}: the calibration does not fit the keypoints of {} ({}): it is not that of these cameras, or the cameras are "
      "not synchronised; figures that it gives mean nothing",
      file, worst_sequence, DescribeError(worst_fit.error_px));
  return false;
}

std::optional<StatureUnit> UnitOfTruth(const BodySize& truth, const std::string& file) {
  const std::optional<double> stature = truth.Stature();
  if (!stature) return std::nullopt;
  std::optional<StatureUnit> unit = UnitOfStature(*stature);
  if (!unit) ThrowNobody(file, "truth", *stature, "give the truth in millimetres");
  if (unit->mm == 1.0) return std::nullopt;
  LogWarning("{}: the truth is in {}, as the person would be {} tall otherwise; it is read as such", file, unit->name,
             DescribeLength(*stature));
  return unit;
}

void CheckUnitOfTruth(Dataset& dataset, const std::string& file) {
  BodySize size(dataset.skeleton);
  for (const Sequence& sequence : dataset.sequences) {
    for (const CameraView& view : sequence.cameras) size.Add(view.truth.positions());
  }
  const std::optional<StatureUnit> unit = UnitOfTruth(size, file);
  if (!unit) return;
  for (Sequence& sequence : dataset.sequences) {
    for (CameraView& view : sequence.cameras) {
      for (float& value : view.truth.positions()) value = static_cast<float>(value * unit->mm);
    }
  }
}

}  // namespace canonpose
