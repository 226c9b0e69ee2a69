#include "canonpose/solve/time_jump_correction.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "canonpose/base/median.h"
#include "canonpose/solve/time_jump.h"
#include "canonpose/solve/view_signs.h"

namespace canonpose {
namespace {

/// Lost frames are looked for in views with this many times the outliers of the others.
constexpr double kMoreOutliers = 1.25;

/// Views with clearly more outliers than the others have in the median.
std::vector<int> ViewsThatFitWorse(const CaptureObservations& capture, const Solution& solution) {
  const std::vector<ViewSigns> signs = MeasureSigns(capture, solution);
  std::vector<int> views;
  for (std::size_t v = 0; v < signs.size(); ++v) {
    if (!signs[v].known) continue;
    std::vector<double> others;
    for (std::size_t w = 0; w < signs.size(); ++w) {
      if (w != v && signs[w].known) others.push_back(signs[w].outliers);
    }
    if (others.size() >= 2 && signs[v].outliers > kMoreOutliers * Median(std::move(others))) {
      views.push_back(static_cast<int>(v));
    }
  }
  return views;
}

/// Whether what was found about a view in a clip may be lost frames: only stretches that nothing explains.
bool MayHaveLostFrames(const ViewCorrection& correction) {
  return correction.reading.IsIdentity() &&
         std::ranges::all_of(correction.bad, [](const BadStretch& bad) { return bad.fault == StretchFault::kOther; });
}

/// Whether a clip is read at another frame rate in some view. Its frames that stand between two recorded ones fit worse
/// than others, so that another view seems to be early there and late elsewhere.
bool HasOtherRate(const CameraCheck& check, int clip) {
  return std::ranges::any_of(check.corrections[static_cast<std::size_t>(clip)],
                             [](const ViewCorrection& correction) { return correction.reading.time.rate != 1.0; });
}

/// What a view recorded, with everything corrected that was found about it.
void CorrectAgain(const CaptureObservations& original, const CameraCheck& check, int view,
                  CaptureObservations& capture) {
  CopyView(original, view, capture);
  for (int clip = 0; clip < static_cast<int>(capture.clips.size()); ++clip) {
    ApplyCorrection(check.At(clip, view), clip, view, capture);
  }
}

}  // namespace

bool CorrectTimeJump(const CaptureObservations& original, CaptureObservations& capture, const Solution& solution,
                     CameraCheck& check) {
  TimeJump best;
  int best_view = -1;
  int best_clip = -1;
  for (const int v : ViewsThatFitWorse(capture, solution)) {
    for (int clip = 0; clip < static_cast<int>(capture.clips.size()); ++clip) {
      if (HasOtherRate(check, clip) || !MayHaveLostFrames(check.At(clip, v))) continue;
      std::optional<TimeJump> jump;
      if (check.At(clip, v).bad.empty()) {
        jump = FindTimeJump(capture, solution, clip, v);
      } else {
        CameraCheck without_bad = check;
        without_bad.At(clip, v).bad.clear();
        CaptureObservations with_all_frames = capture;
        CorrectAgain(original, without_bad, v, with_all_frames);
        jump = FindTimeJump(with_all_frames, solution, clip, v);
      }
      if (!jump || jump->gain <= best.gain) continue;
      best = *jump;
      best_view = v;
      best_clip = clip;
    }
  }
  if (best_view < 0) return false;
  // From the time of the others to the view's own.
  ViewCorrection& correction = check.At(best_clip, best_view);
  BadStretch& stretch = best.stretch;
  const int count = capture.clips[static_cast<std::size_t>(best_clip)].count;
  const int end = stretch.first + stretch.count;
  const auto own = [&](int frame) { return std::clamp(frame - correction.offset_frames, 0, count); };
  stretch.first = stretch.first == 0 ? 0 : own(stretch.first);
  stretch.count = (end == count ? count : own(end)) - stretch.first;
  correction.bad = {stretch};
  CorrectAgain(original, check, best_view, capture);
  return true;
}

bool ForgetTimeJumps(const CaptureObservations& original, CaptureObservations& capture, CameraCheck& check) {
  bool changed = false;
  for (int clip = 0; clip < static_cast<int>(capture.clips.size()); ++clip) {
    if (!HasOtherRate(check, clip)) continue;
    for (int v = 0; v < static_cast<int>(check.corrections[static_cast<std::size_t>(clip)].size()); ++v) {
      ViewCorrection& correction = check.At(clip, v);
      const auto is_jump = [](const BadStretch& bad) { return bad.fault == StretchFault::kTimeJump; };
      if (correction.reading.time.rate != 1.0 || std::erase_if(correction.bad, is_jump) == 0) continue;
      CorrectAgain(original, check, v, capture);
      changed = true;
    }
  }
  return changed;
}

}  // namespace canonpose
