#include "canonpose/data/clip_timing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"
#include "canonpose/base/median.h"
#include "canonpose/data/video_times.h"
#include "canonpose/geometry/interpolation.h"

namespace canonpose {
namespace {

/// Videos that differ by less were probably started and stopped together.
constexpr double kSameLengthSeconds = 0.5;
/// No more is needed of a person, and interpolating slower cameras there would only cost time.
constexpr double kHighestRate = 60.0;
/// Frames farther apart than this many usual intervals have lost ones between them.
constexpr double kNoFrameLost = 1.5;
/// A time this near a frame, in intervals, is that frame's.
constexpr double kSameFrame = 1e-3;

constexpr float kNotSeen = std::numeric_limits<float>::quiet_NaN();

double UsualInterval(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  return Median(std::move(intervals));
}

/// A clip at the times of its frames.
class TimedClip {
 public:
  TimedClip(const KeypointClip& clip, const std::vector<double>& times)
      : clip_(clip), times_(times), interval_(UsualInterval(times)) {}

  /// The keypoints at a time go to frame `to` of `resampled`, which has none yet.
  void Put(double time, std::size_t to, KeypointClip& resampled) const;

 private:
  [[nodiscard]] std::size_t Index(std::ptrdiff_t frame, int keypoint) const {
    return static_cast<std::size_t>(frame) * static_cast<std::size_t>(clip_.keypoint_count) +
           static_cast<std::size_t>(keypoint);
  }
  [[nodiscard]] bool Sees(std::ptrdiff_t frame, int keypoint) const {
    return frame >= 0 && frame < clip_.frame_count() && clip_.confidence[Index(frame, keypoint)] > 0.0F;
  }
  /// Whether no frame was lost between a frame and the next.
  [[nodiscard]] bool IsNext(std::ptrdiff_t frame) const {
    return frame >= 0 && frame + 1 < clip_.frame_count() &&
           times_[static_cast<std::size_t>(frame) + 1] - times_[static_cast<std::size_t>(frame)] <
               kNoFrameLost * interval_;
  }
  void Copy(std::ptrdiff_t frame, std::size_t to, KeypointClip& resampled) const;
  void Interpolate(std::ptrdiff_t before, double share, std::size_t to, KeypointClip& resampled) const;

