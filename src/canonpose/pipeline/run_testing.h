// For tests only: commands that write what was prepared, so that runs take no time.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/data/dataset.h"
#include "canonpose/pipeline/pipeline_testing.h"
#include "canonpose/pipeline/run_recording.h"

namespace canonpose::testing {

/// A small capture with its true poses and cameras as the solution.
inline const Dataset& SolvedCapture() {
  static const Dataset solved = [] {
    Dataset dataset = SmallCapture("ring");
    for (CameraView& view : dataset.sequences.front().cameras) {
      view.solved = view.truth;
      view.solved_calibration = view.calibration;
    }
    return dataset;
  }();
  return solved;
}

/// The commands of a run. What they write follows from what they read.
class PreparedCommands {
 public:
  /// Returns the commands that were executed: "solve", "export csv".
  std::vector<std::string> Run(const RunOptions& options) {
    executed_.clear();
    report = RunRecording(options, Hooks());
    return executed_;
  }

  [[nodiscard]] StepHooks Hooks() {
    return {[this](const ResolvedCommand& command) { Execute(command); }, [](const ResolvedCommand&) {},
            [](const ResolvedCommand& command) { return command.name; }};
  }

  /// How a command was executed the last time.
  [[nodiscard]] const ResolvedCommand& FieldsOf(const std::string& command) const { return last_.at(command); }
  [[nodiscard]] const std::vector<std::string>& executed() const { return executed_; }

  RunReport report;
  /// Called with a command's name before it does anything, and after it has written its files.
  std::function<void(const std::string& name)> before = [](const std::string&) {};
  std::function<void(const std::string& name)> after = [](const std::string&) {};
  std::vector<std::string> keypoints_there_before_detect;
  double fps = 25.0;  ///< of what `import` writes
  bool has_calibration = true;

 private:
  static std::string Field(const ResolvedCommand& command, const std::string& name) {
    const auto found = std::ranges::find(command.fields, name, &std::pair<std::string, std::string>::first);
    return found == command.fields.end() ? "" : found->second;
  }

  /// A word for everything that a command is given.
  static std::string Subject(const ResolvedCommand& command) {
    std::string text = command.name;
    for (const std::string& argument : command.arguments) text += FingerprintOfPath(argument);
    for (const auto& [field, value] : command.fields) {
      if (field != "output" && field != "json" && field != "resume" && field != "overwrite") text += field + value;
    }
    return text;
  }

  void Execute(const ResolvedCommand& command) {
    const std::filesystem::path output = Field(command, "output");
    executed_.push_back(command.name == "export" ? "export " + output.extension().string().substr(1) : command.name);
    last_[command.name] = command;
    before(command.name);
    if (command.name == "detect") {
      Detect(command, output);
    } else if (command.name == "import" || command.name == "solve") {
      Dataset dataset = SolvedCapture();
      Sequence& sequence = dataset.sequences.front();
      sequence.subject = Subject(command);
      sequence.fps = fps;
      if (!has_calibration) {
        for (CameraView& view : sequence.cameras) view.calibration.clear();
      }
      WriteDataset(output, dataset);
      if (command.name == "solve") {
        WriteFileAtomically(Field(command, "json"),
                            R"({"captures": [{"name": "c", "trust": "Nothing speaks against this result.", "cameras": [
                                {"name": "cam1", "used": true}, {"name": "cam2", "used": false, "why_not_used": "late"}]}]})");
      }
    } else if (command.name == "train") {
      MakeDirectory(output);
      WriteFileAtomically(output / "model.cpm", Subject(command));
    } else if (command.name == "evaluate") {
      WriteFileAtomically(Field(command, "json"), R"({"n_mpjpe_mm": 12.5})");
    } else {
      WriteFileAtomically(output, Subject(command));
    }
    after(command.name);
  }

  void Detect(const ResolvedCommand& command, const std::filesystem::path& output) {
    keypoints_there_before_detect.clear();
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(output, error)) {
      keypoints_there_before_detect.push_back(entry.path().filename().string());
    }
    std::ranges::sort(keypoints_there_before_detect);
    for (const std::string& video : command.arguments) {
      const std::filesystem::path folder = output / std::filesystem::path(video).stem();
      MakeDirectory(folder);
      WriteFileAtomically(folder / "keypoints.json", ReadFile(video));
    }
  }

  std::vector<std::string> executed_;
  std::map<std::string, ResolvedCommand> last_;
};

}  // namespace canonpose::testing
