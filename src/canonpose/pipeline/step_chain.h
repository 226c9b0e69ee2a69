// Steps of a job, one after the other, in a folder: what is there already and still right is left alone, and a job that
// was killed goes on.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "canonpose/pipeline/path_fingerprint.h"
#include "canonpose/pipeline/step_command.h"
#include "canonpose/pipeline/step_records.h"

namespace canonpose {

struct Step {
  std::string name;   ///< "solve"; unique in the folder
  std::string title;  ///< for people: "finding cameras and 3D poses"
  StepCommand command;
  /// What it writes, relative to the folder: paths of files or folders, of which the last part may contain one '*'.
  std::vector<std::string> outputs;
  /// Fields of the command that change the speed but not the result, such as `threads`.
  std::vector<std::string> without_effect{};
  /// Whether its field `resume` continues a run that was interrupted, and `overwrite` replaces another.
  bool resumes_by_field = false;
  /// Parts of the output that the command itself leaves alone where they are there, such as the keypoints of each of
  /// several videos: what they follow from, by path relative to the folder. Those that follow from something else now
  /// are removed before.
  std::map<std::string, std::string> parts{};
};

/// What the caller does for the job.
struct StepHooks {
  /// Executes a command; throws Error as the command does.
  std::function<void(const ResolvedCommand& command)> execute;
  /// Throws Error where a command has an option that it does not know, or a value that is none; executes nothing.
  std::function<void(const ResolvedCommand& command)> check;
  /// The command as one line for a shell.
  std::function<std::string(const ResolvedCommand& command)> spell;
};

/// A step is left alone where it was done before with the same command, the same contents of its inputs and by the same
/// version of the program, and its outputs are as it wrote them.
class StepChain {
 public:
  /// The caller holds the folder. Throws Error(kBadInput) where its records cannot be read.
  StepChain(std::filesystem::path folder, StepHooks hooks);

  [[nodiscard]] StepRecords& records() { return records_; }

  /// Executes a step, unless it is left alone; true where it was executed. An Error of the command says in which step
  /// it was. Throws Error(kStopped) where the caller has asked to stop.
  bool Do(const Step& step);

  /// What a step has written, relative to the folder.
  [[nodiscard]] std::vector<std::string> OutputsOf(const std::string& step) const;

  /// Writes commands.sh: a line for each step so far, to do it all again in another folder.
  void WriteCommands() const;

  /// FingerprintOfPath(), without reading what has been read already.
  const std::string& FingerprintOf(const std::filesystem::path& path) { return fingerprints_.Of(path); }

 private:
  [[nodiscard]] std::string KeyOf(const Step& step);
  [[nodiscard]] bool IsDone(const StepRecord& record, const std::string& key);
  void RemoveOldParts(const Step& step, const StepRecord& before) const;
  void Execute(const Step& step, const StepRecord& before, const std::string& key);
  void Finish(const Step& step, const StepRecord& before);

  std::filesystem::path folder_;
  StepHooks hooks_;
  StepRecords records_;
  FingerprintCache fingerprints_;
  std::vector<std::string> lines_;
};

/// The paths below `folder` that `pattern` stands for (Step::outputs), in order; none where there are none.
std::vector<std::string> FindOutputs(const std::filesystem::path& folder, const std::string& pattern);

}  // namespace canonpose
