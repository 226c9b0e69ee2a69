// Long work and the interpreter: its lock, its signals, its logger.
#include "canonpose/base/callbacks.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "python.h"

namespace canonpose::python {
namespace {

/// One piece of work. The library calls its functions from one thread at a time.
class Watch {
 public:
  explicit Watch(const Watcher& watcher) : watcher_(watcher), thread_(std::this_thread::get_id()) {}

  [[nodiscard]] Callbacks MakeCallbacks() {
    Callbacks callbacks;
    callbacks.message = [this](MessageLevel level, const std::string& text) {
      Call([&] {
        const py::object logger = py::module_::import("logging").attr("getLogger")("canonpose");
        logger.attr(level == MessageLevel::kWarning ? "warning" : "info")("%s", text);
      });
    };
    if (!watcher_.progress.is_none()) {
      callbacks.progress = [this](const ProgressState& state) {
        Call([&] { watcher_.progress(state.label, state.done, state.total, state.detail); });
      };
    }
    callbacks.stop = [this] { return Stops(); };
    return callbacks;
  }

  /// Raises what was raised meanwhile. Needs the lock.
  void Rethrow() {
    if (!raised_) return;
    py::error_already_set raised = std::move(*raised_);
    raised_.reset();
    throw raised;
  }

 private:
  template <typename Function>
  void Call(Function&& function) {
    const py::gil_scoped_acquire lock;
    if (raised_) return;
    try {
      function();
    } catch (py::error_already_set& raised) {
      raised_.emplace(std::move(raised));
      stops_ = true;
    }
  }

  /// Signals are handled by the main thread of Python only, so only the thread that started the work looks for them.
  bool Stops() {
    const auto now = std::chrono::steady_clock::now();
    if (stops_ || std::this_thread::get_id() != thread_ || now < next_look_) return stops_;
    next_look_ = now + std::chrono::milliseconds(50);
    Call([] {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    });
    return stops_;
  }

  const Watcher& watcher_;
  std::thread::id thread_;
  std::chrono::steady_clock::time_point next_look_{};
  std::atomic<bool> stops_ = false;
  std::optional<py::error_already_set> raised_;
};

}  // namespace

void Run(const Watcher& watcher, const std::function<void()>& work) {
  Watch watch(watcher);
  std::exception_ptr failure;
  {
    const py::gil_scoped_release no_lock;
    const CallbackScope scope(watch.MakeCallbacks());
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
  }
  watch.Rethrow();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace canonpose::python
