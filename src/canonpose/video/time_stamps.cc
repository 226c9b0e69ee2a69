#include "canonpose/video/time_stamps.h"

#include <cmath>

namespace canonpose {
namespace {

/// Where a container states no rate, or an impossible one.
constexpr double kUsualFps = 30.0;
constexpr double kLargestFps = 10000.0;
/// Recordings of a screen pause for as long as nothing moves; a longer pause is a damaged stamp.
constexpr double kLongestPauseSeconds = 60.0;

}  // namespace

TimeStamps::TimeStamps(double fps)
    : interval_(1.0 / (std::isfinite(fps) && fps > 0.0 && fps < kLargestFps ? fps : kUsualFps)) {}

bool TimeStamps::IsBelievable(double time) const {
  return std::isfinite(time) && time > last_ && time < last_ + kLongestPauseSeconds;
}

double TimeStamps::Next(double stamp_seconds) {
  const bool is_first = frames_++ == 0;
  if (is_first) {
    first_ = std::isfinite(stamp_seconds) ? stamp_seconds : 0.0;
    return last_;
  }
  const double time = stamp_seconds - first_;
  if (IsBelievable(time)) {
    last_ = time;
  } else {
    last_ += interval_;
    ++corrected_;
  }
  return last_;
}

}  // namespace canonpose
