// The machine LibTorch runs on: its devices, threads, and whether its linear algebra is fast. No LibTorch in this
// header.
#pragma once

#include <string>

namespace canonpose {

/// Throws Error(kInvalidArgument) unless `device` is "cpu" or "cuda", and Error(kBadInput) for "cuda" where this
/// LibTorch or this machine has no CUDA.
void RequireDevice(const std::string& device);

/// The library that multiplies LibTorch's matrices: its path, "MKL", or "" if that is unknown.
std::string LinearAlgebraLibrary();

/// How fast the program multiplies two float32 matrices of 1024 x 1024 on one thread: the best of several tries, in
/// 10^9 multiplications and additions per second. Takes about a tenth of a second.
struct LinearAlgebraSpeed {
  double gflops = 0.0;           ///< through LibTorch
  double openblas_gflops = 0.0;  ///< OpenBLAS called by itself, for comparison; 0 where it is not loaded
};
LinearAlgebraSpeed MeasureLinearAlgebra();

/// Warns once where a slow library multiplies matrices. The program links OpenBLAS before everything else, so that must
/// be the effect of something like LD_PRELOAD.
void WarnAboutSlowLinearAlgebra();

/// The number of threads that networks are computed with on the CPU, while a scope lives; the number that was in force
/// before returns afterwards. It holds for the whole process: scopes must be nested, not made by threads side by side.
class ThreadScope {
 public:
  /// 0: one thread, which is the fastest for narrow networks and never waits for a core that another program uses.
  explicit ThreadScope(int threads);
  ~ThreadScope();
  ThreadScope(const ThreadScope&) = delete;
  ThreadScope& operator=(const ThreadScope&) = delete;

 private:
  int torch_threads_before_;
  int openblas_threads_before_;
};

/// The number of threads in force.
int ThreadCount();

}  // namespace canonpose
