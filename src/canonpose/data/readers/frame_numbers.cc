#include "canonpose/data/readers/frame_numbers.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace canonpose {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
/// Seconds since 1970 in the years 2001 to 2033; what is later does not fit into a frame number in nanoseconds.
constexpr std::int64_t kFirstEpochSecond = 978'000'000;
constexpr std::int64_t kLastEpochSecond = 1'999'999'999;
/// Frames that are closer or farther apart, in the median, are not named by a clock.
constexpr std::int64_t kShortestStepNs = 1'900'000;
constexpr std::int64_t kLongestStepNs = 10 * kNsPerSecond;
/// More digits do not fit into 64 bits.
constexpr std::size_t kLongestNumber = 18;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// The name without its extension and without suffixes that contain digits.
std::string_view Stem(std::string_view name) {
  // A suffix that is a number is not an extension: "cam01.0012" has none.
  const std::size_t dot = name.rfind('.');
  if (dot != std::string_view::npos && dot > 0 &&
      std::any_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(),
                  [](unsigned char c) { return std::isalpha(c) != 0; })) {
    name = name.substr(0, dot);
  }
  // The "2" in suffixes such as "_keypoints_2d" is not a frame number.
  if (name.ends_with("_2d")) name.remove_suffix(3);
  return name;
}

/// A run of digits in a name.
struct Group {
  std::string_view digits;
  char before = 0;       ///< the character before it; 0 at the beginning
  bool is_next = false;  ///< whether that is all there is between this group and the previous one

  [[nodiscard]] std::size_t size() const { return digits.size(); }
  /// The number that its last 18 digits make.
  [[nodiscard]] std::int64_t Value() const {
    std::int64_t value = 0;
    for (const char c : digits.substr(size() - std::min(size(), kLongestNumber))) value = 10 * value + (c - '0');
    return value;
  }
};

std::vector<Group> GroupsOf(std::string_view stem) {
  std::vector<Group> groups;
  std::size_t end_of_last = 0;
  for (std::size_t i = 0; i < stem.size();) {
    if (!IsDigit(stem[i])) {
      ++i;
      continue;
    }
    const std::size_t begin = i;
    while (i < stem.size() && IsDigit(stem[i])) ++i;
    groups.push_back({stem.substr(begin, i - begin), begin > 0 ? stem[begin - 1] : '\0',
                      !groups.empty() && begin == end_of_last + 1});
    end_of_last = i;
  }
  return groups;
}

/// How a name writes a time. All names of a camera must do so in the same way.
enum class ClockForm { kSeconds, kEpoch, kDayTime };

struct Clock {
  ClockForm form;
  std::int64_t whole_seconds;
  std::string_view fraction;  ///< decimal digits of the second
};

bool IsEpoch(std::int64_t seconds) { return seconds >= kFirstEpochSecond && seconds <= kLastEpochSecond; }

/// Days since 1970-01-01 in the Gregorian calendar (Hinnant, "chrono-Compatible Low-Level Date Algorithms").
std::int64_t DaysSince1970(std::int64_t year, std::int64_t month, std::int64_t day) {
  if (month <= 2) --year;
  const std::int64_t era = year / 400;
  const std::int64_t year_of_era = year - 400 * era;
  const std::int64_t day_of_year = (153 * (month > 2 ? month - 3 : month + 9) + 2) / 5 + day - 1;
  return era * 146097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719468;
}

std::int64_t ToNumber(std::string_view digits) {
  std::int64_t value = 0;
  for (const char c : digits) value = 10 * value + (c - '0');
  return value;
}

/// Seconds of the day of "HHMMSS"; nothing where it is not a time.
std::optional<std::int64_t> SecondsOfDay(std::string_view digits) {
  const std::int64_t hour = ToNumber(digits.substr(0, 2));
  const std::int64_t minute = ToNumber(digits.substr(2, 2));
  const std::int64_t second = ToNumber(digits.substr(4, 2));
  if (hour > 23 || minute > 59 || second > 60) return std::nullopt;
  return 3600 * hour + 60 * minute + second;
}

