#include "canonpose/solve/camera_check.h"

#include <algorithm>
#include <cmath>

#include "canonpose/base/median.h"
#include "canonpose/solve/calibration.h"
#include "canonpose/solve/diagnosis.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/initialisation.h"
#include "canonpose/solve/time_offset.h"

namespace canonpose {
namespace {

constexpr int kOffsetRounds = 3;
/// Disagreement is measured in about this many frames.
constexpr int kDisagreementFrames = 300;
/// A view is suspected above this disagreement, in body units. Measured on simulated captures: 0.8 to 2.2 % usually, 10
/// to 30 % where it shows somebody else.
constexpr double kSuspectDisagreement = 0.04;
/// It is dropped if without it the error of the others is below kAgreement (body units) and below kAgreementGain times
/// the error with it. Measured: 0.25 to 0.6 % usually, 0.7 to 6 % with a view of somebody else.
constexpr double kAgreement = 0.015;
constexpr double kAgreementGain = 0.8;

}  // namespace

void ShiftView(CaptureObservations& capture, int clip, int view, int frames) {
  if (frames == 0) return;
  const ClipRange& range = capture.clips[static_cast<std::size_t>(clip)];
  const auto joints = static_cast<std::size_t>(capture.joint_count());
  for (int i = 0; i < range.count; ++i) {
    // Frames that become later are moved from the last to the first, so that none is overwritten before it has moved.
    const int t = frames > 0 ? range.count - 1 - i : i;
    const int source = t - frames;
    const bool is_there = source >= 0 && source < range.count;
    const std::size_t to = capture.Index(range.first + t, view, 0);
    const std::size_t from = is_there ? capture.Index(range.first + source, view, 0) : 0;
    const auto move = [&](std::vector<float>& values, std::size_t width, float none) {
      if (is_there) std::copy_n(&values[width * from], width * joints, &values[width * to]);
      if (!is_there) std::fill_n(&values[width * to], width * joints, none);
    };
    move(capture.xy, 2, std::nanf(""));
    move(capture.confidence, 1, 0.0F);
    move(capture.start, 3, std::nanf(""));
  }
}

void DropView(CaptureObservations& capture, int view) {
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      const std::size_t i = capture.Index(n, view, j);
      capture.confidence[i] = 0.0F;
      std::fill_n(&capture.xy[2 * i], 2, std::nanf(""));
      std::fill_n(&capture.start[3 * i], 3, std::nanf(""));
    }
  }
}

double DisagreementOf(const CaptureObservations& capture, const Solution& solution, int view) {
  std::vector<double> errors;
  const int step = std::max(1, capture.frame_count / kDisagreementFrames);
  for (int n = 0; n < capture.frame_count; n += step) {
    const CameraEstimate& camera = solution.estimate.CameraAt(n, view);
    if (!camera.valid) continue;
    const int left_out = solution.estimate.ValidViews(n).size() > 2 ? view : -1;
    for (int j = 0; j < capture.joint_count(); ++j) {
      if (!capture.Sees(n, view, j)) continue;
      const RobustPoint others = TriangulateJoint(capture, n, j, solution.scales, solution.estimate, left_out);
      if (!others.point.allFinite()) continue;
      const double error =
          DistanceInFront(solution.estimate.InCamera(n, view, others.point), camera.Focal(), capture.At(n, view, j));
      if (std::isfinite(error)) errors.push_back(error);
    }
  }
  return Median(std::move(errors));
}

