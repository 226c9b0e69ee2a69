#include "canonpose/pipeline/step_command.h"

namespace canonpose {
namespace {

namespace fs = std::filesystem;

template <typename Resolve>
ResolvedCommand ResolveAll(const StepCommand& command, const Resolve& resolve) {
  ResolvedCommand resolved{command.name, {}, {}};
  for (const StepValue& value : command.arguments) resolved.arguments.push_back(resolve(value));
  for (const auto& [field, value] : command.fields) resolved.fields.emplace_back(field, resolve(value));
  return resolved;
}

}  // namespace

ResolvedCommand ToExecute(const StepCommand& command, const fs::path& folder) {
  return ResolveAll(command, [&](const StepValue& value) {
    const bool is_inside = value.kind == StepValue::Kind::kResult || value.kind == StepValue::Kind::kOutput;
    return is_inside ? (folder / value.text).string() : value.text;
  });
}

ResolvedCommand ToLog(const StepCommand& command) {
  return ResolveAll(command, [](const StepValue& value) {
    return value.kind == StepValue::Kind::kInput ? fs::absolute(value.text).lexically_normal().string() : value.text;
  });
}

}  // namespace canonpose
