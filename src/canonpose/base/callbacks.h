// How long work talks to its caller: messages, progress, and whether to stop. The library prints nothing of its own
// accord and handles no signals.
//
//   Callbacks callbacks;
//   callbacks.message = [](MessageLevel, const std::string& text) { std::cerr << text << '\n'; };
//   callbacks.stop = [&] { return window_was_closed; };
//   const CallbackScope scope(callbacks);
//   Train(job);
//
// A scope holds for the thread that made it and for the threads that the library starts on that thread's behalf
// (InParallel()).
#pragma once

#include <functional>
#include <string>

namespace canonpose {

enum class MessageLevel { kInfo, kWarning };

/// How far long work has come.
struct ProgressState {
  std::string label;  ///< what is being done: "step", "solve"
  long done = 0;      ///< of `total`
  long total = 0;
  std::string detail;         ///< "loss 0.21"; may be empty
  double per_second = 0.0;    ///< of this run; 0 while unknown
  double seconds_left = 0.0;  ///< at that speed
  bool has_ended = false;     ///< the last call: nothing more is to come of this work
};

/// Empty functions: silence, and work that runs to its end. They may be called from several threads, never from two at
/// once for one scope.
struct Callbacks {
  std::function<void(MessageLevel level, const std::string& text)> message;
  /// Called a few times a second at most.
  std::function<void(const ProgressState& state)> progress;
  /// Asked often. Once it returns true, work that can be resumed saves its state and returns at its next safe point;
  /// other work throws Error(kStopped).
  std::function<bool()> stop;
};

namespace internal {
struct CallbackContext;
}  // namespace internal

/// While it lives, the callbacks of this thread's work are `callbacks`; then those that were before.
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

/// Callbacks that pass everything on to those that are in force on this thread now, for a scope within the scope.
Callbacks PassOn();

/// Whether the caller has asked this thread's work to stop.
bool StopRequested();

/// For work that cannot be continued later: throws Error(kStopped) where the caller has asked it to stop.
void ThrowIfStopRequested();

namespace internal {

/// The callbacks in force on this thread; null: none.
CallbackContext* CurrentContext();

/// Takes over another thread's callbacks, for a thread that works on its behalf.
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
