// The machine LibTorch runs on: device, threads, and whether its linear algebra is a fast one. No LibTorch in this
// header.
#pragma once

#include <string>

namespace canonpose {

/// "cpu" or "cuda". Throws Error(kUsage) for other words, Error(kBadInput) where this LibTorch or machine has no CUDA.
void RequireDevice(const std::string& device);

/// The library that multiplies LibTorch's matrices, by path, "MKL", or "" where it cannot be told.
std::string LinearAlgebraLibrary();

/// Warns once where LibTorch would multiply matrices with the reference BLAS, which is about thirty times slower, and
/// says what to install.
void WarnAboutSlowLinearAlgebra();

/// Sets the number of threads; 0 leaves it to LibTorch.
void SetThreadCount(int threads);
int ThreadCount();

}  // namespace canonpose
