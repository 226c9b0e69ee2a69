#include "canonpose/solve/time_jump.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "canonpose/solve/fit.h"
#include "canonpose/solve/frame_choice.h"
#include "canonpose/solve/view_comparison.h"

namespace canonpose {
namespace {

constexpr double kMinSideSeconds = 1.5;
constexpr int kMinSideFrames = 25;
constexpr double kMaxJumpSeconds = 2.5;
/// First, jumps are tried at this many places, by multiples of so many frames, and judged in about so many frames.
constexpr int kPlaces = 12;
constexpr int kJumpStep = 3;
constexpr int kJudgedFrames = 100;
/// A jump is believed where it lowers the cost of the frames behind it by so many standard errors and this fraction,
/// compared with a camera that was fitted to these frames as they are. Measured by experiments/damaged: 27 % and 3.2
/// standard errors with 6 frames lost, up to 13 % and 1.4 in other views.
constexpr double kSigma = 2.3;
constexpr double kFraction = 0.18;

/// A jump of one part of the clip, `moved`, against the other, `kept`.
struct Candidate {
  std::vector<int> kept;
  std::vector<int> moved;
  int jump = 0;
  CameraEstimate camera;                                  ///< fitted to `kept`
  double cost = std::numeric_limits<double>::infinity();  ///< mean over both parts
};

class JumpSearch {
 public:
  JumpSearch(const CaptureObservations& capture, const Solution& solution, int clip, int view)
      : capture_(capture),
        clip_(capture.clips[static_cast<std::size_t>(clip)]),
        comparison_(capture, solution, clip, view),
        min_side_(std::max(kMinSideFrames, static_cast<int>(std::lround(kMinSideSeconds * clip_.fps)))),
        max_jump_(std::max(kJumpStep, static_cast<int>(std::lround(kMaxJumpSeconds * clip_.fps)))) {}

  [[nodiscard]] std::optional<TimeJump> Find();

 private:
  /// The frames before a place of the clip, or those from it on.
  [[nodiscard]] std::vector<int> Part(int place, bool before) const;
  /// The best of some jumps of `moved`.
  void Try(const std::vector<int>& kept, const std::vector<int>& moved, std::span<const int> jumps, Candidate& best);
  [[nodiscard]] double Sum(const std::vector<int>& frames, int offset, const CameraEstimate& camera, int& count);
  /// The place at which the jump explains most; frames of the clip.
  [[nodiscard]] int BestPlace(const Candidate& candidate, bool before);

  const CaptureObservations& capture_;
  const ClipRange& clip_;
  ViewComparison comparison_;
  int min_side_;
  int max_jump_;
};

std::vector<int> JumpSearch::Part(int place, bool before) const {
  return before ? ConsecutiveFrames(clip_.first, place) : ConsecutiveFrames(clip_.first + place, clip_.count - place);
}

double JumpSearch::Sum(const std::vector<int>& frames, int offset, const CameraEstimate& camera, int& count) {
  double sum = 0.0;
  for (const int frame : EvenlySpread(frames, kJudgedFrames)) {
    const double cost = comparison_.Cost(frame, offset, camera);
    if (!std::isfinite(cost)) continue;
    sum += cost;
    ++count;
  }
  return sum;
}

void JumpSearch::Try(const std::vector<int>& kept, const std::vector<int>& moved, std::span<const int> jumps,
                     Candidate& best) {
  const CameraEstimate camera = comparison_.Refit(kept, 0);
  int kept_count = 0;
  const double kept_mean = Sum(kept, 0, camera, kept_count) / kept_count;
  for (const int jump : jumps) {
    int count = 0;
    const double mean = Sum(moved, jump, camera, count) / count;
    // Frames that leave the clip cannot be compared; most must be.
    if (2 * count < std::min<int>(kJudgedFrames, static_cast<int>(moved.size()))) continue;
    const double share = static_cast<double>(moved.size()) / static_cast<double>(clip_.count);
    const double cost = share * mean + (1.0 - share) * kept_mean;
    if (cost < best.cost) best = {kept, moved, jump, camera, cost};
  }
}

int JumpSearch::BestPlace(const Candidate& candidate, bool before) {
  // The gain of moving the frames up to each place.
  std::vector<double> gains{0.0};
  for (const int frame : ConsecutiveFrames(clip_.first, clip_.count)) {
    const double gain =
        comparison_.Cost(frame, 0, candidate.camera) - comparison_.Cost(frame, candidate.jump, candidate.camera);
    gains.push_back(gains.back() + (std::isfinite(gain) ? gain : 0.0));
  }
  const auto from = gains.begin() + min_side_;
  const auto to = gains.end() - min_side_;
  return static_cast<int>((before ? std::max_element(from, to) : std::min_element(from, to)) - gains.begin());
}

std::optional<TimeJump> JumpSearch::Find() {
  if (clip_.count < 2 * min_side_) return std::nullopt;
  std::vector<int> jumps;
  for (int jump = kJumpStep; jump <= max_jump_; jump += kJumpStep) jumps.insert(jumps.end(), {jump, -jump});
  Candidate best;
  const int step = std::max(1, (clip_.count - 2 * min_side_) / kPlaces);
  for (int place = min_side_; place <= clip_.count - min_side_; place += step) {
    for (const bool before : {true, false}) Try(Part(place, !before), Part(place, before), jumps, best);
  }
  if (best.jump == 0) return std::nullopt;
  const bool before = best.moved.front() == clip_.first;
  for (int round = 0; round < 2; ++round) {
    const int place = BestPlace(best, before);
    std::vector<int> near;
    for (int jump = best.jump - kJumpStep + 1; jump < best.jump + kJumpStep; ++jump) {
      if (jump != 0) near.push_back(jump);
    }
    Candidate finer;
    Try(Part(place, !before), Part(place, before), near, finer);
    if (finer.jump == 0) return std::nullopt;
    best = std::move(finer);
  }
  const CameraEstimate own_camera = comparison_.Refit(best.moved, 0);
  std::vector<double> gains;
  double now = 0.0;
  int count = 0;
  for (const int frame : best.moved) {
    const double cost = comparison_.Cost(frame, 0, own_camera);
    gains.push_back(cost - comparison_.Cost(frame, best.jump, best.camera));
    if (!std::isfinite(gains.back())) continue;
    now += cost;
    ++count;
  }
  const BlockMean gain = MeanOverBlocks(capture_, best.moved, gains);
  if (gain.blocks < 3 || gain.mean < kSigma * std::sqrt(gain.variance) || gain.mean < kFraction * now / count) {
    return std::nullopt;
  }
  const auto frames = static_cast<int>(best.moved.size());
  return TimeJump{{best.moved.front() - clip_.first, frames, StretchFault::kTimeJump, best.jump}, gain.mean * count};
}

}  // namespace

std::optional<TimeJump> FindTimeJump(const CaptureObservations& capture, const Solution& solution, int clip, int view) {
  const int first = capture.clips[static_cast<std::size_t>(clip)].first;
  if (!solution.estimate.CameraAt(first, view).valid || solution.estimate.ValidViews(first).size() < 3) {
    return std::nullopt;
  }
  return JumpSearch(capture, solution, clip, view).Find();
}

}  // namespace canonpose