  const KeypointClip& clip_;
  const std::vector<double>& times_;
  double interval_;
};

void TimedClip::Copy(std::ptrdiff_t frame, std::size_t to, KeypointClip& resampled) const {
  const auto count = static_cast<std::ptrdiff_t>(clip_.keypoint_count);
  const auto target = static_cast<std::ptrdiff_t>(to);
  std::copy_n(clip_.keypoints.begin() + 2 * frame * count, 2 * count, resampled.keypoints.begin() + 2 * target * count);
  std::copy_n(clip_.confidence.begin() + frame * count, count, resampled.confidence.begin() + target * count);
}

void TimedClip::Interpolate(std::ptrdiff_t before, double share, std::size_t to, KeypointClip& resampled) const {
  const double s = share;
  for (int k = 0; k < clip_.keypoint_count; ++k) {
    if (!Sees(before, k) || !Sees(before + 1, k)) continue;
    const bool has_outer = IsNext(before - 1) && IsNext(before + 1) && Sees(before - 1, k) && Sees(before + 2, k);
    const std::array<double, 4> weights = has_outer ? CubicWeights(s) : LinearWeights(s);
    std::array<double, 2> point = {0.0, 0.0};
    for (std::ptrdiff_t i = 0; i < 4; ++i) {
      const double weight = weights[static_cast<std::size_t>(i)];
      if (weight == 0.0) continue;
      const std::size_t from = Index(before - 1 + i, k);
      for (std::size_t axis = 0; axis < 2; ++axis) point[axis] += weight * clip_.keypoints[2 * from + axis];
    }
    const std::size_t place = Index(static_cast<std::ptrdiff_t>(to), k);
    for (std::size_t axis = 0; axis < 2; ++axis)
      resampled.keypoints[2 * place + axis] = static_cast<float>(point[axis]);
    resampled.confidence[place] =
        static_cast<float>((1.0 - s) * clip_.confidence[Index(before, k)] + s * clip_.confidence[Index(before + 1, k)]);
  }
}

void TimedClip::Put(double time, std::size_t to, KeypointClip& resampled) const {
  const double near = kSameFrame * interval_;
  const auto after = std::ranges::lower_bound(times_, time - near) - times_.begin();
  if (after == std::ssize(times_)) return;
  if (std::abs(times_[static_cast<std::size_t>(after)] - time) <= near) {
    Copy(after, to, resampled);
  } else if (IsNext(after - 1)) {
    const double before = times_[static_cast<std::size_t>(after) - 1];
    const double share = (time - before) / (times_[static_cast<std::size_t>(after)] - before);
    Interpolate(after - 1, share, to, resampled);
  }
}

double CommonRateOf(const std::vector<std::vector<double>>& times) {
  double highest = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& of_clip : times) {
    if (of_clip.size() < 2) continue;
    const double rate = 1.0 / UsualInterval(of_clip);
    lowest = std::min(lowest, rate);
    if (rate <= kHighestRate * 1.01) highest = std::max(highest, rate);
  }
  return highest > 0.0 ? highest : lowest;
}

/// Every clip has its own first frame as number 0, and all have as many; those that are missing know nothing.
void CountFromOwnFirst(std::vector<KeypointClip>& clips) {
  std::vector<std::vector<double>> numbers;
  for (const KeypointClip& clip : clips) {
    numbers.emplace_back();
    for (const std::int64_t number : clip.frame_numbers) {
      numbers.back().push_back(static_cast<double>(number - clip.frame_numbers.front()));
    }
  }
  ResampleToCommonRate(numbers, clips);
}

/// The times of a clip's frames from its first one, if frames are `interval` seconds apart or named by the time, or
/// else by the video's time stamps; empty where nothing says them.
std::vector<double> FrameTimes(const KeypointClip& clip, const std::optional<VideoFacts>& facts, double interval) {
  const double unit = interval > 0.0 ? interval : clip.seconds_per_number;
  const bool has_stamps = facts && std::ranges::all_of(clip.frame_numbers, [&](std::int64_t number) {
                            return number >= 0 && number < std::ssize(facts->times_seconds);
                          });
  std::vector<double> times;
  if (!(unit > 0.0) && !has_stamps) return times;
  for (const std::int64_t number : clip.frame_numbers) {
    times.push_back(unit > 0.0 ? static_cast<double>(number - clip.frame_numbers.front()) * unit
                               : facts->times_seconds[static_cast<std::size_t>(number)] - facts->times_seconds.front());
  }
  return times;
}

/// The times of every clip's frames; empty unless they are known of all.
std::vector<std::vector<double>> KnownTimes(const std::vector<KeypointClip>& clips,
                                            const std::vector<std::optional<VideoFacts>>& facts,
                                            const GivenRates& given, FrameAlignment alignment) {
  std::vector<std::vector<double>> times;
  const bool use_common = alignment == FrameAlignment::kNone || !given.of_camera.empty();
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const double rate = use_common ? given.Of(clips[c].name) : 0.0;
    times.push_back(FrameTimes(clips[c], facts[c], rate > 0.0 ? 1.0 / rate : 0.0));
    if (!times.back().empty()) continue;
    if (given.of_camera.empty()) return {};
    ThrowInvalidArgument("`fps`: expected the rate of every camera, found none of {}", clips[c].name);
  }
  return times;
}

/// "cam1 25, cam2 50"
std::string RatesOf(const std::vector<KeypointClip>& clips, const std::vector<std::vector<double>>& times) {
  std::string text;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", clips[c].name, 1.0 / UsualInterval(times[c]));
  }
  return text;
}

bool DifferInLength(const std::vector<std::vector<double>>& times) {
  double shortest = std::numeric_limits<double>::infinity();
  double longest = 0.0;
  for (const std::vector<double>& of_clip : times) {
    shortest = std::min(shortest, of_clip.back());
    longest = std::max(longest, of_clip.back());
  }
  return longest - shortest > kSameLengthSeconds;
}

bool HaveAsMany(const std::vector<KeypointClip>& clips) {
  return std::ranges::all_of(
      clips, [&](const KeypointClip& clip) { return clip.frame_count() == clips.front().frame_count(); });
}

/// Of cameras that have nothing to do with each other's numbers.
ClipTiming TimeByOwnClocks(const std::vector<std::vector<double>>& times, std::vector<KeypointClip>& clips) {
  ClipTiming timing;
  timing.timing = FrameTiming::kOwn;
  if (times.empty()) {
    LogInfo("every camera's frames are counted from its own first one; their rates are not known");
    CountFromOwnFirst(clips);
    return timing;
  }
  const std::string rates = RatesOf(clips, times);
  timing.fps = ResampleToCommonRate(times, clips);
  LogInfo("every camera's frames are counted from its own first one; all are taken at {:.5g} per second ({})",
          timing.fps, rates);
  return timing;
}

