#include "canonpose/analyse/filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/base/median.h"

namespace canonpose {
namespace {

/// Frames first to last, both inclusive, of a joint.
struct Stretch {
  int first = 0;
  int last = 0;
};

/// The frames in which a joint is known, as stretches that end where it is unknown or time leaps.
std::vector<Stretch> KnownStretches(const PoseSequence& person, int joint, double longest_step_seconds) {
  std::vector<Stretch> stretches;
  for (int t = 0; t < person.frame_count(); ++t) {
    if (!person.IsKnown(t, joint)) continue;
    const bool goes_on = !stretches.empty() && stretches.back().last == t - 1 &&
                         person.TimeOf(t) - person.TimeOf(t - 1) <= longest_step_seconds;
    if (goes_on) {
      stretches.back().last = t;
    } else {
      stretches.push_back({t, t});
    }
  }
  return stretches;
}

/// Second-order sections b0, b1, b2 and a1, a2 (a0 = 1) of one pass.
struct Section {
  std::array<double, 3> b{};
  std::array<double, 2> a{};
};

Section ButterworthPass(double cutoff_hz, double fps) {
  const double w = std::tan(std::numbers::pi * cutoff_hz / fps) / std::pow(std::numbers::sqrt2 - 1.0, 0.25);
  const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * w + w * w);
  const double b = w * w * scale;
  return {{b, 2.0 * b, b}, {2.0 * (w * w - 1.0) * scale, (1.0 - std::numbers::sqrt2 * w + w * w) * scale}};
}

/// Filters in place, from the steady state of the first value.
template <typename Iterator>
void RunPass(const Section& section, Iterator begin, Iterator end) {
  double z1 = (1.0 - section.b[0]) * *begin;
  double z2 = (section.b[2] - section.a[1]) * *begin;
  for (Iterator value = begin; value != end; ++value) {
    const double x = *value;
    const double y = section.b[0] * x + z1;
    z1 = section.b[1] * x - section.a[0] * y + z2;
    z2 = section.b[2] * x - section.a[1] * y;
    *value = y;
  }
}

double RequireFrameRate(const PoseSequence& person) {
  const double fps = FrameRateOf(person);
  if (!(fps > 0.0)) {
    ThrowInvalidArgument(
        "filtering and filling gaps need the frame rate, and these poses have neither a rate nor time stamps");
  }
  return fps;
}

/// The cubic through the frames around a gap, as values over time relative to the gap's middle.
class GapCurve {
 public:
  GapCurve(const PoseSequence& person, int joint, const Stretch& before, const Stretch& after)
      : person_(person), middle_((person.TimeOf(before.last) + person.TimeOf(after.first)) / 2.0) {
    const int gap = after.first - before.last - 1;
    const int window = std::max(2, gap);
    std::vector<int> frames;
    for (int t = std::max(before.first, before.last - window + 1); t <= before.last; ++t) frames.push_back(t);
    for (int t = after.first; t <= std::min(after.last, after.first + window - 1); ++t) frames.push_back(t);
    const auto rows = static_cast<Eigen::Index>(frames.size());
    const Eigen::Index terms = std::min<Eigen::Index>(4, rows);
    Eigen::MatrixXd powers(rows, terms);
    Eigen::MatrixXd positions(rows, 3);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const int frame = frames[static_cast<std::size_t>(i)];
      powers.row(i) = Powers(frame, terms);
      positions.row(i) = Position(frame, joint);
    }
    coefficients_ = powers.colPivHouseholderQr().solve(positions);
    for (const int end : {before.last, after.first}) ends_.push_back(person.TimeOf(end));
    misses_ = {Position(before.last, joint) - Fit(before.last), Position(after.first, joint) - Fit(after.first)};
  }

  [[nodiscard]] Eigen::RowVector3d At(int frame) const {
    const double part = (person_.TimeOf(frame) - ends_[0]) / (ends_[1] - ends_[0]);
    return Fit(frame) + (1.0 - part) * misses_[0] + part * misses_[1];
  }

 private:
  [[nodiscard]] Eigen::RowVectorXd Powers(int frame, Eigen::Index terms) const {
    const double t = person_.TimeOf(frame) - middle_;
    Eigen::RowVectorXd powers(terms);
    for (Eigen::Index k = 0; k < terms; ++k) powers[k] = std::pow(t, static_cast<double>(k));
    return powers;
  }
  [[nodiscard]] Eigen::RowVector3d Position(int frame, int joint) const {
    return person_.PoseAt(frame).row(joint).cast<double>();
  }
  [[nodiscard]] Eigen::RowVector3d Fit(int frame) const { return Powers(frame, coefficients_.rows()) * coefficients_; }

