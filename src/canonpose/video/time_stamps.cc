#include "canonpose/video/time_stamps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace canonpose {
namespace {

/// Where a container states no rate, or an impossible one.
constexpr double kUsualFps = 30.0;
constexpr double kLargestFps = 10000.0;
/// A longer step must be confirmed by the next stamp.
constexpr double kUsualIntervals = 5.0;
/// Recordings of a screen pause for as long as nothing moves; a longer pause is a damaged stamp.
constexpr double kLongestPauseSeconds = 3600.0;
/// So many stamps in a row that grow are believed, wherever they begin.
constexpr int kStampsOfNewBeginning = 5;

/// No decoder holds back more frames than that.
constexpr long kLongestDelay = 16;

}  // namespace

TimeStamps::TimeStamps(double fps)
    : interval_(1.0 / (std::isfinite(fps) && fps > 0.0 && fps < kLargestFps ? fps : kUsualFps)),
      last_stamp_(std::numeric_limits<double>::quiet_NaN()) {}

long TimeStamps::corrected() const { return trailing_ <= kLongestDelay ? corrected_ - trailing_ : corrected_; }

bool TimeStamps::IsSoonAfter(double time, double before) const {
  return time > before && time <= before + kUsualIntervals * std::max(interval_, step_);
}

bool TimeStamps::IsBelievable(double time, double following) const {
  if (!IsSoonAfter(time, last_)) {
    return time > last_ && following > time && time < last_ + kLongestPauseSeconds &&
           following < time + kLongestPauseSeconds;
  }
  // If the next one is before this one and fits the last one as well, this one is wrong.
  return !(following < time && IsSoonAfter(following, last_));
}

double TimeStamps::Guess(double following) const {
  const double usual = last_ + interval_;
  return IsSoonAfter(following, last_) ? std::min(usual, 0.5 * (last_ + following)) : usual;
}

bool TimeStamps::IsNewBeginning(double stamp_seconds) {
  const bool grows = stamp_seconds > last_stamp_ && stamp_seconds < last_stamp_ + kLongestPauseSeconds;
  growing_ = grows ? growing_ + 1 : 0;
  return growing_ >= kStampsOfNewBeginning;
}

double TimeStamps::Next(double stamp_seconds, double following) {
  const bool is_first = frames_++ == 0;
  bool is_believed = true;
  if (!has_origin_ && std::isfinite(stamp_seconds)) {
    if (!is_first) last_ += interval_;
    origin_ = stamp_seconds - last_;
    has_origin_ = true;
  } else if (IsBelievable(stamp_seconds - origin_, following - origin_)) {
    step_ = stamp_seconds - origin_ - last_;
    last_ = stamp_seconds - origin_;
  } else if (IsNewBeginning(stamp_seconds)) {
    last_ += stamp_seconds - last_stamp_;
    origin_ = stamp_seconds - last_;
  } else {
    if (!is_first) last_ = Guess(following - origin_);
    is_believed = false;
  }
  if (is_believed) growing_ = 0;
  trailing_ = is_believed ? 0 : trailing_ + 1;
  corrected_ += is_believed ? 0 : 1;
  last_stamp_ = stamp_seconds;
  return last_;
}

}  // namespace canonpose
