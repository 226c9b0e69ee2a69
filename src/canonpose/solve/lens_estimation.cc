#include "canonpose/solve/lens_estimation.h"

#include <algorithm>
#include <utility>

#include "canonpose/solve/adjustment.h"
#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"

namespace canonpose {
namespace {

/// Standard errors by which keypoints have to be explained better. Eight coefficients that fit nothing but noise gain
/// about 1.4: the square root of the number of coefficients, divided by two.
constexpr double kDecisiveGain = 3.0;
/// From few blocks of time the standard error itself is uncertain: roughly Student's quantiles instead of normal ones.
constexpr double kUncertaintyOfBlocks = 6.0;
/// The scatter of keypoints is measured again, and the lenses are found again, as long as it falls below this multiple.
constexpr double kScatterStillFalls = 0.9;
constexpr int kMaxRounds = 4;
/// Frames that suffice to see whether lenses distort.
constexpr int kScreeningFrames = 120;
constexpr int kScreeningIterations = 50;

CaptureLenses LensesOf(const CaptureObservations& capture, const std::vector<int>& lens_of_view) {
  CaptureLenses lenses;
  lenses.of_view = lens_of_view;
  lenses.lenses.resize(static_cast<std::size_t>(std::ranges::max(lens_of_view)) + 1);
  for (std::size_t v = 0; v < lens_of_view.size(); ++v) {
    lenses.lenses[static_cast<std::size_t>(lens_of_view[v])] = capture.cameras[v].lens;
  }
  return lenses;
}

int FirstValidView(const RigEstimate& estimate, int frame) {
  const std::vector<int> views = estimate.ValidViews(frame);
  return views.empty() ? -1 : views.front();
}

/// Adjusts with the scatter of keypoints as it was measured last and measures it again, until it hardly falls. Finds
/// `lenses`, too, and undistorts the keypoints with them; null: keypoints stay as they are. Returns whether it
/// succeeded.
bool AdjustToScatter(std::span<const int> frames, CaptureLenses* lenses, CaptureObservations& capture,
                     Solution& solution) {
  AdjustmentOptions options;
  options.fixed_view = FirstValidView(solution.estimate, frames.front());
  options.iterations = kScreeningIterations;
  for (int round = 0; round < kMaxRounds; ++round) {
    options.scales = solution.scales;
    solution.calibration_summary = lenses == nullptr
                                       ? Adjust(capture, frames, options, solution.estimate)
                                       : AdjustWithLenses(capture, frames, options, *lenses, solution.estimate);
    if (!solution.calibration_summary.IsUsable()) return false;
    for (int v = 0; lenses != nullptr && v < capture.view_count(); ++v) {
      SetLens(capture, v, lenses->lenses[static_cast<std::size_t>(lenses->of_view[static_cast<std::size_t>(v)])]);
    }
    const double scatter = solution.scales.observation.Typical();
    solution.scales.observation = MeasureNoise(capture, frames, solution.estimate);
    if (solution.scales.observation.Typical() > kScatterStillFalls * scatter) return true;
  }
  return true;
}

/// The gain that decides, from so many frames.
double DecisiveGain(const CaptureObservations& capture, std::span<const int> frames) {
  const std::vector<double> ones(frames.size(), 1.0);
  return kDecisiveGain * (1.0 + kUncertaintyOfBlocks / std::max(1, MeanOverBlocks(capture, frames, ones).blocks));
}

}  // namespace

std::vector<int> LensOfViews(const CaptureObservations& capture,
                             const std::vector<std::vector<std::string>>& same_lens) {
  const auto group_of = [&](const std::string& camera) -> int {
    for (std::size_t g = 0; g < same_lens.size(); ++g) {
      const std::vector<std::string>& group = same_lens[g];
      const bool is_all = group.size() == 1 && group.front() == "all";
      if (is_all || std::ranges::find(group, camera) != group.end()) return static_cast<int>(g);
    }
    return -1;
  };
  std::vector<int> lens_of_group(same_lens.size(), -1);
  std::vector<int> lens_of_view;
  int count = 0;
  for (const ObservedCamera& camera : capture.cameras) {
    const int group = group_of(camera.name);
    int* shared = group < 0 ? nullptr : &lens_of_group[static_cast<std::size_t>(group)];
    const int lens = shared != nullptr && *shared >= 0 ? *shared : count++;
    if (shared != nullptr) *shared = lens;
    lens_of_view.push_back(lens);
  }
  return lens_of_view;
}

bool FindLenses(std::span<const int> frames, const std::vector<int>& lens_of_view, const Calibrate& calibrate,
                CaptureObservations& capture, Solution& solution) {
  if (frames.empty() || !capture.static_cameras) return false;
  const std::vector<int> screening = EvenlySpread(frames, kScreeningFrames);
  CaptureObservations as_it_is = capture;
  Solution without = solution;
  CaptureObservations undistorted = capture;
  Solution with = solution;
  CaptureLenses lenses = LensesOf(capture, lens_of_view);
  // Both are adjusted in the same way: a further adjustment explains the keypoints better by itself.
  if (!AdjustToScatter(screening, nullptr, as_it_is, without)) return false;
  if (!AdjustToScatter(screening, &lenses, undistorted, with)) return false;
  const double gain = Preference({undistorted, with}, {as_it_is, without}, screening);
  if (gain < DecisiveGain(capture, screening)) return false;
  // From the beginning, so that cameras and bones are found as well as through lenses that do not distort: a further
  // adjustment, to a scatter that has already become smaller, makes poses worse.
  Solution found = calibrate(undistorted);
  if (!found.calibration_summary.IsUsable()) return false;
  capture = std::move(undistorted);
  solution = std::move(found);
  return true;
}

}  // namespace canonpose
