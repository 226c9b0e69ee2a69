#include "canonpose/data/frame_alignment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"

namespace canonpose {
namespace {

/// Below this share of common numbers, cameras count from different numbers.
constexpr double kCommonNumbers = 0.25;
/// Numbers between those of frames are missing frames if at least this share of all numbers exists.
constexpr double kDenseShare = 0.5;
/// Steps between numbers that are this large in the median, and not all equal, come from a clock.
constexpr std::int64_t kClockStep = 8;
/// A camera whose frames are farther apart than those of another one by this factor has another frame rate.
constexpr double kSameRate = 1.2;

std::string RangeOf(const KeypointClip& clip) {
  return fmt::format("{} has {} frames ({} to {})", clip.name, clip.frame_count(), clip.frame_numbers.front(),
                     clip.frame_numbers.back());
}

/// "cam1 has 8 frames (0 to 7), cam2 has ...", of at most three cameras.
std::string Ranges(const std::vector<KeypointClip>& clips) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(clips.size(), 3); ++i)
    text += (i == 0 ? "" : ", ") + RangeOf(clips[i]);
  return text + (clips.size() > 3 ? ", ..." : "");
}

/// The clip with its frames at other places: frame i becomes frame to[i] of those in `numbers`; a negative place leaves
/// it out.
KeypointClip Spread(const KeypointClip& clip, const std::vector<std::int64_t>& numbers,
                    const std::vector<std::ptrdiff_t>& to) {
  const auto count = static_cast<std::ptrdiff_t>(clip.keypoint_count);
  KeypointClip spread = clip;
  spread.frame_numbers = numbers;
  spread.seconds_per_number = 0.0;
  spread.keypoints.assign(numbers.size() * static_cast<std::size_t>(count) * 2,
                          std::numeric_limits<float>::quiet_NaN());
  spread.confidence.assign(numbers.size() * static_cast<std::size_t>(count), 0.0F);
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (to[i] < 0) continue;
    const auto from = static_cast<std::ptrdiff_t>(i);
    std::copy_n(clip.keypoints.begin() + from * count * 2, count * 2, spread.keypoints.begin() + to[i] * count * 2);
    std::copy_n(clip.confidence.begin() + from * count, count, spread.confidence.begin() + to[i] * count);
  }
  return spread;
}

/// "cam1 8, cam2 8": how many of `total` frames each camera lacks; empty where none does.
std::string Missing(const std::vector<KeypointClip>& clips, std::size_t total) {
  std::string text;
  for (const KeypointClip& clip : clips) {
    const std::size_t missing = total - clip.frame_numbers.size();
    if (missing > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", clip.name, missing);
  }
  return text;
}

bool HaveSameNumbers(const std::vector<KeypointClip>& clips) {
  return std::all_of(clips.begin(), clips.end(),
                     [&](const KeypointClip& clip) { return clip.frame_numbers == clips.front().frame_numbers; });
}

/// The numbers of all cameras, and those between them that are missing everywhere.
std::vector<std::int64_t> AllNumbers(const std::vector<KeypointClip>& clips) {
  std::set<std::int64_t> all;
  for (const KeypointClip& clip : clips) all.insert(clip.frame_numbers.begin(), clip.frame_numbers.end());
  std::vector<std::int64_t> numbers(all.begin(), all.end());
  std::int64_t step = 0;
  for (std::size_t i = 1; i < numbers.size(); ++i) step = std::gcd(step, numbers[i] - numbers[i - 1]);
  if (step == 0) return numbers;
  const std::int64_t total = (numbers.back() - numbers.front()) / step + 1;
  if (static_cast<double>(numbers.size()) < kDenseShare * static_cast<double>(total)) return numbers;
  std::vector<std::int64_t> grid(static_cast<std::size_t>(total));
  for (std::size_t i = 0; i < grid.size(); ++i) grid[i] = numbers.front() + static_cast<std::int64_t>(i) * step;
  return grid;
}

void AlignByNumber(std::vector<KeypointClip>& clips) {
  const std::vector<std::int64_t> numbers = AllNumbers(clips);
  if (HaveSameNumbers(clips) && numbers.size() == clips.front().frame_numbers.size()) return;
  const std::string missing = Missing(clips, numbers.size());
  if (!missing.empty()) {
    LogInfo("frames are matched by the numbers in their names, {} to {}; missing of {}: {}", numbers.front(),
            numbers.back(), numbers.size(), missing);
  }
  for (KeypointClip& clip : clips) {
    std::vector<std::ptrdiff_t> to;
    to.reserve(clip.frame_numbers.size());
    auto place = numbers.begin();
    for (const std::int64_t number : clip.frame_numbers) {
      place = std::lower_bound(place, numbers.end(), number);
      to.push_back(place - numbers.begin());
    }
    clip = Spread(clip, numbers, to);
  }
}

void AlignInOrder(const std::vector<KeypointClip>& clips, bool is_wanted) {
  const KeypointClip& first = clips.front();
  for (const KeypointClip& clip : clips) {
    if (clip.frame_count() == first.frame_count()) continue;
    ThrowBadInput({clip.path, "", "as many frames from every camera", RangeOf(first) + ", " + RangeOf(clip),
                   is_wanted ? "use `align` frame-number if equal numbers mean equal times, or cut the clips to the "
                               "same frames"
                             : "number the frames so that equal numbers mean equal times, or cut the clips to the same "
                               "frames"});
  }
  if (HaveSameNumbers(clips)) return;
  if (is_wanted) {
    LogInfo("frames are matched in order although their numbers differ: {}", Ranges(clips));
  } else {
    LogWarning("the cameras' frame numbers have little or nothing in common ({}); frames are matched in order",
               Ranges(clips));
  }
}

/// The smallest share of a camera's numbers that another camera also has.
double SmallestCommonShare(const std::vector<KeypointClip>& clips) {
  std::map<std::int64_t, int> cameras_with;
  for (const KeypointClip& clip : clips) {
    for (const std::int64_t number : clip.frame_numbers) ++cameras_with[number];
  }
  double smallest = 1.0;
  for (const KeypointClip& clip : clips) {
    const auto common = std::count_if(clip.frame_numbers.begin(), clip.frame_numbers.end(),
                                      [&](std::int64_t number) { return cameras_with[number] > 1; });
    smallest = std::min(smallest, static_cast<double>(common) / static_cast<double>(clip.frame_count()));
  }
  return smallest;
}

/// The most usual distance between a clip's numbers: their median.
std::int64_t MedianStep(const KeypointClip& clip) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < clip.frame_numbers.size(); ++i)
    steps.push_back(clip.frame_numbers[i] - clip.frame_numbers[i - 1]);
  if (steps.empty()) return 0;
  const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), median, steps.end());
  return *median;
}

