// The machine LibTorch runs on: device, threads, and whether its linear algebra is a fast one. No LibTorch in this
// header.
#pragma once

#include <string>

namespace canonpose {

/// "cpu" or "cuda". Throws Error(kInvalidArgument) for other words, Error(kBadInput) where this LibTorch or machine has
/// no CUDA.
void RequireDevice(const std::string& device);

/// The library that multiplies LibTorch's matrices, by path, "MKL", or "" where it cannot be told.
std::string LinearAlgebraLibrary();

/// How fast the program multiplies two float32 matrices of 1024 x 1024 on one thread: the best of several tries, in
/// 10^9 multiplications and additions a second. Takes about a tenth of a second.
struct LinearAlgebraSpeed {
  double gflops = 0.0;           ///< through LibTorch
  double openblas_gflops = 0.0;  ///< OpenBLAS called by itself, for comparison; 0 where it is not loaded
};
LinearAlgebraSpeed MeasureLinearAlgebra();

/// The program links OpenBLAS in front of all else, so that it answers LibTorch's calls whatever else is installed.
/// Warns once where a slower library does, which something like LD_PRELOAD must then have put before it.
void WarnAboutSlowLinearAlgebra();

/// Sets the number of threads that networks are computed with; 0: one, which is the fastest for narrow networks and
/// never waits for a core that another program uses.
void SetThreadCount(int threads);
int ThreadCount();

}  // namespace canonpose
