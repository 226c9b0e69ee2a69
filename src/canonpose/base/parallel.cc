#include "canonpose/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "canonpose/base/callbacks.h"

namespace canonpose {

int ThreadsToUse(int requested) {
  return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void InParallel(int count, int threads, const std::function<void(int)>& work) {
  std::atomic<int> next = 0;
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(std::max(count, 0)));
  const auto run = [&] {
    for (int i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        failures[static_cast<std::size_t>(i)] = std::current_exception();
      }
    }
  };
  {
    internal::CallbackContext* const context = internal::CurrentContext();
    std::vector<std::jthread> workers;
    for (int t = 1; t < std::min(threads, count); ++t) {
      workers.emplace_back([&] {
        const internal::ContextOfThread callbacks(context);
        run();
      });
    }
    run();
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace canonpose
