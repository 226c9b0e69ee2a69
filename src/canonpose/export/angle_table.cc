#include "canonpose/export/angle_table.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "canonpose/analyse/filter.h"
#include "canonpose/base/error.h"
#include "canonpose/export/file_space.h"

namespace canonpose {

std::string AngleTable(const std::vector<TimeSeries>& angles, const PoseSequence& person, const std::string& name,
                       const std::string& processing) {
  CANONPOSE_CHECK(FrameRateOf(person) > 0.0, "the frame rate of {} is unknown", person.name);
  std::vector<const TimeSeries*> columns;
  for (const TimeSeries& angle : angles) {
    CANONPOSE_CHECK(std::ssize(angle.values) == person.frame_count(), "{} values of {} for {} frames",
                    angle.values.size(), angle.name, person.frame_count());
    const bool is_known = std::ranges::any_of(angle.values, [](double value) { return std::isfinite(value); });
    if (is_known) columns.push_back(&angle);
  }
  if (columns.empty()) {
    ThrowInvalidArgument("no joint angle of {} is known: its joints do not suffice, or were not found", person.name);
  }
  std::string title = name;
  std::ranges::replace_if(
      title, [](unsigned char c) { return c < 0x20 || c == '='; }, '_');
  std::string text = fmt::format("{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees=yes\n", title, person.frame_count(),
                                 columns.size() + 1);
  if (!processing.empty()) text += "processing=" + processing + '\n';
  text += "endheader\ntime";
  for (const TimeSeries* column : columns) text += '\t' + column->name;
  text += '\n';
  const auto out = std::back_inserter(text);
  for (int t = 0; t < person.frame_count(); ++t) {
    fmt::format_to(out, "{:.6f}", person.TimeOf(t));
    for (const TimeSeries* column : columns) {
      const double value = column->values[static_cast<std::size_t>(t)];
      if (std::isfinite(value)) {
        fmt::format_to(out, "\t{:.4f}", value);
      } else {
        text += "\tNaN";
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace canonpose
