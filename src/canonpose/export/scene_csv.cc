#include "canonpose/export/scene_csv.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "canonpose/export/csv_cell.h"
#include "canonpose/export/person_names.h"

namespace canonpose {
namespace {

bool HasTime(const Scene& scene) {
  const PoseSequence& first = scene.people.front();
  return first.fps > 0.0 || !first.time_seconds.empty();
}

std::string SceneCsvHeader(const Scene& scene, const FileSpace& space) {
  std::string text = HasTime(scene) ? "frame,time [s]" : "frame";
  const std::vector<std::string> prefixes = PersonPrefixes(scene);
  for (std::size_t p = 0; p < scene.people.size(); ++p) {
    const std::vector<std::string>& joints = scene.people[p].skeleton().joints;
    const auto add = [&](const std::string& joint, const std::string& quantity) {
      text += "," + CsvCell(fmt::format("{}{}{}", prefixes[p], joint, quantity));
    };
    for (const std::string& joint : joints) {
      for (const char axis : {'x', 'y', 'z'}) add(joint, fmt::format("_{} [{}]", axis, space.unit()));
    }
    for (const std::string& joint : joints) add(joint, "_confidence");
    for (const std::string& joint : joints) add(joint, fmt::format("_sd [{}]", space.unit()));
  }
  return text + ",up";
}

void AppendSceneCsvPerson(const PoseSequence& person, int frame, const FileSpace& space, std::string& text) {
  const auto out = std::back_inserter(text);
  const auto add = [&](double value) {
    text += ',';
    if (std::isfinite(value)) fmt::format_to(out, "{:.{}f}", value, space.decimals());
  };
  const std::size_t first = static_cast<std::size_t>(frame) * static_cast<std::size_t>(person.joint_count());
  const auto joints = static_cast<std::size_t>(person.joint_count());
  for (int j = 0; j < person.joint_count(); ++j) {
    const Eigen::Vector3d position = space.Position(person, frame, j);
    for (const double value : position) add(value);
  }
  for (std::size_t i = first; i < first + joints; ++i) {
    text += ',';
    if (std::isfinite(person.confidence()[i])) fmt::format_to(out, "{}", person.confidence()[i]);
  }
  for (std::size_t i = first; i < first + joints; ++i) {
    add(space.Length(static_cast<double>(person.standard_deviation()[i])));
  }
}

}  // namespace

std::string SceneCsv(const Scene& scene, const FileSpace& space, const std::string& processing) {
  std::string text = SceneCsvHeader(scene, space) + (processing.empty() ? "\n" : ",processing\n");
  const std::string end = ',' + space.up() + (processing.empty() ? "" : ',' + CsvCell(processing)) + '\n';
  const PoseSequence& first = scene.people.front();
  for (int t = 0; t < first.frame_count(); ++t) {
    text += fmt::format("{}", t);
    if (HasTime(scene)) text += fmt::format(",{:.6f}", first.TimeOf(t));
    for (const PoseSequence& person : scene.people) AppendSceneCsvPerson(person, t, space, text);
    text += end;
  }
  return text;
}

}  // namespace canonpose