  const PoseSequence& person_;
  double middle_;
  Eigen::MatrixXd coefficients_;  // (terms, 3)
  std::vector<double> ends_;      // seconds
  std::array<Eigen::RowVector3d, 2> misses_;
};

}  // namespace

void FilterOptions::Validate() const {
  const auto require = [](const char* name, double value) {
    if (!(value >= 0.0) || !std::isfinite(value))
      ThrowInvalidArgument("`{}`: expected 0 or more, found {}", name, value);
  };
  require("cutoff_hz", cutoff_hz);
  require("longest_gap_seconds", longest_gap_seconds);
}

std::string Describe(const FilterOptions& options) {
  std::string text;
  if (options.cutoff_hz > 0.0) text = fmt::format("Butterworth, 4th order, zero phase, {:g} Hz", options.cutoff_hz);
  if (options.longest_gap_seconds > 0.0) {
    text += fmt::format("{}gaps up to {:g} s filled", text.empty() ? "" : "; ", options.longest_gap_seconds);
  }
  return text;
}

void Filter(PoseSequence& person, const FilterOptions& options) {
  options.Validate();
  if (options.longest_gap_seconds > 0.0) FillGaps(person, options.longest_gap_seconds);
  if (options.cutoff_hz > 0.0) LowPass(person, options.cutoff_hz);
}

void FillGaps(PoseSequence& person, double longest_gap_seconds) {
  const double step_seconds = 1.0 / RequireFrameRate(person);
  for (int joint = 0; joint < person.joint_count(); ++joint) {
    const std::vector<Stretch> stretches = KnownStretches(person, joint, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i + 1 < stretches.size(); ++i) {
      const Stretch& before = stretches[i];
      const Stretch& after = stretches[i + 1];
      // The last known frame lasts until the next would come; rounding must not decide over a gap of just this length.
      const double missing_seconds = person.TimeOf(after.first) - person.TimeOf(before.last) - step_seconds;
      if (missing_seconds > longest_gap_seconds + 0.01 * step_seconds) continue;
      const GapCurve curve(person, joint, before, after);
      for (int t = before.last + 1; t < after.first; ++t) {
        person.PoseAt(t).row(joint) = curve.At(t).cast<float>();
        const auto at = static_cast<std::size_t>(t) * static_cast<std::size_t>(person.joint_count()) +
                        static_cast<std::size_t>(joint);
        person.confidence()[at] = 0.0F;
        person.standard_deviation()[at] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
}

void LowPass(PoseSequence& person, double cutoff_hz) {
  const double fps = RequireFrameRate(person);
  if (!(cutoff_hz > 0.0) || !(cutoff_hz < fps / 2.0)) {
    ThrowInvalidArgument("`cutoff_hz`: expected more than 0 and less than half the frame rate of {:g}, found {:g}", fps,
                         cutoff_hz);
  }
  for (int joint = 0; joint < person.joint_count(); ++joint) {
    for (const Stretch& stretch : KnownStretches(person, joint, 1.5 / fps)) {
      for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (int t = stretch.first; t <= stretch.last; ++t) values.push_back(person.PoseAt(t)(joint, axis));
        values = LowPass(values, cutoff_hz, fps);
        for (int t = stretch.first; t <= stretch.last; ++t) {
          person.PoseAt(t)(joint, axis) = static_cast<float>(values[static_cast<std::size_t>(t - stretch.first)]);
        }
      }
    }
  }
}

std::vector<double> LowPass(const std::vector<double>& values, double cutoff_hz, double fps) {
  CANONPOSE_CHECK(cutoff_hz > 0.0 && cutoff_hz < fps / 2.0, "{} {}", cutoff_hz, fps);
  if (values.size() < 2) return values;
  static constexpr std::size_t kPadding = 9;
  const std::size_t padding = std::min(kPadding, values.size() - 1);
  std::vector<double> padded;
  for (std::size_t i = padding; i > 0; --i) padded.push_back(2.0 * values.front() - values[i]);
  padded.insert(padded.end(), values.begin(), values.end());
  for (std::size_t i = 1; i <= padding; ++i) padded.push_back(2.0 * values.back() - values[values.size() - 1 - i]);
  const Section section = ButterworthPass(cutoff_hz, fps);
  RunPass(section, padded.begin(), padded.end());
  RunPass(section, padded.rbegin(), padded.rend());
  const auto first = padded.begin() + static_cast<std::ptrdiff_t>(padding);
  return {first, first + std::ssize(values)};
}

double FrameRateOf(const PoseSequence& person) {
  if (person.fps > 0.0) return person.fps;
  std::vector<double> steps;
  for (std::size_t t = 1; t < person.time_seconds.size(); ++t) {
    steps.push_back(person.time_seconds[t] - person.time_seconds[t - 1]);
  }
  const double step = Median(steps);
  return step > 0.0 ? 1.0 / step : 0.0;
}

}  // namespace canonpose
