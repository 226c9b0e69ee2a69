#include "canonpose/base/progress.h"

#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "canonpose/base/log.h"

namespace canonpose {
namespace {
constexpr std::chrono::milliseconds kTerminalPeriod{200};
constexpr std::chrono::seconds kPlainPeriod{10};
}  // namespace

std::string FormatDuration(double seconds) {
  const long total = static_cast<long>(seconds + 0.5);
  if (total >= 3600) return fmt::format("{} h {:02} min", total / 3600, total % 3600 / 60);
  if (total >= 60) return fmt::format("{} min {:02} s", total / 60, total % 60);
  return fmt::format("{} s", total);
}

Progress::Progress(std::string label, long total, long done)
    : label_(std::move(label)), total_(total), first_(done), is_terminal_(isatty(STDERR_FILENO) == 1) {
  next_show_ = start_ + (is_terminal_ ? Clock::duration(kTerminalPeriod) : Clock::duration(kPlainPeriod));
}

Progress::~Progress() {
  if (is_terminal_) fmt::print(stderr, "\r\033[K");
}

bool Progress::IsDue() const { return Clock::now() >= next_show_; }

void Progress::Update(long done, const std::string& detail) {
  const Clock::time_point now = Clock::now();
  if (now < next_show_) return;
  next_show_ = now + (is_terminal_ ? Clock::duration(kTerminalPeriod) : Clock::duration(kPlainPeriod));
  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double speed = elapsed > 0 ? static_cast<double>(done - first_) / elapsed : 0.0;
  std::string line = fmt::format("{} {}/{}", label_, done, total_);
  if (!detail.empty()) line += "  " + detail;
  if (speed > 0) {
    line += fmt::format("  {:.1f}/s  {} left", speed, FormatDuration(static_cast<double>(total_ - done) / speed));
  }
  if (is_terminal_) {
    fmt::print(stderr, "\r\033[K{}", line);
    std::fflush(stderr);
  } else {
    LogInfoText(line);
  }
}

}  // namespace canonpose