/// Whether a camera counts every frame and another, say, every second one, so that equal numbers are unequal times.
bool CountDifferently(const std::vector<KeypointClip>& clips) {
  const std::int64_t first = MedianStep(clips.front());
  return std::any_of(clips.begin(), clips.end(), [&](const KeypointClip& clip) { return MedianStep(clip) != first; });
}

/// Whether some cameras count from 0 and the others from 1, all without gaps.
bool CountFromZeroAndOne(const std::vector<KeypointClip>& clips) {
  std::set<std::int64_t> first;
  for (const KeypointClip& clip : clips) {
    first.insert(clip.frame_numbers.front());
    if (clip.frame_numbers.back() - clip.frame_numbers.front() + 1 != clip.frame_count()) return false;
  }
  return first == std::set<std::int64_t>{0, 1};
}

/// Whether the numbers are as irregular as those of a clock.
bool LookLikeTimes(const KeypointClip& clip) {
  std::int64_t divisor = 0;
  for (std::size_t i = 1; i < clip.frame_numbers.size(); ++i)
    divisor = std::gcd(divisor, clip.frame_numbers[i] - clip.frame_numbers[i - 1]);
  return MedianStep(clip) >= kClockStep * std::max<std::int64_t>(divisor, 1) && clip.frame_count() > 3;
}

/// The times of a clip's frames, from a common origin, in seconds or, where the unit is unknown, as numbered.
std::vector<double> TimesOf(const KeypointClip& clip, const KeypointClip& reference) {
  const double unit = clip.seconds_per_number > 0.0 ? clip.seconds_per_number : 1.0;
  const double reference_unit = reference.seconds_per_number > 0.0 ? reference.seconds_per_number : 1.0;
  // Long double keeps nanoseconds since 1970 apart.
  const long double origin = static_cast<long double>(reference.frame_numbers.front()) * reference_unit;
  std::vector<double> times;
  times.reserve(clip.frame_numbers.size());
  for (const std::int64_t number : clip.frame_numbers)
    times.push_back(static_cast<double>(static_cast<long double>(number) * unit - origin));
  return times;
}

double MedianInterval(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  if (steps.empty()) return 0.0;
  const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), median, steps.end());
  return *median;
}

/// A camera's frames, counted in intervals of its own clock: frame i, at times[i], is number counts[i].
struct CountedClock {
  std::vector<double> times;
  std::vector<double> counts;
  double interval = 0.0;

