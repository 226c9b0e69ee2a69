#include "canonpose/base/log.h"

#include <memory>

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "canonpose/base/error.h"

namespace canonpose {
namespace {

spdlog::logger& Terminal() {
  static const std::shared_ptr<spdlog::logger> logger = [] {
    auto created = std::make_shared<spdlog::logger>("terminal", std::make_shared<spdlog::sinks::stderr_sink_mt>());
    created->set_pattern("%v");
    return created;
  }();
  return *logger;
}

std::shared_ptr<spdlog::logger>& FileLogger() {
  static std::shared_ptr<spdlog::logger> logger;
  return logger;
}

void Log(const std::string& text) {
  const bool is_terminal = isatty(STDERR_FILENO) == 1;
  Terminal().info("{}{}", is_terminal ? "\r\033[K" : "", text);
  LogToFileOnly(text);
}

}  // namespace

void LogInfoText(const std::string& text) { Log(text); }

void LogWarningText(const std::string& text) { Log("warning: " + text); }

void LogToFileOnly(const std::string& text) {
  if (FileLogger()) {
    FileLogger()->info(text);
    FileLogger()->flush();
  }
}

LogFile::LogFile(const std::filesystem::path& path) {
  try {
    FileLogger() = std::make_shared<spdlog::logger>(
        "file", std::make_shared<spdlog::sinks::basic_file_sink_mt>(path.string(), /*truncate=*/false));
  } catch (const spdlog::spdlog_ex& failure) {
    ThrowBadInput({path.string(), "", "a file that can be written", failure.what(), "choose another output folder"});
  }
  FileLogger()->set_pattern("%Y-%m-%d %H:%M:%S %v");
  // A full disk must not stop a training run for the sake of its log.
  FileLogger()->set_error_handler([](const std::string&) {});
}

LogFile::~LogFile() { FileLogger().reset(); }

}  // namespace canonpose
