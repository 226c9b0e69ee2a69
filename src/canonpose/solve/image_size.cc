#include "canonpose/solve/image_size.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "canonpose/data/image_size_check.h"

namespace canonpose {
namespace {

/// Another size must leave less than this share of the error.
constexpr double kSizeGain = 0.85;

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
using Hypothesis = std::vector<std::pair<int, ImageSize>>;

/// Every view's other sizes one by one, and those that all views may have by the same factor.
std::vector<Hypothesis> Hypotheses(const CaptureObservations& capture) {
  std::vector<Hypothesis> hypotheses;
  std::vector<std::vector<ImageSize>> of_view;
  for (int v = 0; v < capture.view_count(); ++v) {
    of_view.push_back(
        OtherImageSizes(PixelsOf(capture, v), capture.cameras[static_cast<std::size_t>(v)].image_size_px));
    for (const ImageSize& size : of_view.back()) hypotheses.push_back({{v, size}});
  }
  for (const ImageSize& first : of_view.front()) {
    Hypothesis all;
    const double factor = static_cast<double>(first[0]) / capture.cameras.front().image_size_px[0];
    for (int v = 0; v < capture.view_count(); ++v) {
      const double width = capture.cameras[static_cast<std::size_t>(v)].image_size_px[0];
      for (const ImageSize& size : of_view[static_cast<std::size_t>(v)]) {
        if (std::abs(size[0] / width - factor) < 0.01) all.emplace_back(v, size);
      }
    }
    if (static_cast<int>(all.size()) == capture.view_count()) hypotheses.push_back(std::move(all));
  }
  return hypotheses;
}

}  // namespace

void SetImageSize(CaptureObservations& capture, int view, const std::array<int, 2>& size_px) {
  ObservedCamera& camera = capture.cameras[static_cast<std::size_t>(view)];
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
  const std::vector<Hypothesis> hypotheses = Hypotheses(capture);
  if (hypotheses.empty()) return;
  double least = CappedError(capture, calibrate_quickly(capture));
  if (getenv("DBG")) {
    auto s = calibrate_quickly(capture);
    fprintf(stderr, "declared capped %.5f median %.5f focals", least, MedianError(capture, s));
    for (int v = 0; v < capture.view_count(); ++v) fprintf(stderr, " %.3f", s.estimate.CameraAt(0, v).Focal());
    fprintf(stderr, "\n");
  }
  std::optional<CaptureObservations> best;
  for (const Hypothesis& hypothesis : hypotheses) {
    CaptureObservations other = capture;
    for (const auto& [view, size] : hypothesis) SetImageSize(other, view, size);
    const Solution found = calibrate_quickly(other);
    if (!found.calibration_summary.IsUsable()) continue;
    const double error = CappedError(other, found);
    if (getenv("DBG")) {
      fprintf(stderr, "views %zu first %d size %dx%d capped %.5f median %.5f focals", hypothesis.size(),
              hypothesis[0].first, hypothesis[0].second[0], hypothesis[0].second[1], error, MedianError(other, found));
      for (int v = 0; v < capture.view_count(); ++v) fprintf(stderr, " %.3f", found.estimate.CameraAt(0, v).Focal());
      fprintf(stderr, "\n");
    }
    if (error >= (best ? 1.0 : kSizeGain) * least) continue;
    least = error;
    best = std::move(other);
  }
  if (!best) return;
  capture = std::move(*best);
  solution = calibrate(capture);
}

}  // namespace canonpose
