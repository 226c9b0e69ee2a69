// Independent pieces of work on several threads.
#pragma once

#include <functional>

namespace canonpose {

/// `requested`, or the number of the machine's cores where it is 0.
int ThreadsToUse(int requested);

/// Calls work(0) .. work(count - 1), each once, on up to `threads` threads. When all have ended, rethrows the exception
/// of the failed call with the lowest number, if any failed.
void InParallel(int count, int threads, const std::function<void(int)>& work);

}  // namespace canonpose
