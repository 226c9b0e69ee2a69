// Sparse factorisations of small blocks, kept on the thread that asks for them.
#pragma once

namespace canonpose {

/// While it lives, OpenMP loops started by this thread run on it alone. CHOLMOD's would have four threads each,
/// whatever is asked for, and the blocks are so small that waking them takes longer than the work: three times as long
/// for moving cameras. Does nothing where no OpenMP library is loaded.
class OneOpenMpThread {
 public:
  OneOpenMpThread();
  ~OneOpenMpThread();
  OneOpenMpThread(const OneOpenMpThread&) = delete;
  OneOpenMpThread& operator=(const OneOpenMpThread&) = delete;

 private:
  int active_levels_before_ = -1;
};

/// While it lives, OpenBLAS uses one thread, for the same reason; that is the whole program's. Does nothing without it.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  int threads_before_ = 0;
};

}  // namespace canonpose
