#include "canonpose/base/log.h"

#include <utility>

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>

#include "canonpose/base/error.h"

namespace canonpose {

struct LogFile::Sink {
  std::shared_ptr<spdlog::logger> logger;
};

LogFile::LogFile(const std::filesystem::path& path) : sink_(std::make_unique<Sink>()) {
  try {
    sink_->logger = std::make_shared<spdlog::logger>(
        "file", std::make_shared<spdlog::sinks::basic_file_sink_mt>(path.string(), /*truncate=*/false));
  } catch (const spdlog::spdlog_ex& failure) {
    ThrowBadInput({path.string(), "", "a file that can be written to", failure.what(), "choose another output folder"});
  }
  sink_->logger->set_pattern("%Y-%m-%d %H:%M:%S %v");
  // A full disk must not stop a training run just because its log cannot be written.
  sink_->logger->set_error_handler([](const std::string&) {});

  Callbacks callbacks = PassOn();
  callbacks.message = [this, send = std::move(callbacks.message)](MessageLevel level, const std::string& text) {
    Write(level == MessageLevel::kWarning ? "warning: " + text : text);
    if (send) send(level, text);
  };
  scope_ = std::make_unique<CallbackScope>(std::move(callbacks));
}

LogFile::~LogFile() = default;

void LogFile::Write(const std::string& text) {
  sink_->logger->info(text);
  sink_->logger->flush();
}

}  // namespace canonpose
