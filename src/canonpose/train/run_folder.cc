#include "canonpose/train/run_folder.h"

#include <cstdint>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"

namespace canonpose {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::shared_ptr<const FolderLock> PrepareRunFolder(const fs::path& folder, bool resume, bool overwrite) {
  if (folder.empty()) return nullptr;
  MakeDirectory(folder);
  auto lock = std::make_shared<const FolderLock>(folder);
  const bool holds_checkpoint = fs::exists(folder / "checkpoint.h5");
  const bool holds_run = fs::exists(folder / "model.cpm") || holds_checkpoint;
  const bool continues = resume && holds_checkpoint;
  if (holds_run && !continues && !overwrite) {
    ThrowInvalidArgument(
        "{} already holds a training run; add `resume` to continue it, `overwrite` to replace it, or choose another "
        "folder",
        folder.string());
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_ours = name.find("checkpoint.h5-") != std::string::npos ||
                         name.find("model.cpm-") != std::string::npos ||
                         name.find("metrics.jsonl-") != std::string::npos;
    if (name.starts_with(".new-") && is_ours) fs::remove(entry.path());
  }
  return lock;
}

RunFolder::RunFolder(fs::path path, bool resume, bool overwrite, std::shared_ptr<const FolderLock> lock)
    : path_(std::move(path)), lock_(lock ? std::move(lock) : PrepareRunFolder(path_, resume, overwrite)) {
  resumes_ = exists() && resume && fs::exists(path_ / "checkpoint.h5");
}

std::optional<Checkpoint> RunFolder::ReadCheckpointToResume() const {
  if (!resumes_) return std::nullopt;
  return ReadCheckpoint(path_ / "checkpoint.h5");
}

void RunFolder::WriteCheckpoint(const Checkpoint& checkpoint) const {
  if (exists()) canonpose::WriteCheckpoint(path_ / "checkpoint.h5", checkpoint);
}

void RunFolder::WriteModel(const ModelFile& model) const {
  if (exists()) WriteModelFile(path_ / "model.cpm", model);
}

void RunFolder::RemoveOldRecords() const {
  if (!exists() || resumes_) return;
  for (const char* name : {"metrics.jsonl", "train.log"}) fs::remove(path_ / name);
}

void RunFolder::DropLaterMetrics(const Checkpoint& checkpoint) const {
  const fs::path path = path_ / "metrics.jsonl";
  if (!exists() || !fs::exists(path)) return;
  const auto restarts_finished = static_cast<int>(checkpoint.restarts.losses.size());
  std::istringstream lines(ReadFile(path));
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) continue;
    const bool is_before = json.contains("restart")
                               ? json.value("restart", 0) < restarts_finished
                               : json.contains("step") && json.value("step", std::int64_t{0}) <= checkpoint.info.steps;
    if (is_before) kept += line + "\n";
  }
  WriteFileAtomically(path, kept);
}

void RunFolder::AddMetrics(const std::string& line) const {
  if (exists()) AppendLine(path_ / "metrics.jsonl", line);
}

void RunFolder::OpenLog() {
  if (exists()) log_ = std::make_unique<LogFile>(path_ / "train.log");
}

void RunFolder::WriteLog(const std::string& text) {
  if (log_) log_->Write(text);
}

std::string RunFolder::KeepLastGoodModel() const {
  if (!exists() || !fs::exists(path_ / "checkpoint.h5")) return "no good model was made";
  const ModelFile last_good = ModelOf(ReadCheckpoint(path_ / "checkpoint.h5"));
  const fs::path model = path_ / "model.cpm";
  if (last_good.info.steps > 0 || !fs::exists(model)) WriteModelFile(model, last_good);
  return fmt::format("the last good model, of step {}, is in {}", last_good.info.steps, model.string());
}

}  // namespace canonpose