/// Of videos, or of cameras whose rates are given.
ClipTiming TimeByKnownTimes(const std::vector<std::vector<double>>& times,
                            const std::vector<std::optional<VideoFacts>>& facts, bool rates_are_given,
                            std::vector<KeypointClip>& clips) {
  ClipTiming timing;
  timing.timing = DifferInLength(times) ? FrameTiming::kUnsure : FrameTiming::kCommon;
  timing.fps = rates_are_given ? 0.0 : NumberByVideoTimes(clips, facts);
  if (timing.fps > 0.0) {
    AlignFrames(clips, FrameAlignment::kAutomatic);
  } else {
    timing.timing = FrameTiming::kUnsure;
    const std::string found = RatesOf(clips, times);
    timing.fps = ResampleToCommonRate(times, clips);
    LogInfo("the cameras' rates differ or vary; all are taken at {:.5g} frames per second ({})", timing.fps, found);
  }
  if (timing.timing == FrameTiming::kUnsure) {
    LogInfo(
        "the recordings differ in length or rate, so that they may have begun at different times: `solve` looks at "
        "their motion");
  }
  return timing;
}

void WarnOfOtherRate(double given, double found) {
  constexpr double kSame = 0.02;
  if (found <= 0.0 || std::abs(given - found) <= kSame * found) return;
  LogWarning("`fps` is {:.5g}, but the times of the frames say {:.5g} frames per second", given, found);
}

}  // namespace

double ResampleToCommonRate(const std::vector<std::vector<double>>& times_seconds, std::vector<KeypointClip>& clips) {
  const double rate = CommonRateOf(times_seconds);
  if (!std::isfinite(rate)) {
    ThrowBadInput({clips.front().path, "", "at least two frames from one of the cameras", "one", "give longer clips"});
  }
  std::size_t frames = 1;
  for (const std::vector<double>& times : times_seconds) {
    frames = std::max(frames, static_cast<std::size_t>(std::floor(times.back() * rate + kSameFrame)) + 1);
  }
  std::vector<std::int64_t> numbers(frames);
  std::iota(numbers.begin(), numbers.end(), 0);
  for (std::size_t c = 0; c < clips.size(); ++c) {
    const KeypointClip own = clips[c];
    const std::size_t values = frames * static_cast<std::size_t>(own.keypoint_count);
    clips[c].frame_numbers = numbers;
    clips[c].seconds_per_number = 0.0;
    clips[c].keypoints.assign(2 * values, kNotSeen);
    clips[c].confidence.assign(values, 0.0F);
    const TimedClip timed(own, times_seconds[c]);
    for (std::size_t n = 0; n < frames; ++n) timed.Put(static_cast<double>(n) / rate, n, clips[c]);
  }
  return rate;
}

ClipTiming TimeClips(std::vector<KeypointClip>& clips, const std::vector<std::optional<VideoFacts>>& facts,
                     const GivenRates& given, FrameAlignment alignment) {
  const std::vector<std::vector<double>> times = KnownTimes(clips, facts, given, alignment);
  if (alignment == FrameAlignment::kNone) return TimeByOwnClocks(times, clips);
  const bool is_automatic = alignment == FrameAlignment::kAutomatic;
  const bool have_facts = std::ranges::all_of(facts, [](const auto& of_clip) { return of_clip.has_value(); });
  ClipTiming timing;
  if (is_automatic && !times.empty() && (have_facts || !given.of_camera.empty())) {
    timing = TimeByKnownTimes(times, facts, !given.of_camera.empty(), clips);
  } else if (is_automatic && !HaveAsMany(clips) && !HaveCommonNumbers(clips)) {
    LogWarning("the cameras' frame numbers have little or nothing in common, and their recordings differ in length");
    return TimeByOwnClocks(KnownTimes(clips, facts, given, FrameAlignment::kNone), clips);
  } else {
    const double video_fps = CommonRate(facts);
    const double times_fps = AlignFrames(clips, alignment);
    timing.fps = times_fps > 0.0 ? times_fps : video_fps;
  }
  if (given.all > 0.0 && given.of_camera.empty()) {
    WarnOfOtherRate(given.all, timing.fps);
    timing.fps = given.all;
  }
  return timing;
}

}  // namespace canonpose
