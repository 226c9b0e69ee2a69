#include "canonpose/pipeline/run_recording.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/base/folder_lock.h"
#include "canonpose/base/log.h"
#include "canonpose/data/dataset.h"
#include "canonpose/data/read_scenes.h"
#include "canonpose/data/readers/calibration.h"
#include "canonpose/export/scene_formats.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Names in the folder of a run.
constexpr const char* kKeypoints = "keypoints";
constexpr const char* kData = "data.h5";
constexpr const char* kSolved = "solved.h5";
constexpr const char* kSolveReport = "report.json";
constexpr const char* kPage = "page.html";
constexpr const char* kExports = "exports";
constexpr const char* kModel = "model";
constexpr const char* kModelFile = "model/model.cpm";
constexpr const char* kEvaluationOfSolved = "evaluation-solved.json";
constexpr const char* kEvaluationOfModel = "evaluation-model.json";

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

bool IsBelow(const fs::path& path, const fs::path& folder) {
  const fs::path relative = fs::weakly_canonical(path).lexically_relative(fs::weakly_canonical(folder));
  return !relative.empty() && *relative.begin() != "..";
}

/// A folder of something else is not to be filled with files.
void RequireFolderForRuns(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error) || fs::exists(folder / kStepRecordsName, error)) return;
  fs::directory_iterator entries(folder, error);
  if (error) ThrowBadInput({folder.string(), "", "a folder for the results", error.message(), "choose another"});
  for (const fs::directory_entry& entry : entries) {
    const std::string name = entry.path().filename().string();
    if (name == "lock" || name.starts_with(".new-")) continue;  // of a run that was killed at once
    ThrowBadInput({folder.string(), "", "a new or empty folder, or the results of an earlier run",
                   "other files, such as " + name, "choose another output folder"});
  }
}

void RequireSeparateFolders(const RunOptions& options, const RecordingInputs& inputs) {
  for (const std::string& path : options.inputs) {
    if (IsBelow(path, options.output)) {
      ThrowInvalidArgument("{} is in {}, where the results go: choose another output folder", path,
                           options.output.string());
    }
    if (!inputs.are_videos && IsBelow(options.output, path)) {
      ThrowInvalidArgument("{} is in {}, whose folders are cameras: choose another output folder",
                           options.output.string(), path);
    }
  }
}

/// What the calibration lacks would only show when the keypoints are found.
void RequireCalibrationOf(const RunOptions& options, const RecordingInputs& inputs) {
  for (const std::string& path : options.Get("calibration")) {
    const std::map<std::string, CalibratedCamera> cameras = ReadCalibration(path);
    for (const RecordedCamera& camera : inputs.cameras) FindCalibration(cameras, camera.name, path);
  }
}

/// Whether a file was written after `before`.
bool IsNew(const fs::path& path, const std::optional<fs::file_time_type>& before) {
  std::error_code error;
  const fs::file_time_type now = fs::last_write_time(path, error);
  return !error && (!before || now != *before);
}

std::optional<fs::file_time_type> WrittenAt(const fs::path& path) {
  std::error_code error;
  const fs::file_time_type time = fs::last_write_time(path, error);
  return error ? std::nullopt : std::optional(time);
}

StepCommand DetectCommand(const RunOptions& options, const RecordingInputs& inputs) {
  StepCommand command{"detect", {}, {}};
  for (const std::string& path : options.inputs) command.arguments.push_back(StepValue::Input(path));
  command.fields.emplace_back("output", StepValue::Output(kKeypoints));
  AddFields(options, inputs, command);
  return command;
}

StepCommand ImportCommand(const RunOptions& options, const RecordingInputs& inputs, const std::string& name) {
  StepCommand command{"import", {StepValue::Text(inputs.are_videos ? "openpose" : inputs.format)}, {}};
  if (inputs.are_videos) {
    command.arguments.push_back(StepValue::Result(kKeypoints));
  } else {
    for (const std::string& path : options.inputs) command.arguments.push_back(StepValue::Input(path));
  }
  command.fields.emplace_back("output", StepValue::Output(kData));
  if (!options.Has("name")) command.fields.emplace_back("name", StepValue::Text(name));
  AddFields(options, inputs, command);
  return command;
}

StepCommand SolveCommand(const RunOptions& options, const RecordingInputs& inputs) {
  StepCommand command{"solve", {StepValue::Result(kData)}, {}};
  command.fields.emplace_back("output", StepValue::Output(kSolved));
  command.fields.emplace_back("json", StepValue::Output(kSolveReport));
  AddFields(options, inputs, command);
  return command;
}

