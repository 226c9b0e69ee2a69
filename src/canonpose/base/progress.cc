#include "canonpose/base/progress.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace canonpose {

std::string FormatDuration(double seconds) {
  const long total = std::lround(seconds);
  if (total >= 3600) return fmt::format("{} h {:02} min", total / 3600, total % 3600 / 60);
  if (total >= 60) return fmt::format("{} min {:02} s", total / 60, total % 60);
  return fmt::format("{} s", total);
}

Progress::Progress(std::string label, long total, long done, Clock::duration period)
    : first_(done), period_(period), next_(start_ + period) {
  state_.label = std::move(label);
  state_.total = total;
  state_.done = done;
}

Progress::~Progress() {
  if (!has_sent_) return;
  state_.has_ended = true;
  try {
    internal::SendProgress(state_);
  } catch (...) {  // NOLINT(bugprone-empty-catch): a destructor has nowhere to report it
  }
}

bool Progress::IsDue() const { return internal::WantsProgress() && Clock::now() >= next_; }

void Progress::Update(long done, const std::string& detail) {
  state_.done = done;
  if (!IsDue()) return;
  const Clock::time_point now = Clock::now();
  next_ = now + period_;
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  state_.detail = detail;
  state_.per_second = elapsed > 0 ? static_cast<double>(done - first_) / elapsed : 0.0;
  state_.seconds_left = state_.per_second > 0 ? static_cast<double>(state_.total - done) / state_.per_second : 0.0;
  has_sent_ = true;
  internal::SendProgress(state_);
}

}  // namespace canonpose