/// Seconds from 1970 to the beginning of the day "YYYYMMDD"; nothing where it is not a date.
std::optional<std::int64_t> SecondsOfDate(std::string_view digits) {
  const std::int64_t year = ToNumber(digits.substr(0, 4));
  const std::int64_t month = ToNumber(digits.substr(4, 2));
  const std::int64_t day = ToNumber(digits.substr(6, 2));
  if (year < 2001 || year > 2032 || month < 1 || month > 12 || day < 1 || day > 31) return std::nullopt;
  return 86400 * DaysSince1970(year, month, day);
}

/// The date at the end of `groups`, as YYYYMMDD or YYYY MM DD; nothing where there is none.
std::optional<std::int64_t> DateAtEnd(const std::vector<Group>& groups, std::size_t count) {
  if (count >= 1 && groups[count - 1].size() == 8) return SecondsOfDate(groups[count - 1].digits);
  if (count >= 3 && groups[count - 3].size() == 4 && groups[count - 2].size() == 2 && groups[count - 1].size() == 2) {
    return SecondsOfDate(std::string(groups[count - 3].digits) + std::string(groups[count - 2].digits) +
                         std::string(groups[count - 1].digits));
  }
  return std::nullopt;
}

/// A time of day, perhaps after a date, that ends in the group before `count`. `needs_date` says whether six digits
/// alone are not enough.
std::optional<std::int64_t> DayTimeAtEnd(const std::vector<Group>& groups, std::size_t count, bool needs_date) {
  if (count == 0) return std::nullopt;
  const std::string_view last = groups[count - 1].digits;
  if (last.size() == 14) {
    const auto date = SecondsOfDate(last.substr(0, 8));
    const auto time = SecondsOfDay(last.substr(8));
    if (date && time) return *date + *time;
  }
  if (last.size() == 6) {
    const auto time = SecondsOfDay(last);
    const auto date = DateAtEnd(groups, count - 1);
    if (time && (date || !needs_date)) return date.value_or(0) + *time;
  }
  if (count >= 3 && last.size() == 2 && groups[count - 2].size() == 2 && groups[count - 3].size() == 2) {
    const auto time =
        SecondsOfDay(std::string(groups[count - 3].digits) + std::string(groups[count - 2].digits) + std::string(last));
    if (time) return DateAtEnd(groups, count - 3).value_or(0) + *time;
  }
  return std::nullopt;
}

/// A time whose last group is its fraction of a second.
std::optional<Clock> ClockWithFraction(const std::vector<Group>& groups) {
  if (groups.size() < 2 || !groups.back().is_next) return std::nullopt;
  const Group& fraction = groups.back();
  const Group& whole = groups[groups.size() - 2];
  const bool is_decimal = fraction.before == '.' || fraction.before == ',';
  const bool is_usual = fraction.size() == 3 || fraction.size() == 6 || fraction.size() == 9;
  if (!is_decimal && !is_usual) return std::nullopt;
  const std::string_view digits = fraction.digits.substr(0, 9);
  if (const auto time = DayTimeAtEnd(groups, groups.size() - 1, !is_decimal)) {
    return Clock{ClockForm::kDayTime, *time, digits};
  }
  if (whole.size() == 10 && IsEpoch(whole.Value())) return Clock{ClockForm::kEpoch, whole.Value(), digits};
  const bool is_in_word = std::isalpha(static_cast<unsigned char>(whole.before)) != 0;  // "cam01.0012"
  if (is_decimal && whole.size() <= 9 && !is_in_word) return Clock{ClockForm::kSeconds, whole.Value(), digits};
  return std::nullopt;
}

