#include "canonpose/base/callbacks.h"

#include <mutex>
#include <utility>

#include "canonpose/base/error.h"

namespace canonpose {
namespace internal {

struct CallbackContext {
  Callbacks callbacks;
  std::recursive_mutex mutex;  ///< a message handler may itself log
};

namespace {
thread_local CallbackContext* current = nullptr;
}  // namespace

CallbackContext* CurrentContext() { return current; }

ContextOfThread::ContextOfThread(CallbackContext* context) : outer_(std::exchange(current, context)) {}

ContextOfThread::~ContextOfThread() { current = outer_; }

void SendMessage(MessageLevel level, const std::string& text) {
  if (current == nullptr || !current->callbacks.message) return;
  const std::lock_guard lock(current->mutex);
  current->callbacks.message(level, text);
}

bool WantsProgress() { return current != nullptr && current->callbacks.progress; }

void SendProgress(const ProgressState& state) {
  if (!WantsProgress()) return;
  const std::lock_guard lock(current->mutex);
  current->callbacks.progress(state);
}

}  // namespace internal

CallbackScope::CallbackScope(Callbacks callbacks)
    : context_(new internal::CallbackContext{std::move(callbacks), {}}),
      outer_(std::exchange(internal::current, context_)) {}

CallbackScope::~CallbackScope() {
  internal::current = outer_;
  delete context_;
}

Callbacks PassOn() {
  internal::CallbackContext* const outer = internal::CurrentContext();
  Callbacks callbacks;
  if (outer == nullptr) return callbacks;
  callbacks.message = [outer](MessageLevel level, const std::string& text) {
    const internal::ContextOfThread as_outer(outer);
    internal::SendMessage(level, text);
  };
  if (outer->callbacks.progress) {
    callbacks.progress = [outer](const ProgressState& state) {
      const internal::ContextOfThread as_outer(outer);
      internal::SendProgress(state);
    };
  }
  callbacks.stop = [outer] {
    const internal::ContextOfThread as_outer(outer);
    return StopRequested();
  };
  return callbacks;
}

bool StopRequested() {
  internal::CallbackContext* const context = internal::CurrentContext();
  if (context == nullptr || !context->callbacks.stop) return false;
  const std::lock_guard lock(context->mutex);
  return context->callbacks.stop();
}

void ThrowIfStopRequested() {
  if (StopRequested()) throw Error(ErrorKind::kStopped, "stopped");
}

}  // namespace canonpose
