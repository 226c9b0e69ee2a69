#include "canonpose/pipeline/step_chain.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/callbacks.h"
#include "canonpose/base/error.h"
#include "canonpose/base/hash.h"
#include "canonpose/base/log.h"
#include "canonpose/base/progress.h"
#include "canonpose/base/version.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCommandsName = "commands.sh";

/// Where a step failed, and that nothing is lost.
[[noreturn]] void ThrowFailedStep(const Step& step, const Error& error) {
  throw Error(error.kind(),
              fmt::format("{} (in the step {}; the steps before it are kept, and the same command goes on "
                          "from there)",
                          error.what(), step.name));
}

}  // namespace

std::vector<std::string> FindOutputs(const fs::path& folder, const std::string& pattern) {
  const fs::path relative(pattern);
  const std::string name = relative.filename().string();
  const std::size_t star = name.find('*');
  std::error_code error;
  std::vector<std::string> found;
  if (star == std::string::npos) {
    if (fs::exists(folder / relative, error)) found.push_back(pattern);
    return found;
  }
  const std::string before = name.substr(0, star);
  const std::string after = name.substr(star + 1);
  fs::directory_iterator entries(folder / relative.parent_path(), error);
  if (error) return found;
  for (const fs::directory_entry& entry : entries) {
    const std::string file = entry.path().filename().string();
    const bool fits = file.size() >= before.size() + after.size() && file.starts_with(before) && file.ends_with(after);
    if (fits) found.push_back((relative.parent_path() / file).string());
  }
  std::ranges::sort(found);
  return found;
}

StepChain::StepChain(fs::path folder, StepHooks hooks)
    : folder_(std::move(folder)), hooks_(std::move(hooks)), records_(ReadStepRecords(folder_)) {}

std::string StepChain::KeyOf(const Step& step) {
  Fingerprint key;
  key.Add(ProgramVersion());
  key.Add(step.command.name);
  const auto add = [&](const StepValue& value) {
    switch (value.kind) {
      case StepValue::Kind::kText:
        key.Add("text " + value.text);
        return;
      case StepValue::Kind::kInput:  // wherever it is
        key.Add("input " + fs::path(value.text).filename().string() + " " + fingerprints_.Of(value.text));
        return;
      case StepValue::Kind::kResult:
        key.Add("result " + value.text + " " + fingerprints_.Of(folder_ / value.text));
        return;
      case StepValue::Kind::kOutput:
        key.Add("output " + value.text);
        return;
    }
  };
  for (const StepValue& value : step.command.arguments) add(value);
  for (const auto& [field, value] : step.command.fields) {
    if (std::ranges::find(step.without_effect, field) != step.without_effect.end()) continue;
    key.Add(field);
    add(value);
  }
  for (const auto& [path, part] : step.parts) {
    key.Add(path);
    key.Add(part);
  }
  return fmt::format("{:016x}", key.value());
}

bool StepChain::IsDone(const StepRecord& record, const std::string& key) {
  return record.is_done && record.key == key && std::ranges::all_of(record.outputs, [&](const auto& output) {
           return fingerprints_.Of(folder_ / output.first) == output.second;
         });
}

void StepChain::RemoveOldParts(const Step& step, const StepRecord& before) const {
  for (const auto& [path, part] : before.parts) {
    const auto now = step.parts.find(path);
    if (now == step.parts.end() || now->second != part) fs::remove_all(folder_ / path);
  }
}

void StepChain::Execute(const Step& step, const StepRecord& before, const std::string& key) {
  RemoveOldParts(step, before);
  // The outputs of before stay on record, for what this step does not write any more to be removed.
  records_.steps[step.name] = {key, false, before.outputs, step.parts};
  WriteStepRecords(folder_, records_);
  StepCommand command = step.command;
  if (step.resumes_by_field) {
    const bool is_begun = before.key == key && !before.is_done;
    command.fields.emplace_back(is_begun ? "resume" : "overwrite", StepValue::Text(""));
  }
  for (const std::string& output : step.outputs) MakeDirectory((folder_ / output).parent_path());
  fingerprints_.Forget();
  try {
    hooks_.execute(ToExecute(command, folder_));
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kStopped) throw;
    ThrowFailedStep(step, error);
  }
  fingerprints_.Forget();
}

void StepChain::Finish(const Step& step, const StepRecord& before) {
  StepRecord& record = records_.steps[step.name];
  record.outputs.clear();
  for (const std::string& pattern : step.outputs) {
    for (const std::string& path : FindOutputs(folder_, pattern)) {
      record.outputs[path] = fingerprints_.Of(folder_ / path);
    }
  }
  for (const auto& [path, fingerprint] : before.outputs) {
    if (!record.outputs.contains(path)) fs::remove(folder_ / path);
  }
  record.is_done = true;
  WriteStepRecords(folder_, records_);
}

bool StepChain::Do(const Step& step) {
  ThrowIfStopRequested();
  lines_.push_back(hooks_.spell(ToLog(step.command)));
  const auto found = records_.steps.find(step.name);
  const StepRecord before = found == records_.steps.end() ? StepRecord{} : found->second;
  const std::string key = KeyOf(step);
  if (IsDone(before, key)) {
    LogInfo("== {}: done before", step.title);
    WriteCommands();
    return false;
  }
  LogInfo("== {}", step.title);
  WriteCommands();
  const auto start = std::chrono::steady_clock::now();
  Execute(step, before, key);
  Finish(step, before);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  constexpr double kWorthSaying = 2.0;
  if (seconds >= kWorthSaying) LogInfo("== {} took {}", step.name, FormatDuration(seconds));
  return true;
}

std::vector<std::string> StepChain::OutputsOf(const std::string& step) const {
  std::vector<std::string> paths;
  const auto found = records_.steps.find(step);
  if (found == records_.steps.end() || !found->second.is_done) return paths;
  for (const auto& [path, fingerprint] : found->second.outputs) paths.push_back(path);
  return paths;
}

void StepChain::WriteCommands() const {
  std::string text = fmt::format(
      "#!/bin/sh -e\n"
      "# What canonpose {} did here, one line for each step. Executed in an empty folder, it does all of it again.\n"
      "mkdir -p exports\n",
      ProgramVersion());
  for (const std::string& line : lines_) text += line + "\n";
  WriteFileAtomically(folder_ / kCommandsName, text);
}

}  // namespace canonpose