  /// The count at a time, between those of two frames or beyond them.
  [[nodiscard]] double CountAt(double time) const {
    if (time <= times.front()) return counts.front() + (time - times.front()) / interval;
    if (time >= times.back()) return counts.back() + (time - times.back()) / interval;
    const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
    const double share = (time - times[after - 1]) / (times[after] - times[after - 1]);
    return counts[after - 1] + share * (counts[after] - counts[after - 1]);
  }
};

CountedClock CountClock(const std::vector<double>& times) {
  CountedClock clock;
  clock.times = times;
  clock.interval = MedianInterval(times);
  if (times.size() < 2) {
    clock.interval = 1.0;
    clock.counts = {0.0};
    return clock;
  }
  // The mean interval is more precise than the median of jittering ones, once lost frames are known.
  for (int pass = 0; pass < 2; ++pass) {
    clock.counts = {0.0};
    for (std::size_t i = 1; i < times.size(); ++i) {
      const double steps = std::max(1.0, std::round((times[i] - times[i - 1]) / clock.interval));
      clock.counts.push_back(clock.counts.back() + steps);
    }
    clock.interval = (times.back() - times.front()) / clock.counts.back();
  }
  return clock;
}

/// The clip whose clock the others are matched to: of those with the highest frame rate, the longest.
std::size_t ReferenceOf(const std::vector<std::vector<double>>& times) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& clip : times) {
    if (clip.size() > 1) shortest = std::min(shortest, MedianInterval(clip));
  }
  std::size_t best = 0;
  for (std::size_t c = 0; c < times.size(); ++c) {
    const bool is_fast = times[c].size() > 1 && MedianInterval(times[c]) <= kSameRate * shortest;
    const bool is_best_fast = times[best].size() > 1 && MedianInterval(times[best]) <= kSameRate * shortest;
    if (is_fast && (!is_best_fast || times[c].size() > times[best].size())) best = c;
  }
  return best;
}

/// Where a camera's frames lie on the reference's count. A constant phase is taken off before rounding, since otherwise
/// jitter would decide whether a frame half an interval off belongs to one or to the next.
std::vector<std::int64_t> PlacesOf(const std::vector<double>& times, const CountedClock& reference) {
  constexpr double kTwoPi = 6.283185307179586;
  double sine = 0.0;
  double cosine = 0.0;
  std::vector<double> counts;
  counts.reserve(times.size());
  for (const double time : times) {
    counts.push_back(reference.CountAt(time));
    sine += std::sin(kTwoPi * counts.back());
    cosine += std::cos(kTwoPi * counts.back());
  }
  const double phase = std::atan2(sine, cosine) / kTwoPi;
  std::vector<std::int64_t> places;
  places.reserve(counts.size());
  for (const double count : counts) places.push_back(std::llround(count - phase));
  return places;
}

std::string Rate(double fps) { return fmt::format("{:.5g} frames per second", fps); }

double AlignByTime(std::vector<KeypointClip>& clips) {
  const bool is_unit_known = clips.front().seconds_per_number > 0.0;
  std::vector<std::vector<double>> times;
  for (const KeypointClip& clip : clips) times.push_back(TimesOf(clip, clips.front()));
  const std::size_t reference_clip = ReferenceOf(times);
  const CountedClock reference = CountClock(times[reference_clip]);
  std::vector<std::vector<std::int64_t>> places;
  std::string apart;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    if (times[c].front() > reference.times.back() || times[c].back() < reference.times.front()) {
      const double shift = reference.times.front() - times[c].front();
      for (double& time : times[c]) time += shift;
      apart += (apart.empty() ? "" : ", ") + clips[c].name;
    }
    places.push_back(PlacesOf(times[c], reference));
  }
  if (!apart.empty()) {
    LogWarning(
        "the times in the names of {}'s frames have nothing in common with those of {}; their first frames are taken "
        "to be simultaneous",
        apart, clips[reference_clip].name);
  }

  std::set<std::int64_t> used;
  for (const auto& of_clip : places) used.insert(of_clip.begin(), of_clip.end());
  std::vector<std::int64_t> numbers(used.begin(), used.end());
  const std::int64_t total = numbers.back() - numbers.front() + 1;
  if (static_cast<double>(numbers.size()) >= kDenseShare * static_cast<double>(total)) {
    const std::int64_t first = numbers.front();
    numbers.resize(static_cast<std::size_t>(total));
    std::iota(numbers.begin(), numbers.end(), first);
  }
  std::string missing;
  std::size_t surplus = 0;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    std::vector<std::ptrdiff_t> to;
    for (std::size_t i = 0; i < places[c].size(); ++i) {
      // Of two frames at one place the first is kept.
      const bool is_surplus = i > 0 && places[c][i] <= places[c][i - 1];
      if (is_surplus) places[c][i] = places[c][i - 1];
      surplus += is_surplus ? 1 : 0;
      const auto place = std::lower_bound(numbers.begin(), numbers.end(), places[c][i]) - numbers.begin();
      to.push_back(is_surplus ? -1 : place);
    }
    const auto kept =
        static_cast<std::size_t>(std::count_if(to.begin(), to.end(), [](auto place) { return place >= 0; }));
    if (kept < numbers.size())
      missing += fmt::format("{}{} {}", missing.empty() ? "" : ", ", clips[c].name, numbers.size() - kept);
    std::vector<std::int64_t> counted(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) counted[i] = numbers[i] - numbers.front();
    clips[c] = Spread(clips[c], counted, to);
  }
  const double fps = is_unit_known ? 1.0 / reference.interval : 0.0;
  LogInfo("frames are matched by the times in their names{}{}{}", fps > 0.0 ? ", " + Rate(fps) : "",
          missing.empty() ? "" : fmt::format("; missing of {}: {}", numbers.size(), missing),
          surplus == 0 ? "" : fmt::format("; {} frames that share a time with another one are left out", surplus));
  return fps;
}

}  // namespace

