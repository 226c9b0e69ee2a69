#include "canonpose/solve/image_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "canonpose/data/image_size_check.h"

namespace canonpose {
namespace {

/// Another size must leave less than this share of the error. Where the keypoints lie says most; a wrong size costs 0.5
/// to 2 % of the error, and other focal lengths and rotations take up the rest (experiments/damaged).
constexpr double kSizeGain = 0.998;
/// Other sizes are tried where the centre of the keypoints is this far from that of the image, as a fraction of it.
constexpr double kOffCentre = 0.12;
/// A quick calibration's error may be off by this factor.
constexpr double kQuickTolerance = 1.04;

/// (N, 2) pixels of all keypoints that a view sees.
std::vector<float> PixelsOf(const CaptureObservations& capture, int view) {
  const ObservedCamera& camera = capture.cameras[static_cast<std::size_t>(view)];
  std::vector<float> pixels;
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      if (!capture.Sees(n, view, j)) continue;
      const Eigen::Vector2d keypoint = capture.At(n, view, j);
      for (int axis = 0; axis < 2; ++axis) {
        pixels.push_back(static_cast<float>(keypoint[axis] * camera.diagonal_px + 0.5 * camera.image_size_px[axis]));
      }
    }
  }
  return pixels;
}

/// Views whose images are of other sizes than declared.
using Hypothesis = std::vector<std::pair<int, std::array<int, 2>>>;

/// Every view's other sizes one by one, and those that all views may have had in the same way.
std::vector<Hypothesis> Hypotheses(const CaptureObservations& capture) {
  std::vector<Hypothesis> hypotheses;
  std::map<std::pair<bool, double>, Hypothesis> in_the_same_way;
  for (int v = 0; v < capture.view_count(); ++v) {
    const std::array<int, 2>& declared = capture.cameras[static_cast<std::size_t>(v)].image_size_px;
    for (const OtherImageSize& other : OtherImageSizes(PixelsOf(capture, v), declared, kOffCentre)) {
      hypotheses.push_back({{v, other.size}});
      in_the_same_way[{other.is_turned, other.scale}].emplace_back(v, other.size);
    }
  }
  for (const auto& [way, views] : in_the_same_way) {
    if (views.size() > 1) hypotheses.push_back(views);
  }
  return hypotheses;
}

struct Corrected {
  CaptureObservations capture;
  Solution solution;
};

/// The capture under those hypotheses that a quick calibration does not rule out.
std::vector<CaptureObservations> WorthTrying(const CaptureObservations& capture,
                                             const std::vector<Hypothesis>& hypotheses,
                                             const Calibrate& calibrate_quickly) {
  std::vector<CaptureObservations> captures;
  std::vector<double> errors;
  for (const Hypothesis& hypothesis : hypotheses) {
    CaptureObservations other = capture;
    for (const auto& [view, size_px] : hypothesis) SetImageSize(other, view, size_px);
    const Solution found = calibrate_quickly(other);
    if (!found.calibration_summary.IsUsable()) continue;
    errors.push_back(CappedError(other, found));
    captures.push_back(std::move(other));
  }
  if (errors.empty()) return {};
  const double limit = kQuickTolerance * *std::ranges::min_element(errors);
  std::vector<CaptureObservations> worth;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (errors[i] <= limit) worth.push_back(std::move(captures[i]));
  }
  return worth;
}

}  // namespace

void SetImageSize(CaptureObservations& capture, int view, const std::array<int, 2>& size_px) {
  ObservedCamera& camera = capture.cameras[static_cast<std::size_t>(view)];
  SetLens(capture, view, {});  // a lens's coefficients are about the middle of the image and relative to its size
  const ObservedCamera before = camera;
  camera.image_size_px = size_px;
  camera.diagonal_px = std::hypot(size_px[0], size_px[1]);
  for (int n = 0; n < capture.frame_count; ++n) {
    for (int j = 0; j < capture.joint_count(); ++j) {
      float* xy = &capture.xy[2 * capture.Index(n, view, j)];
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const double pixel = xy[axis] * before.diagonal_px + 0.5 * before.image_size_px[axis];
        xy[axis] = static_cast<float>((pixel - 0.5 * size_px[axis]) / camera.diagonal_px);
      }
    }
  }
}

void CorrectImageSizes(CaptureObservations& capture, const Calibrate& calibrate, const Calibrate& calibrate_quickly,
                       Solution& solution) {
  std::vector<Hypothesis> hypotheses = Hypotheses(capture);
  double least = CappedError(capture, solution);
  // One view after the other, or several at once: whatever helps most, until nothing does.
  while (!hypotheses.empty()) {
    std::optional<Corrected> best;
    for (CaptureObservations& other : WorthTrying(capture, hypotheses, calibrate_quickly)) {
      Solution found = calibrate(other);
      if (!found.calibration_summary.IsUsable()) continue;
      const double error = CappedError(other, found);
      if (error >= (best ? least : kSizeGain * least)) continue;
      least = error;
      best = {std::move(other), std::move(found)};
    }
    if (!best) return;
    capture = std::move(best->capture);
    solution = std::move(best->solution);
    hypotheses = Hypotheses(capture);
  }
}

}  // namespace canonpose
