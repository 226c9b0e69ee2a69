#include "canonpose/export/c3d.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "canonpose/analyse/filter.h"
#include "canonpose/base/error.h"
#include "canonpose/base/version.h"
#include "canonpose/export/person_names.h"

namespace canonpose {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they are in memory");

constexpr std::size_t kC3dBlock = 512;
/// Sizes of arrays are bytes, and a parameter is at most 32767 bytes long.
constexpr std::size_t kLabelsPerParameter = 255;
constexpr std::size_t kLongestLabel = 127;
constexpr int kMostFrames = 65535;
constexpr int kMostPoints = 65535;
constexpr int kMostCameras = 7;
/// The largest coordinate is this many steps of POINT:SCALE, so that the file can be converted to 16-bit integers.
constexpr double kStepsOfCoordinates = 32000.0;
constexpr double kStepsOfResiduals = 255.0;

template <typename T>
void AppendC3d(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// The parameter section, group by group.
class C3dParameters {
 public:
  void Group(std::string_view name, std::string_view description) {
    ++group_;
    BeginRecord(name, static_cast<std::int8_t>(-group_));
    AppendText(description);
    EndRecord();
  }
  void Words(std::string_view name, const std::vector<int>& values) {
    std::string data;
    for (const int value : values) AppendC3d(data, static_cast<std::uint16_t>(value));
    Parameter(name, 2, Shape(values.size()), data);
  }
  void Floats(std::string_view name, const std::vector<double>& values) {
    std::string data;
    for (const double value : values) AppendC3d(data, static_cast<float>(value));
    Parameter(name, 4, Shape(values.size()), data);
  }
  void Text(std::string_view name, const std::string& text) {
    const std::string cut = text.substr(0, 255);
    Parameter(name, -1, {cut.size()}, cut);
  }
  /// NAME, NAME2, ... with up to 255 texts each.
  void Texts(const std::string& name, const std::vector<std::string>& texts) {
    std::size_t longest = 1;
    for (const std::string& text : texts) longest = std::max(longest, text.size());
    for (std::size_t first = 0, part = 1; part == 1 || first < texts.size(); first += kLabelsPerParameter, ++part) {
      const std::size_t count = std::min(kLabelsPerParameter, texts.size() - first);
      std::string data;
      for (std::size_t i = first; i < first + count; ++i)
        data += texts[i] + std::string(longest - texts[i].size(), ' ');
      Parameter(part == 1 ? name : fmt::format("{}{}", name, part), -1,
                count == 0 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{longest, count}, data);
    }
  }
  /// The section in whole blocks, in which DATA_START is set.
  [[nodiscard]] std::string Finish() {
    // The last record leads nowhere.
    if (last_offset_ > 0) bytes_[last_offset_] = bytes_[last_offset_ + 1] = '\0';
    bytes_.resize((bytes_.size() + kC3dBlock - 1) / kC3dBlock * kC3dBlock, '\0');
    const std::size_t blocks = bytes_.size() / kC3dBlock;
    if (blocks > 255) ThrowInvalidArgument("the names of so many joints do not fit a C3D file: export fewer people");
    bytes_[2] = static_cast<char>(blocks);
    // The data begin after the header's block and these.
    const auto data_start = static_cast<std::uint16_t>(blocks + 2);
    std::memcpy(&bytes_[data_start_], &data_start, sizeof(data_start));
    return bytes_;
  }

 private:
  static std::vector<std::size_t> Shape(std::size_t count) {
    return count == 1 ? std::vector<std::size_t>{} : std::vector<std::size_t>{count};
  }
  void BeginRecord(std::string_view name, std::int8_t group) {
    AppendC3d(bytes_, static_cast<std::int8_t>(name.size()));
    AppendC3d(bytes_, group);
    bytes_ += name;
    last_offset_ = bytes_.size();
    AppendC3d(bytes_, std::uint16_t{0});
  }
  /// Says in the record how far the next one is, from there.
  void EndRecord() {
    const std::size_t length = bytes_.size() - last_offset_;
    CANONPOSE_CHECK(length <= INT16_MAX, "a parameter of {} bytes", length);
    const auto offset = static_cast<std::uint16_t>(length);
    std::memcpy(&bytes_[last_offset_], &offset, sizeof(offset));
  }
  void AppendText(std::string_view text) {
    AppendC3d(bytes_, static_cast<std::uint8_t>(text.size()));
    bytes_ += text;
  }
  void Parameter(std::string_view name, std::int8_t type, const std::vector<std::size_t>& shape,
                 const std::string& data) {
    BeginRecord(name, group_);
    AppendC3d(bytes_, type);
    AppendC3d(bytes_, static_cast<std::uint8_t>(shape.size()));
    for (const std::size_t size : shape) AppendC3d(bytes_, static_cast<std::uint8_t>(size));
    if (name == "DATA_START") data_start_ = bytes_.size();
    bytes_ += data;
    AppendText("");
    EndRecord();
  }

  std::string bytes_{1, '\x50', 0, 84};  // 84: Intel
  std::int8_t group_ = 0;
  std::size_t last_offset_ = 0;
  std::size_t data_start_ = 0;
};

/// What the header and the parameters both say.
struct C3dFacts {
  int points = 0;
  int frames = 0;
  double fps = 0.0;
  double scale = 1.0;  ///< |POINT:SCALE|, in the file's unit
};

C3dFacts FactsOfC3d(const Scene& scene, const FileSpace& space) {
  C3dFacts facts;
  facts.frames = scene.people.front().frame_count();
  facts.fps = FrameRateOf(scene.people.front());
  CANONPOSE_CHECK(facts.fps > 0.0, "the frame rate of {} is unknown", scene.name);
  std::size_t points = 0;
  double largest = 0.0;
  double least_certain = 0.0;
  for (const PoseSequence& person : scene.people) {
    points += person.skeleton().joints.size();
    for (int t = 0; t < person.frame_count(); ++t) {
      for (int j = 0; j < person.joint_count(); ++j) {
        if (person.IsKnown(t, j)) largest = std::max(largest, space.Position(person, t, j).cwiseAbs().maxCoeff());
      }
    }
    for (const float deviation : person.standard_deviation()) {
      if (std::isfinite(deviation)) {
        least_certain = std::max(least_certain, space.Length(static_cast<double>(deviation)));
      }
    }
  }
  if (points > kMostPoints) {
    ThrowInvalidArgument("a C3D file holds {} points, and there are {}: export fewer people", kMostPoints, points);
  }
  facts.points = static_cast<int>(points);
  const double scale = std::max(largest / kStepsOfCoordinates, least_certain / kStepsOfResiduals);
  if (scale > 0.0) facts.scale = scale;
  return facts;
}

/// Printable ASCII, not too long, and no two alike.
std::vector<std::string> C3dLabels(const Scene& scene) {
  std::vector<std::string> labels;
  const std::vector<std::string> prefixes = PersonPrefixes(scene);
  for (std::size_t p = 0; p < scene.people.size(); ++p) {
    for (const std::string& joint : scene.people[p].skeleton().joints) {
      std::string label = prefixes[p] + joint;
      std::ranges::replace_if(
          label, [](unsigned char c) { return c <= 0x20 || c >= 0x7F; }, '_');
      std::string unique = label.substr(0, kLongestLabel);
      for (int number = 2; std::ranges::count(labels, unique) > 0; ++number) {
        const std::string suffix = fmt::format("_{}", number);
        unique = label.substr(0, kLongestLabel - suffix.size()) + suffix;
      }
      labels.push_back(unique);
    }
  }
  return labels;
}

void AddPointGroup(const Scene& scene, const FileSpace& space, const C3dFacts& facts, C3dParameters& parameters) {
  const std::vector<std::string> labels = C3dLabels(scene);
  std::vector<std::string> descriptions;
  for (const std::string& label : labels) descriptions.push_back("joint " + label.substr(0, 100));
  parameters.Group("POINT", "3D positions of joints");
  parameters.Words("USED", {facts.points});
  parameters.Floats("SCALE", {-facts.scale});
  parameters.Floats("RATE", {facts.fps});
  parameters.Words("DATA_START", {0});
  parameters.Words("FRAMES", {std::min(facts.frames, kMostFrames)});
  if (facts.frames > kMostFrames) parameters.Floats("LONG_FRAMES", {static_cast<double>(facts.frames)});
  parameters.Texts("LABELS", labels);
  parameters.Texts("DESCRIPTIONS", descriptions);
  parameters.Text("UNITS", space.unit_is_known() ? space.unit() : "unknown");
  if (space.up_is_known()) {
    parameters.Text("X_SCREEN", "+X");
    parameters.Text("Y_SCREEN", space.up() == "y" ? "+Y" : "+Z");
  }
}

std::string C3dParameterSection(const Scene& scene, const FileSpace& space, const C3dFacts& facts,
                                const std::string& processing) {
  C3dParameters parameters;
  AddPointGroup(scene, space, facts, parameters);
  // Readers take these for granted.
  parameters.Group("ANALOG", "No analog data");
  parameters.Words("USED", {0});
  parameters.Texts("LABELS", {});
  parameters.Texts("DESCRIPTIONS", {});
  parameters.Floats("GEN_SCALE", {1.0});
  parameters.Floats("SCALE", {});
  parameters.Words("OFFSET", {});
  parameters.Texts("UNITS", {});
  parameters.Floats("RATE", {facts.fps});
  parameters.Group("FORCE_PLATFORM", "No force platforms");
  parameters.Words("USED", {0});
  parameters.Words("TYPE", {});
  parameters.Words("ZERO", {1, 0});
  parameters.Floats("CORNERS", {});
  parameters.Floats("ORIGIN", {});
  parameters.Words("CHANNEL", {});
  parameters.Group("TRIAL", "Frames as two 16-bit words, the lower one first");
  parameters.Words("ACTUAL_START_FIELD", {1, 0});
  parameters.Words("ACTUAL_END_FIELD", {facts.frames & 0xFFFF, facts.frames >> 16});
  parameters.Floats("CAMERA_RATE", {facts.fps});
  parameters.Group("MANUFACTURER", "");
  parameters.Text("SOFTWARE", "canonpose");
  parameters.Text("VERSION_LABEL", ProgramVersion());
  parameters.Group("CANONPOSE", "What the positions refer to");
  parameters.Text("UNIT", space.unit());
  parameters.Text("UP", space.up());
  parameters.Text("UP_FROM", scene.up.is_known() ? scene.up.source : "unknown");
  parameters.Text("SCALE_FROM", scene.scale.is_known() ? scene.scale.source : "unknown");
  parameters.Text("PROCESSING", processing.empty() ? "none" : processing);
  return parameters.Finish();
}

std::string C3dHeader(const C3dFacts& facts, std::size_t parameter_blocks) {
  std::string header{2, '\x50'};  // the parameters begin in the second block
  AppendC3d(header, static_cast<std::uint16_t>(facts.points));
  AppendC3d(header, std::uint16_t{0});  // analog samples per frame
  AppendC3d(header, std::uint16_t{1});
  AppendC3d(header, static_cast<std::uint16_t>(std::min(facts.frames, kMostFrames)));
  AppendC3d(header, std::uint16_t{0});  // no gaps were interpolated
  AppendC3d(header, static_cast<float>(-facts.scale));
  AppendC3d(header, static_cast<std::uint16_t>(parameter_blocks + 2));
  AppendC3d(header, std::uint16_t{0});
  AppendC3d(header, static_cast<float>(facts.fps));
  header.resize(kC3dBlock, '\0');
  // Word 150: labels of events would have four characters.
  constexpr std::uint16_t kFourCharacters = 0x3039;
  std::memcpy(&header[2 * 149], &kFourCharacters, sizeof(kFourCharacters));
  return header;
}

/// Camera mask and residual as the specification has them: a 16-bit integer that is written as a float.
float MaskAndResidual(std::uint8_t cameras, double deviation, double scale) {
  double residual = 0.0;
  if (std::isfinite(deviation)) residual = std::clamp(std::round(deviation / scale), 1.0, kStepsOfResiduals);
  return static_cast<float>(((cameras & ((1 << kMostCameras) - 1)) << 8) + static_cast<int>(residual));
}

}  // namespace

std::string C3dBytes(const Scene& scene, const FileSpace& space, const std::vector<std::vector<std::uint8_t>>& seen_by,
                     const std::string& processing) {
  const C3dFacts facts = FactsOfC3d(scene, space);
  const std::string parameters = C3dParameterSection(scene, space, facts, processing);
  std::string bytes = C3dHeader(facts, parameters.size() / kC3dBlock) + parameters;
  bytes.reserve(bytes.size() + 16 * static_cast<std::size_t>(facts.points) * static_cast<std::size_t>(facts.frames));
  for (int t = 0; t < facts.frames; ++t) {
    for (std::size_t p = 0; p < scene.people.size(); ++p) {
      const PoseSequence& person = scene.people[p];
      const std::size_t first = static_cast<std::size_t>(t) * static_cast<std::size_t>(person.joint_count());
      for (int j = 0; j < person.joint_count(); ++j) {
        const std::size_t i = first + static_cast<std::size_t>(j);
        const bool is_known = person.IsKnown(t, j);
        const Eigen::Vector3d position = is_known ? space.Position(person, t, j) : Eigen::Vector3d::Zero();
        for (const double value : position) AppendC3d(bytes, static_cast<float>(value));
        const std::uint8_t cameras = p < seen_by.size() && i < seen_by[p].size() ? seen_by[p][i] : 0;
        const double deviation = space.Length(static_cast<double>(person.standard_deviation()[i]));
        AppendC3d(bytes, is_known ? MaskAndResidual(cameras, deviation, facts.scale) : -1.0F);
      }
    }
  }
  return bytes;
}

}  // namespace canonpose
