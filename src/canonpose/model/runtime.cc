#include "canonpose/model/runtime.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <mutex>

#include <dlfcn.h>
#include <torch/torch.h>

#include "canonpose/base/error.h"
#include "canonpose/base/log.h"

namespace canonpose {

void RequireDevice(const std::string& device) {
  if (device != "cpu" && device != "cuda") ThrowInvalidArgument("`device`: expected cpu or cuda, found {}", device);
  if (device == "cuda" && !at::hasCUDA()) {
    ThrowBadInput({"`device` cuda", "", "a LibTorch with CUDA and an NVIDIA GPU", "none on this machine",
                   "leave the option out to use the CPU, or build against a LibTorch with CUDA"});
  }
}

std::string LinearAlgebraLibrary() {
  if (at::hasMKL()) return "MKL";
  // The dynamic linker takes a routine from the first library in the program's list that has it.
  const void* routine = dlsym(RTLD_DEFAULT, "sgemm_");
  Dl_info info{};
  if (routine == nullptr || dladdr(routine, &info) == 0 || info.dli_fname == nullptr) return "";
  std::error_code error;
  const std::filesystem::path path = std::filesystem::canonical(info.dli_fname, error);
  return error ? std::string(info.dli_fname) : path.string();
}

namespace {

constexpr int kMeasuredSize = 1024;
constexpr int kTries = 5;

/// Of the best of several calls.
template <typename Multiply>
double MeasureGflops(const Multiply& multiply) {
  using Clock = std::chrono::steady_clock;
  double best_seconds = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTries; ++i) {
    const Clock::time_point start = Clock::now();
    multiply();
    best_seconds = std::min(best_seconds, std::chrono::duration<double>(Clock::now() - start).count());
  }
  return 2e-9 * kMeasuredSize * kMeasuredSize * kMeasuredSize / best_seconds;
}

/// Fortran's interface: column-major C = alpha A B + beta C.
using Sgemm = void (*)(const char*, const char*, const int*, const int*, const int*, const float*, const float*,
                       const int*, const float*, const int*, const float*, float*, const int*);

/// OpenBLAS's own routine, whichever library the program's calls go to; null where OpenBLAS is not loaded.
Sgemm OpenBlasSgemm() {
  void* library = dlopen("libopenblas.so.0", RTLD_LAZY | RTLD_NOLOAD);
  return library == nullptr ? nullptr : reinterpret_cast<Sgemm>(dlsym(library, "sgemm_"));
}

}  // namespace

LinearAlgebraSpeed MeasureLinearAlgebra() {
  const ThreadScope threads(1);
  const torch::NoGradGuard no_grad;
  const torch::Tensor a = torch::ones({kMeasuredSize, kMeasuredSize});
  torch::Tensor c = torch::zeros({kMeasuredSize, kMeasuredSize});
  LinearAlgebraSpeed speed;
  speed.gflops = MeasureGflops([&] { torch::mm_out(c, a, a); });
  if (const Sgemm sgemm = OpenBlasSgemm()) {
    const int n = kMeasuredSize;
    const float one = 1.0F;
    const float zero = 0.0F;
    const auto* values = a.data_ptr<float>();
    speed.openblas_gflops = MeasureGflops(
        [&] { sgemm("N", "N", &n, &n, &n, &one, values, &n, values, &n, &zero, c.data_ptr<float>(), &n); });
  }
  return speed;
}

void WarnAboutSlowLinearAlgebra() {
  const std::string library = LinearAlgebraLibrary();
  if (library.empty() || library == "MKL") return;
  for (const char* fast : {"openblas", "mkl", "blis", "nvpl", "armpl"}) {
    if (library.find(fast) != std::string::npos) return;
  }
  static std::once_flag once;
  std::call_once(once, [&] {
    LogWarning("{} multiplies matrices here, several times slower than OpenBLAS: remove it from {}", library,
               std::getenv("LD_PRELOAD") != nullptr ? "LD_PRELOAD" : "the libraries that are loaded first");
  });
}

namespace {

// OpenBLAS has threads of its own, which LibTorch knows nothing about.

int OpenBlasThreads() {
  using GetThreads = int (*)();
  const auto get_threads = reinterpret_cast<GetThreads>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  return get_threads == nullptr ? 1 : get_threads();
}

void SetThreads(int torch_threads, int openblas_threads) {
  at::set_num_threads(torch_threads);
  using SetOpenBlasThreads = void (*)(int);
  if (const auto set = reinterpret_cast<SetOpenBlasThreads>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) {
    set(openblas_threads);
  }
}

}  // namespace

ThreadScope::ThreadScope(int threads)
    : torch_threads_before_(at::get_num_threads()), openblas_threads_before_(OpenBlasThreads()) {
  SetThreads(std::max(1, threads), std::max(1, threads));
}

ThreadScope::~ThreadScope() { SetThreads(torch_threads_before_, openblas_threads_before_); }

int ThreadCount() { return at::get_num_threads(); }

}  // namespace canonpose
