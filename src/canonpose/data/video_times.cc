#include "canonpose/data/video_times.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace canonpose {
namespace {

/// Rates that differ by less are one: a clock that is off by 100 parts in a million is a bad one.
constexpr double kSameRate = 2e-4;
/// How far from a whole number of intervals a time of a constant rate may be; containers round to milliseconds.
constexpr double kRegular = 0.1;
constexpr double kMicrosecond = 1e-6;

bool HasTimeOfEveryFrame(const KeypointClip& clip, const std::optional<VideoFacts>& facts) {
  return facts && clip.seconds_per_number == 0.0 && std::ranges::all_of(clip.frame_numbers, [&](std::int64_t number) {
           return number >= 0 && number < std::ssize(facts->times_seconds);
         });
}

/// Whether all times are multiples of one interval.
bool IsRegular(const VideoFacts& facts) {
  return facts.fps > 0.0 && std::ranges::all_of(facts.times_seconds, [&](double time) {
           const double count = (time - facts.times_seconds.front()) * facts.fps;
           return std::abs(count - std::round(count)) < kRegular;
         });
}

}  // namespace

double NumberByVideoTimes(std::vector<KeypointClip>& clips, const std::vector<std::optional<VideoFacts>>& facts) {
  for (std::size_t c = 0; c < clips.size(); ++c) {
    if (!HasTimeOfEveryFrame(clips[c], facts[c])) return 0.0;
  }
  const double fps = clips.empty() ? 0.0 : facts.front()->fps;
  const bool is_regular = std::ranges::all_of(facts, [&](const std::optional<VideoFacts>& of_clip) {
    return IsRegular(*of_clip) && std::abs(of_clip->fps - fps) <= kSameRate * fps;
  });
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const std::vector<double>& times = facts[c]->times_seconds;
    for (std::int64_t& number : clips[c].frame_numbers) {
      const double time = times[static_cast<std::size_t>(number)] - times.front();
      number = std::llround(is_regular ? time * fps : time / kMicrosecond);
    }
    clips[c].seconds_per_number = is_regular ? 0.0 : kMicrosecond;
  }
  return is_regular ? fps : 0.0;
}

double CommonRate(const std::vector<std::optional<VideoFacts>>& facts) {
  constexpr double kSame = 1e-3;
  const double fps = facts.empty() || !facts.front() ? 0.0 : facts.front()->fps;
  const bool is_common = std::ranges::all_of(facts, [&](const std::optional<VideoFacts>& of_clip) {
    return of_clip && std::abs(of_clip->fps - fps) <= kSame * fps;
  });
  return is_common ? fps : 0.0;
}

}  // namespace canonpose