double AlignFrames(std::vector<KeypointClip>& clips, FrameAlignment alignment) {
  const auto named_by_clock =
      std::count_if(clips.begin(), clips.end(), [](const KeypointClip& clip) { return clip.seconds_per_number > 0.0; });
  if (alignment == FrameAlignment::kOrder) {
    AlignInOrder(clips, true);
    return 0.0;
  }
  if (named_by_clock == std::ssize(clips)) return AlignByTime(clips);
  if (named_by_clock > 0) {
    const auto clock =
        std::find_if(clips.begin(), clips.end(), [](const auto& clip) { return clip.seconds_per_number > 0.0; });
    const auto count =
        std::find_if(clips.begin(), clips.end(), [](const auto& clip) { return clip.seconds_per_number == 0.0; });
    ThrowBadInput(
        {count->path, "", fmt::format("frames named by the time, as those of {}", clock->name),
         fmt::format("frames numbered from {} to {}", count->frame_numbers.front(), count->frame_numbers.back()),
         "name all cameras' frames in one way, or set `align` order if they match in order"});
  }
  const double common = SmallestCommonShare(clips);
  if (common < 1.0 && std::all_of(clips.begin(), clips.end(), LookLikeTimes)) return AlignByTime(clips);
  if (alignment == FrameAlignment::kFrameNumber) {
    if (common > 0.0) {
      AlignByNumber(clips);
      return 0.0;
    }
    ThrowBadInput({clips[1].path, "", "frame numbers that another camera also has",
                   RangeOf(clips[0]) + ", " + RangeOf(clips[1]),
                   "leave out `align` frame-number if the frames match in order"});
  }
  const bool have_same_counts = std::all_of(clips.begin(), clips.end(), [&](const KeypointClip& clip) {
    return clip.frame_count() == clips.front().frame_count();
  });
  const bool is_one_off = have_same_counts && CountFromZeroAndOne(clips);
  if (common < kCommonNumbers || (have_same_counts && CountDifferently(clips))) {
    AlignInOrder(clips, false);
  } else {
    AlignByNumber(clips);
    if (is_one_off) {
      LogWarning(
          "some cameras' frames are numbered from 0 and others' from 1; if their first frames are simultaneous, set "
          "`align` order");
    }
  }
  return 0.0;
}

bool HaveCommonNumbers(const std::vector<KeypointClip>& clips) {
  const bool is_clock = std::ranges::any_of(clips, [](const auto& clip) { return clip.seconds_per_number > 0.0; }) ||
                        std::ranges::all_of(clips, LookLikeTimes);
  return is_clock || SmallestCommonShare(clips) >= kCommonNumbers;
}

double CountFrames(KeypointClip& clip) {
  if (clip.seconds_per_number == 0.0) return 0.0;
  const CountedClock clock = CountClock(TimesOf(clip, clip));
  for (std::size_t i = 0; i < clock.counts.size(); ++i) clip.frame_numbers[i] = std::llround(clock.counts[i]);
  clip.seconds_per_number = 0.0;
  if (clock.times.size() < 2) return 0.0;
  const double fps = 1.0 / clock.interval;
  LogInfo("frames are named by the time: {}", Rate(fps));
  return fps;
}

}  // namespace canonpose
