#include "canonpose/pipeline/step_records.h"

#include <system_error>

#include <nlohmann/json.hpp>

#include "canonpose/base/atomic_file.h"
#include "canonpose/base/error.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kFormat = "canonpose-run";
constexpr int kVersion = 1;

[[noreturn]] void ThrowNotRecords(const fs::path& path, const std::string& found) {
  ThrowBadInput({path.string(), "", "what `canonpose run` wrote of an earlier run", found,
                 "remove it to begin anew, or choose another output folder"});
}

/// Files in the folder itself: what a step wrote may be removed when it is done again.
void RequireInside(const std::map<std::string, std::string>& paths, const fs::path& file) {
  for (const auto& [path, fingerprint] : paths) {
    const fs::path normal = fs::path(path).lexically_normal();
    if (path.empty() || normal.is_absolute() || normal == "." || *normal.begin() == "..") {
      ThrowNotRecords(file, "a path outside of the folder");
    }
  }
}

}  // namespace

StepRecords ReadStepRecords(const fs::path& folder) {
  const fs::path path = folder / kStepRecordsName;
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  StepRecords records;
  try {
    const Json json = Json::parse(ReadFile(path));
    if (json.at("format") != kFormat) ThrowNotRecords(path, "something else");
    if (json.at("version") != kVersion) ThrowNotRecords(path, "a file of another version");
    records.name = json.at("name");
    for (const auto& [name, step] : json.at("steps").items()) {
      StepRecord& record = records.steps[name];
      record.key = step.at("key");
      record.is_done = step.at("is_done");
      record.outputs = step.at("outputs").get<std::map<std::string, std::string>>();
      record.parts = step.at("parts").get<std::map<std::string, std::string>>();
      RequireInside(record.outputs, path);
      RequireInside(record.parts, path);
    }
  } catch (const Json::exception&) {
    ThrowNotRecords(path, "damaged JSON");
  }
  return records;
}

void WriteStepRecords(const fs::path& folder, const StepRecords& records) {
  Json steps = Json::object();
  for (const auto& [name, record] : records.steps) {
    steps[name] = {
        {"key", record.key}, {"is_done", record.is_done}, {"outputs", record.outputs}, {"parts", record.parts}};
  }
  const Json json{{"format", kFormat}, {"version", kVersion}, {"name", records.name}, {"steps", steps}};
  WriteFileAtomically(folder / kStepRecordsName, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace canonpose
