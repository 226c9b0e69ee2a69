#include "canonpose/export/trc.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include <fmt/format.h>

#include "canonpose/analyse/filter.h"
#include "canonpose/base/error.h"

namespace canonpose {
namespace {

/// Tabs would begin another field, and some readers split at spaces, too.
std::string InOneField(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x80 && (std::isspace(c) != 0 || std::iscntrl(c) != 0); }, '_');
  return text;
}

void AppendTrcHeader(const PoseSequence& person, const FileSpace& space, const std::string& file_name,
                     const std::string& comment, std::string& text) {
  const double fps = FrameRateOf(person);
  CANONPOSE_CHECK(fps > 0.0, "the frame rate of {} is unknown", person.name);
  text += "PathFileType\t4\t(X/Y/Z)\t" + InOneField(file_name) + (comment.empty() ? "" : '\t' + comment) + '\n';
  text += "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n";
  text += fmt::format("{0}\t{0}\t{1}\t{2}\t{3}\t{0}\t1\t{1}\n", fps, person.frame_count(), person.joint_count(),
                      space.unit_is_known() ? space.unit() : "unknown");
  text += "Frame#\tTime";
  for (const std::string& joint : person.skeleton().joints) text += '\t' + InOneField(joint) + "\t\t";
  text += "\n\t";
  for (int j = 1; j <= person.joint_count(); ++j) text += fmt::format("\tX{0}\tY{0}\tZ{0}", j);
  text += '\n';
}

}  // namespace

std::string TrcText(const PoseSequence& person, const FileSpace& space, const std::string& file_name,
                    const std::string& processing) {
  std::string comment = space.Unknowns();
  if (!processing.empty()) comment += (comment.empty() ? "" : ", ") + processing;
  std::string text;
  AppendTrcHeader(person, space, file_name, comment, text);
  const auto out = std::back_inserter(text);
  for (int t = 0; t < person.frame_count(); ++t) {
    fmt::format_to(out, "{}\t{:.6f}", t + 1, person.TimeOf(t));
    for (int j = 0; j < person.joint_count(); ++j) {
      if (!person.IsKnown(t, j)) {
        text += "\t\t\t";
        continue;
      }
      const Eigen::Vector3d position = space.Position(person, t, j);
      for (const double value : position) fmt::format_to(out, "\t{:.{}f}", value, space.decimals());
    }
    text += '\n';
  }
  return text;
}

}  // namespace canonpose