/// A time that is a single number.
std::optional<Clock> ClockInOneNumber(const std::vector<Group>& groups) {
  if (groups.empty()) return std::nullopt;
  const std::string_view last = groups.back().digits;
  if (last.size() == 13 || last.size() == 16 || last.size() == 19) {
    const std::int64_t seconds = ToNumber(last.substr(0, 10));
    if (IsEpoch(seconds)) return Clock{ClockForm::kEpoch, seconds, last.substr(10)};
  }
  if (last.size() == 17 || last.size() == 20) {
    const auto date = SecondsOfDate(last.substr(0, 8));
    const auto time = SecondsOfDay(last.substr(8, 6));
    if (date && time) return Clock{ClockForm::kDayTime, *date + *time, last.substr(14)};
  }
  if (last.size() == 9) {
    const auto date = DateAtEnd(groups, groups.size() - 1);
    const auto time = SecondsOfDay(last.substr(0, 6));
    if (date && time) return Clock{ClockForm::kDayTime, *date + *time, last.substr(6)};
  }
  return std::nullopt;
}

/// The times that all names are; nothing where they are not.
std::optional<FrameNumbers> NumberByClock(const std::vector<std::vector<Group>>& names) {
  std::vector<Clock> clocks;
  std::size_t decimals = 0;
  bool has_same_seconds = true;
  for (const std::vector<Group>& groups : names) {
    std::optional<Clock> clock = ClockInOneNumber(groups);
    if (!clock) clock = ClockWithFraction(groups);
    if (!clock || (!clocks.empty() && clock->form != clocks.front().form)) return std::nullopt;
    decimals = std::max(decimals, clock->fraction.size());
    clocks.push_back(*clock);
    has_same_seconds = has_same_seconds && clock->whole_seconds == clocks.front().whole_seconds;
  }
  // "1.0012": a clip and its frame.
  if (clocks.empty() || (clocks.front().form == ClockForm::kSeconds && has_same_seconds)) return std::nullopt;
  std::int64_t per_second = 1;
  for (std::size_t i = 0; i < decimals; ++i) per_second *= 10;
  FrameNumbers result;
  result.seconds_per_number = 1.0 / static_cast<double>(per_second);
  for (const Clock& clock : clocks) {
    std::int64_t fraction = ToNumber(clock.fraction);
    for (std::size_t i = clock.fraction.size(); i < decimals; ++i) fraction *= 10;
    result.numbers.push_back(clock.whole_seconds * per_second + fraction);
  }
  std::vector<std::int64_t> sorted = result.numbers;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) return std::nullopt;
  if (sorted.size() == 1) return result;
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < sorted.size(); ++i) steps.push_back(sorted[i] - sorted[i - 1]);
  const auto median = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), median, steps.end());
  const double step_seconds = static_cast<double>(*median) * result.seconds_per_number;
  if (step_seconds * kNsPerSecond < kShortestStepNs || step_seconds * kNsPerSecond > kLongestStepNs)
    return std::nullopt;
  return result;
}

/// The last group of digits by which all names differ, where the very last is the same in all; nothing where there is
/// none.
std::optional<std::size_t> GroupThatDiffers(const std::vector<std::vector<Group>>& names) {
  // With two files, "cam1_0001" and "cam2_0001", the number that differs is the camera's.
  if (names.size() < 3) return std::nullopt;
  const std::size_t count = names.front().size();
  for (const std::vector<Group>& groups : names) {
    if (groups.size() != count || groups.back().digits != names.front().back().digits) return std::nullopt;
  }
  for (std::size_t i = count - 1; i-- > 0;) {
    std::set<std::int64_t> values;
    for (const std::vector<Group>& groups : names) values.insert(groups[i].Value());
    if (values.size() == names.size()) return i;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::int64_t> LastNumber(std::string_view file_name) {
  const std::vector<Group> groups = GroupsOf(Stem(file_name));
  if (groups.empty()) return std::nullopt;
  return groups.back().Value();
}

FrameNumbers NumberFrames(const std::vector<std::string>& names) {
  std::vector<std::vector<Group>> groups;
  groups.reserve(names.size());
  for (const std::string& name : names) groups.push_back(GroupsOf(Stem(name)));
  if (std::optional<FrameNumbers> times = NumberByClock(groups)) return *times;
  const std::optional<std::size_t> differing = GroupThatDiffers(groups);
  FrameNumbers result;
  for (const std::vector<Group>& name : groups)
    result.numbers.push_back((differing ? name[*differing] : name.back()).Value());
  return result;
}

}  // namespace canonpose
