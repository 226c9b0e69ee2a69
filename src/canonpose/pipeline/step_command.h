// A command of the program as data, for jobs that consist of several: which command, and what it is given.
//
// Options go by the names of their fields (`image_size`); how the command line spells them is for the caller to know.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace canonpose {

/// Something that a command is given.
struct StepValue {
  enum class Kind {
    kText,    ///< any text
    kInput,   ///< the user's file or folder, as the user gave it
    kResult,  ///< what an earlier step wrote, relative to the folder of the job
    kOutput,  ///< what the command writes, relative to the folder of the job
  };
  Kind kind = Kind::kText;
  std::string text;  ///< empty for an option that is only there or not

  static StepValue Text(std::string text) { return {Kind::kText, std::move(text)}; }
  static StepValue Input(std::string path) { return {Kind::kInput, std::move(path)}; }
  static StepValue Result(std::string path) { return {Kind::kResult, std::move(path)}; }
  static StepValue Output(std::string path) { return {Kind::kOutput, std::move(path)}; }
};

struct StepCommand {
  std::string name;                                       ///< "solve"
  std::vector<StepValue> arguments;                       ///< those without a name, in their order
  std::vector<std::pair<std::string, StepValue>> fields;  ///< options by field; one may be there several times
};

/// A command with paths that can be used.
struct ResolvedCommand {
  std::string name;
  std::vector<std::string> arguments;
  std::vector<std::pair<std::string, std::string>> fields;
};

/// For this process: results and outputs in `folder`.
ResolvedCommand ToExecute(const StepCommand& command, const std::filesystem::path& folder);

/// For a log that can be executed in any folder: inputs with absolute paths, results and outputs relative to there.
ResolvedCommand ToLog(const StepCommand& command);

}  // namespace canonpose
