#include "canonpose/cli/run_closing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/names.h"
#include "canonpose/base/progress.h"
#include "canonpose/cli/shell_line.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

std::string Count(std::size_t count, const char* one, const char* many) {
  return count == 1 ? fmt::format("one {}", one) : fmt::format("{} {}", count, many);
}

std::string DescribeRecording(const RunReport& report) {
  std::string text =
      fmt::format("{}: {} from {}, {} frames", report.name, Count(report.people.size(), "person", "people"),
                  Count(report.used_cameras.size(), "camera", "cameras"), report.frames);
  if (report.fps > 0.0) text += fmt::format(" at {:.5g} per second", report.fps);
  if (report.used_cameras.size() > 1) text += fmt::format(" ({})", JoinWithAnd(report.used_cameras));
  return text + "\n";
}

std::string DescribeTrust(const RunReport& report) {
  std::string text;
  for (const std::string& camera : report.unused_cameras) text += fmt::format("  not used: {}\n", camera);
  for (const std::string& trust : report.trust) text += fmt::format("  {}\n", trust);
  if (report.solved_error_mm) {
    text +=
        fmt::format("  Against the calibration: {:.1f} mm per joint from all cameras together{} (N-MPJPE).\n",
                    *report.solved_error_mm,
                    report.model_error_mm ? fmt::format(", {:.1f} mm from single ones", *report.model_error_mm) : "");
  }
  text += report.in_millimetres ? "  Lengths are in millimetres.\n"
                                : "  Lengths are not in millimetres, because cameras alone cannot see how large "
                                  "somebody is: give --height.\n";
  return text;
}

std::string DescribeFiles(const RunReport& report, const fs::path& folder) {
  std::string text = fmt::format("\nLook at it: open this page in a browser; it needs no network\n  {}\n",
                                 fs::absolute(report.page).lexically_normal().string());
  text += fmt::format("\nIn {}:\n", folder.string());
  const auto line = [&](const std::string& name, const std::string& what) {
    text += fmt::format("  {:<22} {}\n", name, what);
  };
  for (const fs::path& path : report.exports) {
    const std::string extension = path.extension().string();
    line((path.parent_path().filename() / path.filename()).string(),
         extension == ".csv"   ? "3D poses as a table: x, y and z of every joint in every frame"
         : extension == ".trc" ? "the same for OpenSim"
         : extension == ".c3d" ? "the same for Visual3D and other programs of motion analysis"
         : extension == ".glb" ? "people and cameras in 3D, for Blender and web viewers"
         : extension == ".bvh" ? "the motion of a skeleton, for Blender and game engines"
                               : "the same in another format");
  }
  line("solved.h5, report.json", "3D poses and cameras with their uncertainty, and what was found about each camera");
  if (!report.model.empty()) line("model/model.cpm", "the network: 3D poses from one camera alone");
  line("commands.sh", "the commands that made all this, to repeat or to change");
  for (const std::string& format : report.formats_left_out) {
    text += fmt::format("  No .{} file was written, because it states a frame rate: give --fps.\n", format);
  }
  return text;
}

/// How to use the model on another recording.
std::string DescribeNext(const RunReport& report, const std::string& program, const fs::path& folder,
                         const std::vector<std::string>& heights) {
  if (report.model.empty()) {
    return fmt::format(
        "\nNext: the same command without --no-train also trains a network, for 3D poses from a single "
        "camera.\n");
  }
  std::string text = "\nNext: 3D poses of a new video of similar movements, filmed by any single camera\n";
  std::vector<std::string> lift{program, "lift", report.model.string()};
  if (report.are_videos) {
    text += fmt::format("  {}\n", ShellLine({program, "detect", "NEW.mp4", "-o", "NEW"}));
    lift.emplace_back("NEW/NEW");
  } else {
    lift.insert(lift.end(), {"NEW-KEYPOINTS", "--image-size", "WxH"});
  }
  const bool is_everybodys = heights.size() == 1 && heights.front().find('=') == std::string::npos;
  lift.insert(lift.end(), {"--height", is_everybodys ? heights.front() : "METRES", "-o", "poses.csv"});
  return text + fmt::format("  {}\n", ShellLine(lift)) +
         fmt::format("Another recording by all cameras: {} run VIDEO... -o FOLDER, with another folder than {}\n",
                     program, folder.string());
}

}  // namespace

std::string ClosingLines(const RunReport& report, const std::string& program, const fs::path& folder,
                         const std::vector<std::string>& heights) {
  return "\n" + DescribeRecording(report) + DescribeTrust(report) + DescribeFiles(report, folder) +
         DescribeNext(report, program, folder, heights) +
         fmt::format("Done in {}; the page was there after {}.\n", FormatDuration(report.seconds),
                     FormatDuration(report.seconds_to_page));
}

}  // namespace canonpose
