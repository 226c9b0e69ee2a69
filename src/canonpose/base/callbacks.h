// How long-running work communicates with its caller: messages, progress, and whether to stop. The library itself
// prints nothing and handles no signals.
//
//   Callbacks callbacks;
//   callbacks.message = [](MessageLevel, const std::string& text) { std::cerr << text << '\n'; };
//   callbacks.stop = [&] { return window_was_closed; };
//   const CallbackScope scope(callbacks);
//   Train(job);
//
// A scope applies to the thread that made it and to the threads that the library starts on that thread's behalf
// (InParallel()).
#pragma once

#include <functional>
#include <string>

namespace canonpose {

enum class MessageLevel { kInfo, kWarning };

/// How far long-running work has come.
struct ProgressState {
  std::string label;  ///< what is being done: "step", "solve"
  long done = 0;      ///< of `total`
  long total = 0;
  std::string detail;         ///< "loss 0.21"; may be empty
  double per_second = 0.0;    ///< of this run; 0 while unknown
  double seconds_left = 0.0;  ///< at that speed
  bool has_ended = false;     ///< the last call for this work
};

/// Empty functions mean silence, and work that runs to its end. The functions may be called from several threads, but
/// never from two at once for one scope.
struct Callbacks {
  std::function<void(MessageLevel level, const std::string& text)> message;
  /// Called at most a few times per second.
  std::function<void(const ProgressState& state)> progress;
  /// Called often. Once it returns true, work that can be resumed saves its state and returns at its next safe point;
  /// other work throws Error(kStopped).
  std::function<bool()> stop;
};

namespace internal {
struct CallbackContext;
}  // namespace internal

/// During its lifetime, the callbacks of this thread's work are `callbacks`; afterwards those that were in force
/// before.
class CallbackScope {
 public:
  explicit CallbackScope(Callbacks callbacks);
  ~CallbackScope();
  CallbackScope(const CallbackScope&) = delete;
  CallbackScope& operator=(const CallbackScope&) = delete;

 private:
  internal::CallbackContext* context_;
  internal::CallbackContext* outer_;
};

/// Callbacks that forward everything to those now in force on this thread, for a scope nested in the current one.
Callbacks PassOn();

/// Whether the caller has asked this thread's work to stop.
bool StopRequested();

/// For work that cannot be continued later: throws Error(kStopped) if the caller has asked it to stop.
void ThrowIfStopRequested();

namespace internal {

/// The callbacks in force on this thread; null if there are none.
CallbackContext* CurrentContext();

/// Adopts another thread's callbacks, for a thread that works on its behalf.
class ContextOfThread {
 public:
  explicit ContextOfThread(CallbackContext* context);
  ~ContextOfThread();
  ContextOfThread(const ContextOfThread&) = delete;
  ContextOfThread& operator=(const ContextOfThread&) = delete;

 private:
  CallbackContext* outer_;
};

void SendMessage(MessageLevel level, const std::string& text);
bool WantsProgress();
void SendProgress(const ProgressState& state);

}  // namespace internal

}  // namespace canonpose
