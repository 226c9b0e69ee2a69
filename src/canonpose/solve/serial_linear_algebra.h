// Keeps linear algebra on the calling thread, for sparse factorisations of small blocks.
#pragma once

namespace canonpose {

/// While it lives, OpenMP loops started by this thread run on it alone. CHOLMOD would use four threads for each,
/// whatever it is asked to do, and its blocks are so small that waking threads takes longer than the work: the
/// adjustment of moving cameras took three times as long. Does nothing where no OpenMP library is loaded.
class OneOpenMpThread {
 public:
  OneOpenMpThread();
  ~OneOpenMpThread();
  OneOpenMpThread(const OneOpenMpThread&) = delete;
  OneOpenMpThread& operator=(const OneOpenMpThread&) = delete;

 private:
  int active_levels_before_ = -1;
};

/// While it lives, OpenBLAS uses one thread, for the same reason, in the whole program. Does nothing where OpenBLAS is
/// not loaded.
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
