#include "canonpose/train/run_folder.h"

#include <sstream>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"
#include "canonpose/train/checkpoint.h"

namespace canonpose {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void PrepareRunFolder(const fs::path& folder, bool resume, bool overwrite) {
  MakeDirectory(folder);
  const bool holds_checkpoint = fs::exists(folder / "checkpoint.h5");
  const bool holds_run = fs::exists(folder / "model.cpm") || holds_checkpoint;
  const bool goes_on = resume && holds_checkpoint;
  if (holds_run && !goes_on && !overwrite) {
    ThrowInvalidArgument(
        "{} holds a training run already; add `resume` to go on with it, `overwrite` to replace it, or choose another "
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
}

void DropLaterMetrics(const fs::path& path, std::int64_t step, int restarts_finished) {
  if (!fs::exists(path)) return;
  std::istringstream lines(ReadFile(path));
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    const Json json = Json::parse(line, nullptr, /*allow_exceptions=*/false);
    if (!json.is_object()) continue;
    const bool is_before = json.contains("restart")
                               ? json.value("restart", 0) < restarts_finished
                               : json.contains("step") && json.value("step", std::int64_t{0}) <= step;
    if (is_before) kept += line + "\n";
  }
  WriteFileAtomically(path, kept);
}

std::string KeepLastGoodModel(const fs::path& folder, const std::vector<std::string>& other_parameters) {
  if (!fs::exists(folder / "checkpoint.h5")) return "no good model was made";
  Checkpoint last_good = ReadCheckpoint(folder / "checkpoint.h5");
  for (const std::string& name : other_parameters) last_good.parameters.erase(name);
  const fs::path model = folder / "model.cpm";
  if (last_good.info.steps > 0 || !fs::exists(model)) WriteModelFile(model, {last_good.info, last_good.parameters});
  return fmt::format("the last good model, of step {}, is in {}", last_good.info.steps, model.string());
}

}  // namespace canonpose
