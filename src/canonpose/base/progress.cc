#include "canonpose/base/progress.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "canonpose/base/log.h"

namespace canonpose {
namespace {
constexpr std::chrono::milliseconds kInPlacePeriod{200};
}  // namespace

std::string FormatDuration(double seconds) {
  const long total = static_cast<long>(seconds + 0.5);
  if (total >= 3600) return fmt::format("{} h {:02} min", total / 3600, total % 3600 / 60);
  if (total >= 60) return fmt::format("{} min {:02} s", total / 60, total % 60);
  return fmt::format("{} s", total);
}

Progress::Progress(std::string label, long total, long done, Clock::duration lasting_period)
    : label_(std::move(label)),
      total_(total),
      first_(done),
      is_terminal_(isatty(STDERR_FILENO) == 1),
      lasting_period_(lasting_period),
      next_lasting_(start_ + lasting_period),
      next_in_place_(is_terminal_ ? start_ + kInPlacePeriod : Clock::time_point::max()) {}

Progress::~Progress() {
  if (is_terminal_) fmt::print(stderr, "\r\033[K");
}

bool Progress::IsDue() const { return Clock::now() >= std::min(next_lasting_, next_in_place_); }

void Progress::Update(long done, const std::string& detail) {
  const Clock::time_point now = Clock::now();
  if (now >= next_lasting_) {
    next_lasting_ = now + lasting_period_;
    LogInfoText(Describe(done, detail, now));
  } else if (now >= next_in_place_) {
    next_in_place_ = now + kInPlacePeriod;
    // A line that is longer than the terminal is wide is cut there: wrapped, its beginning could not be cleared.
    fmt::print(stderr, "\r\033[K\033[?7l{}\033[?7h", Describe(done, detail, now));
    std::fflush(stderr);
  }
}

std::string Progress::Describe(long done, const std::string& detail, Clock::time_point now) const {
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double speed = elapsed > 0 ? static_cast<double>(done - first_) / elapsed : 0.0;
  std::string line = fmt::format("{} {}/{}", label_, done, total_);
  if (!detail.empty()) line += "  " + detail;
  if (speed > 0) {
    line += fmt::format("  {:.1f}/s  {} left", speed, FormatDuration(static_cast<double>(total_ - done) / speed));
  }
  return line;
}

}  // namespace canonpose