namespace {

/// Shifts views of a clip in time, always the one that gains most, until all fit. Adds to `offsets` (V) and returns
/// whether any view was shifted.
bool AlignClip(CaptureObservations& capture, const Solution& solution, int clip, std::vector<int>& offsets) {
  // Of two views either could be shifted; we take the second.
  std::vector<int> views = solution.estimate.ValidViews(0);
  if (views.size() == 2) views.erase(views.begin());
  bool moved = false;
  for (int round = 0; round < 2 * capture.view_count(); ++round) {
    OffsetEstimate best;
    int best_view = -1;
    for (const int v : views) {
      const bool was_moved = offsets[static_cast<std::size_t>(v)] != 0;
      const OffsetEstimate found = EstimateOffset(capture, solution, clip, v, was_moved);
      if (found.gain <= best.gain) continue;
      best = found;
      best_view = v;
    }
    if (best_view < 0) break;
    ShiftView(capture, clip, best_view, best.frames);
    offsets[static_cast<std::size_t>(best_view)] += best.frames;
    moved = true;
  }
  return moved;
}

void AlignCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution,
                  std::vector<std::vector<int>>& offsets) {
  for (int round = 0; round < kOffsetRounds; ++round) {
    bool moved = false;
    for (std::size_t clip = 0; clip < capture.clips.size(); ++clip) {
      moved = AlignClip(capture, solution, static_cast<int>(clip), offsets[clip]) || moved;
    }
    if (!moved) return;
    solution = calibrate(capture);
    if (!solution.calibration.IsUsable()) return;
  }
}

/// The view without which the others agree, `solution` becoming theirs; -1 where there is none.
int FindStranger(const CaptureObservations& capture, const Calibrate& calibrate, Solution& solution) {
  double worst = 0.0;
  std::vector<int> used;
  for (int v = 0; v < capture.view_count(); ++v) {
    const double disagreement = DisagreementOf(capture, solution, v);
    if (!std::isfinite(disagreement)) continue;
    used.push_back(v);
    worst = std::max(worst, disagreement);
  }
  if (used.size() < 3 || worst < kSuspectDisagreement) return -1;
  double best = std::min(kAgreement, kAgreementGain * MedianError(capture, solution));
  int stranger = -1;
  Solution found;
  for (const int v : used) {
    CaptureObservations without = capture;
    DropView(without, v);
    if (static_cast<int>(FramesWithStart(without).size()) < kMinFrames) continue;
    Solution candidate = calibrate(without);
    if (!candidate.calibration.IsUsable()) continue;
    const double error = MedianError(without, candidate);
    if (!(error < best)) continue;
    best = error;
    stranger = v;
    found = std::move(candidate);
  }
  if (stranger >= 0) solution = std::move(found);
  return stranger;
}

/// Shifts all views of a clip by the same number of frames so that most of them keep their own time.
void KeepMajority(CaptureObservations& capture, const std::vector<bool>& dropped,
                  std::vector<std::vector<int>>& offsets) {
  for (std::size_t clip = 0; clip < offsets.size(); ++clip) {
    std::vector<int> used;
    for (std::size_t v = 0; v < dropped.size(); ++v) {
      if (!dropped[v]) used.push_back(offsets[clip][v]);
    }
    int most = 0;
    for (const int offset : used) {
      if (std::ranges::count(used, offset) > std::ranges::count(used, most)) most = offset;
    }
    for (std::size_t v = 0; most != 0 && v < dropped.size(); ++v) {
      ShiftView(capture, static_cast<int>(clip), static_cast<int>(v), -most);
      offsets[clip][v] -= most;
    }
  }
}

}  // namespace

double MedianError(const CaptureObservations& capture, const Solution& solution) {
  std::vector<double> errors;
  VisitErrors(capture, ConsecutiveFrames(0, capture.frame_count), solution.estimate,
              [&](int, int, int, double error) { errors.push_back(error); });
  return Median(std::move(errors));
}

CameraCheck CheckCameras(CaptureObservations& capture, const Calibrate& calibrate, Solution& solution) {
  CameraCheck check;
  check.offsets.assign(capture.clips.size(), std::vector<int>(capture.cameras.size(), 0));
  check.dropped.assign(capture.cameras.size(), false);
  for (;;) {
    if (capture.static_cameras) AlignCameras(capture, calibrate, solution, check.offsets);
    if (!solution.calibration.IsUsable()) return check;
    const int stranger = FindStranger(capture, calibrate, solution);
    if (stranger < 0) break;
    DropView(capture, stranger);
    check.dropped[static_cast<std::size_t>(stranger)] = true;
    for (std::vector<int>& offsets : check.offsets) offsets[static_cast<std::size_t>(stranger)] = 0;
  }
  KeepMajority(capture, check.dropped, check.offsets);
  return check;
}

}  // namespace canonpose
