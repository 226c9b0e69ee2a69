#include "canonpose/pipeline/run_options.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "canonpose/base/error.h"
#include "canonpose/data/import.h"
#include "canonpose/export/scene_formats.h"
#include "canonpose/scene/world_measures.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using For = RunOption::For;

bool IsFor(const RunOption& option, const RecordingInputs& inputs) {
  return option.inputs == For::kBoth || (option.inputs == For::kVideos) == inputs.are_videos;
}

/// "[NAME=]WxH"
std::string AfterName(const std::string& text) {
  const std::size_t equals = text.find('=');
  return equals == std::string::npos ? text : text.substr(equals + 1);
}

void RequireFormats(const std::vector<std::string>& formats) {
  for (const std::string& format : formats) {
    if (FindSceneFormat("poses." + format) != nullptr) continue;
    ThrowInvalidArgument("`export`: expected one or several of {}, without a point, found \"{}\"", SceneFormatNames(),
                         format);
  }
}

}  // namespace

const std::vector<RunOption>& RunOptionTable() {
  static const std::vector<RunOption> table{
      {"detect", "search_interval", For::kVideos},
      {"detect", "most_people", For::kVideos},
      {"detect", "fps", For::kVideos},
      {"detect", "threads", For::kVideos, false},
      {"import", "image_size"},
      {"import", "fps", For::kKeypoints},
      {"import", "layout", For::kKeypoints, true, true},
      {"import", "skeleton"},
      {"import", "person"},
      {"import", "align"},
      {"import", "moving"},
      {"import", "calibration", For::kBoth, true, true},
      {"import", "name"},
      {"import", "subject"},
      {"import", "capture"},
      {"solve", "height"},
      {"solve", "camera_distance"},
      {"solve", "calibrated_scale"},
      {"solve", "mirror"},
      {"solve", "bootstrap"},
      {"solve", "threads", For::kBoth, false},
      {"evaluate", "exclude_joints"},
      {"train", "preset"},
      {"train", "epochs"},
      {"train", "width"},
      {"train", "seed"},
      {"train", "device"},
      {"train", "set"},
      {"train", "threads", For::kBoth, false},
  };
  return table;
}

void RunOptions::Validate() const {
  if (output.empty()) ThrowInvalidArgument("give the folder for the results");
  RequireFormats(formats);
  for (const std::string& height : Get("height")) static_cast<void>(KnownHeight::Parse(height));
  for (const std::string& distance : Get("camera_distance")) static_cast<void>(KnownDistance::Parse(distance));
  for (const std::string& size : Get("image_size")) static_cast<void>(ParseImageSize(AfterName(size)));
  if (Has("calibrated_scale") && !Has("calibration")) {
    ThrowInvalidArgument("`calibrated_scale` takes the size from a calibration: give `calibration`");
  }
  for (const RunOption& option : RunOptionTable()) {
    if (trains || option.command != "train" || option.field == "threads" || !Has(std::string(option.field))) continue;
    ThrowInvalidArgument("`{}` is for training, which is not to be done", option.field);
  }
}

std::vector<std::string> RunOptions::Get(const std::string& field) const {
  std::vector<std::string> values;
  for (const auto& [name, value] : fields) {
    if (name == field) values.push_back(value);
  }
  return values;
}

void RequireOptionsFor(const RunOptions& options, const RecordingInputs& inputs) {
  if (inputs.are_videos && !inputs.are_images && options.Has("fps")) {
    ThrowInvalidArgument("`fps` is for images and keypoints; videos know their rate");
  }
  for (const auto& [name, value] : options.fields) {
    const std::string& field = name;
    const auto& table = RunOptionTable();
    if (std::ranges::any_of(table, [&](const RunOption& row) { return row.field == field && IsFor(row, inputs); })) {
      continue;
    }
    ThrowInvalidArgument("`{}` is for {}", field,
                         inputs.are_videos ? "keypoints, and videos are given" : "videos, and keypoints are given");
  }
}

void AddFields(const RunOptions& options, const RecordingInputs& inputs, StepCommand& command) {
  for (const auto& [name, value] : options.fields) {
    for (const RunOption& option : RunOptionTable()) {
      if (option.command != command.name || option.field != name || !IsFor(option, inputs)) continue;
      std::error_code error;
      const bool is_path = option.may_be_path && fs::exists(value, error);
      command.fields.emplace_back(name, is_path ? StepValue::Input(value) : StepValue::Text(value));
    }
  }
}

std::vector<std::string> FieldsWithoutEffect(std::string_view command) {
  std::vector<std::string> fields;
  for (const RunOption& option : RunOptionTable()) {
    if (option.command == command && !option.has_effect) fields.emplace_back(option.field);
  }
  return fields;
}

}  // namespace canonpose
