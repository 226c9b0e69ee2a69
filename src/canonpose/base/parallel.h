// Independent pieces of work on several threads.
#pragma once

#include <functional>

namespace canonpose {

/// `asked`, or the number of the machine's cores where it is 0.
int ThreadsToUse(int asked);

/// Calls work(0) .. work(count - 1), each once, on up to `threads` threads. After all have ended, throws what the first
/// of those that failed (in order of number) threw.
void InParallel(int count, int threads, const std::function<void(int)>& work);

}  // namespace canonpose