StepCommand TrainCommand(const RunOptions& options, const RecordingInputs& inputs) {
  StepCommand command{"train", {StepValue::Result(kSolved)}, {}};
  command.fields.emplace_back("output", StepValue::Output(kModel));
  AddFields(options, inputs, command);
  return command;
}

/// Option values that a command would refuse only after the minutes of the commands before it.
void CheckCommands(const RunOptions& options, const RecordingInputs& inputs, const StepHooks& hooks) {
  std::vector<StepCommand> commands{ImportCommand(options, inputs, "name"), SolveCommand(options, inputs)};
  if (inputs.are_videos) commands.push_back(DetectCommand(options, inputs));
  if (options.trains) commands.push_back(TrainCommand(options, inputs));
  for (const StepCommand& command : commands) hooks.check(ToExecute(command, options.output));
}

class RecordingRun {
 public:
  RecordingRun(const RunOptions& options, const RecordingInputs& inputs, const StepHooks& hooks)
      : options_(options), inputs_(inputs), folder_(options.output), chain_(folder_, hooks) {
    // The name stays when the folder gets another, so that nothing is done again.
    std::string& name = chain_.records().name;
    if (name.empty()) {
      name = fs::absolute(folder_ / ".").lexically_normal().parent_path().filename().string();
      if (name.empty() || name.starts_with('.')) name = "recording";
    }
    report_.name = name;
    report_.are_videos = inputs_.are_videos;
    report_.format = inputs_.format;
  }

  RunReport Do() {
    WriteStepRecords(folder_, chain_.records());
    if (inputs_.are_videos) DetectAll();
    chain_.Do({"import", "Reading the keypoints", ImportCommand(options_, inputs_, report_.name), {kData}});
    const Dataset data = ReadDataset(folder_ / kData);
    RequireFrameRateFor(data);
    SolveAndShow();
    Export();
    const bool compares = data.HasCalibration();
    if (compares)
      Evaluate("evaluate-solved", "Comparing the solution with the calibration", {kSolved}, kEvaluationOfSolved);
    if (options_.trains) {
      Step train{"train",
                 "Training a network for single cameras (the page can be looked at meanwhile)",
                 TrainCommand(options_, inputs_),
                 {kModelFile}};
      train.without_effect = FieldsWithoutEffect("train");
      train.resumes_by_field = true;
      chain_.Do(train);
      report_.model = folder_ / kModel;
      if (compares)
        Evaluate("evaluate-model", "Comparing the network with the calibration", {kModel, kSolved}, kEvaluationOfModel);
    }
    Summarise(data);
    return std::move(report_);
  }

 private:
  void DetectAll() {
    Step step{"detect",
              fmt::format("Finding people in {} videos", inputs_.cameras.size()),
              DetectCommand(options_, inputs_),
              {kKeypoints}};
    step.without_effect = FieldsWithoutEffect("detect");
    std::string settings;
    for (const auto& [field, value] : step.command.fields) {
      const bool has_effect = std::ranges::find(step.without_effect, field) == step.without_effect.end();
      if (has_effect) settings += fmt::format(" {}={}", field, value.text);
    }
    for (const RecordedCamera& camera : inputs_.cameras) {
      std::string subject = settings;
      for (const fs::path& file : camera.files) subject += " " + chain_.FingerprintOf(file);
      step.parts[fmt::format("{}/{}", kKeypoints, camera.name)] = subject;
      step.parts[fmt::format("{}/.{}.journal", kKeypoints, camera.name)] = subject;
    }
    chain_.Do(step);
  }

  void SolveAndShow() {
    Step step{"solve", "Finding cameras and 3D poses", SolveCommand(options_, inputs_), {kSolved, kSolveReport}};
    step.without_effect = FieldsWithoutEffect("solve");
    const auto solved_before = WrittenAt(folder_ / kSolved);
    try {
      chain_.Do(step);
    } catch (const Error& error) {
      const bool has_result = error.kind() == ErrorKind::kComputation && IsNew(folder_ / kSolved, solved_before);
      if (has_result) View();
      throw;
    }
    View();
    report_.seconds_to_page = SecondsSince(start_);
    LogInfo("{} can be looked at in a browser now", report_.page.string());
  }

