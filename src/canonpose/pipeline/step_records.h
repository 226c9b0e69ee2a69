// What a job of several steps has done in its folder, on disk: FOLDER/run.json.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace canonpose {

/// One step.
struct StepRecord {
  std::string key;                             ///< of command and inputs
  bool is_done = false;                        ///< false: begun, and not known to have ended
  std::map<std::string, std::string> outputs;  ///< fingerprint by path, relative to the folder; of a step that is done
  std::map<std::string, std::string> parts;    ///< Step::parts
};

struct StepRecords {
  std::string name;                         ///< of the recording
  std::map<std::string, StepRecord> steps;  ///< by name
};

inline constexpr const char* kStepRecordsName = "run.json";

/// The records of a folder; none where it has no such file. Throws Error(kBadInput) where the file is something else.
StepRecords ReadStepRecords(const std::filesystem::path& folder);

/// Throws Error(kBadInput) where the file cannot be written.
void WriteStepRecords(const std::filesystem::path& folder, const StepRecords& records);

}  // namespace canonpose