  void View() {
    StepCommand command{"view", {StepValue::Result(kSolved)}, {}};
    command.fields.emplace_back("report", StepValue::Result(kSolveReport));
    command.fields.emplace_back("title", StepValue::Text(report_.name));
    command.fields.emplace_back("output", StepValue::Output(kPage));
    chain_.Do({"view", "Making the page", command, {kPage}});
    report_.page = folder_ / kPage;
  }

  /// Formats that state a frame rate cannot be written without one.
  void RequireFrameRateFor(const Dataset& data) {
    const bool has_rate =
        std::ranges::all_of(data.sequences, [](const Sequence& sequence) { return sequence.fps > 0.0; });
    for (const std::string& format : options_.formats) {
      if (has_rate || !FindSceneFormat("poses." + format)->needs_frame_rate) {
        formats_.push_back(format);
      } else if (options_.formats_are_chosen) {
        ThrowInvalidArgument("`export`: {} files state a frame rate, which the keypoints do not have: give `fps`",
                             format);
      } else {
        report_.formats_left_out.push_back(format);
      }
    }
  }

  void Export() {
    for (const std::string& format : formats_) {
      const std::string output = fmt::format("{}/poses.{}", kExports, format);
      StepCommand command{"export", {StepValue::Result(kSolved)}, {{"output", StepValue::Output(output)}}};
      chain_.Do({"export-" + format, "Writing " + output, command, {fmt::format("{}/poses*.{}", kExports, format)}});
      for (const std::string& path : chain_.OutputsOf("export-" + format)) report_.exports.push_back(folder_ / path);
    }
  }

  void Evaluate(const std::string& name, const std::string& title, const std::vector<const char*>& inputs,
                const char* output) {
    StepCommand command{"evaluate", {}, {{"json", StepValue::Output(output)}}};
    for (const char* const input : inputs) command.arguments.push_back(StepValue::Result(input));
    AddFields(options_, inputs_, command);
    chain_.Do({name, title, command, {output}});
    const nlohmann::json json = nlohmann::json::parse(ReadFile(folder_ / output), nullptr, false);
    const auto error = json.is_object() ? json.find("n_mpjpe_mm") : json.end();
    if (error == json.end() || !error->is_number()) return;
    (output == kEvaluationOfSolved ? report_.solved_error_mm : report_.model_error_mm) = error->get<double>();
  }

  /// What `solve` said, from its report, which also tells of a result that was there before.
  void Summarise(const Dataset& data) {
    const nlohmann::json json = nlohmann::json::parse(ReadFile(folder_ / kSolveReport), nullptr, false);
    for (const nlohmann::json& capture : json.value("captures", nlohmann::json::array())) {
      report_.trust.push_back(capture.value("trust", ""));
      for (const nlohmann::json& camera : capture.value("cameras", nlohmann::json::array())) {
        const std::string name = camera.value("name", "");
        const std::string why = camera.value("why_not_used", "");
        if (camera.value("used", true)) {
          report_.used_cameras.push_back(name);
        } else {
          report_.unused_cameras.push_back(why.empty() ? name : fmt::format("{} ({})", name, why));
        }
      }
    }
    std::set<std::string> people;
    for (const Scene& scene : ReadScenes(folder_ / kSolved)) {
      for (const PoseSequence& person : scene.people) {
        people.insert(person.name);
        report_.in_millimetres = person.unit == LengthUnit::kMillimetres;
      }
    }
    report_.people.assign(people.begin(), people.end());
    for (const Sequence& sequence : data.sequences) report_.frames = std::max(report_.frames, sequence.frame_count);
    if (!data.sequences.empty()) report_.fps = data.sequences.front().fps;
    report_.seconds = SecondsSince(start_);
  }

  const RunOptions& options_;
  const RecordingInputs& inputs_;
  fs::path folder_;
  StepChain chain_;
  Clock::time_point start_ = Clock::now();
  std::vector<std::string> formats_;  ///< of exports that can be written
  RunReport report_;
};

}  // namespace

RunReport RunRecording(const RunOptions& options, const StepHooks& hooks) {
  options.Validate();
  const RecordingInputs inputs = FindRecording(options.inputs, options.format);
  RequireOptionsFor(options, inputs);
  RequireSeparateFolders(options, inputs);
  RequireCalibrationOf(options, inputs);
  CheckCommands(options, inputs, hooks);
  RequireFolderForRuns(options.output);
  MakeDirectory(options.output);
  const FolderLock lock(options.output);
  return RecordingRun(options, inputs, hooks).Do();
}

}  // namespace canonpose
